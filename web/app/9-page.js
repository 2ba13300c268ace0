// In order; what is on the first screen is drawn first.

findKept();
summaryPart();
frontPart();
growthPart();
designPart();
provenancePart();
contents();
standard = Object.fromEntries(new URLSearchParams(addressOf()));
readAddress();
layoutChanged();
performance.mark("front drawn");

function drawDesign() {
  drawAll();
  performance.mark("all drawn");
  document.documentElement.dataset.ready = "yes";
}
requestAnimationFrame(() => setTimeout(drawDesign));

window.addEventListener("hashchange", () => {
  readAddress();
  layoutChanged();
});

let width = window.innerWidth, timer;
window.addEventListener("resize", () => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    layoutChanged();
    drawDesign();
  }, 150);
});
