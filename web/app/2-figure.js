// A number with the digits that are known of it: "13 ± 2", by the rule of src/base/figure.h.
const firstPlace = (x, many) => +Math.abs(x).toExponential(many - 1).split("e")[1];

// x rounded to 10^place, never -0.
function decimal(x, place) {
  const unit = 10 ** place, rounded = place > 0 ? Math.round(x / unit) * unit : x;
  return (Math.abs(rounded) < unit / 2 ? 0 : rounded).toFixed(Math.max(0, -place));
}

function figureParts(v, uncertain, word, place) {
  const size = Math.max(Math.abs(v), uncertain), exponent = size > 0 && (size >= 1e7 || size < 1e-6) ? firstPlace(size, 4) : 0;
  const scale = 10 ** exponent, text = decimal(v / scale, place - exponent) + (uncertain ? ` \u00b1 ${decimal(uncertain / scale, place - exponent)}` : "");
  const power = exponent && `\u00b710^${exponent}`;
  return (exponent ? (uncertain ? `(${text})` : text) + power : text) + (uncertain ? word : "");
}

const figureDigits = (v, many) => figureParts(v, 0, "", v === 0 ? 0 : firstPlace(v, many) - many + 1);

function figureText(v, error = NaN, sd = NaN) {
  if (v === null || !finite(v)) return "-";
  const isSd = finite(sd) && !(error >= sd), uncertain = isSd ? sd : error, size = Math.abs(v);
  if (!uncertain) return figureDigits(v, uncertain === 0 ? 4 : 3);
  const place = firstPlace(uncertain, 1);
  if (v !== 0 && uncertain < 0.5 * 10 ** (firstPlace(v, 4) - 3)) return figureDigits(v, 4);
  if (uncertain < size || v <= 0 || size < 0.5 * 10 ** place) return figureParts(uncertain < size ? v : 0, uncertain, isSd ? " sd" : "", place);
  return `about ${figureDigits(v, 1)}`;
}
