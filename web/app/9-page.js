// In order; what is on the first screen is drawn first.

document.getElementById("first").remove();
findKept();
summaryPart();
frontPart();
growthPart();
designPart();
provenancePart();
contents();
standard = Object.fromEntries(new URLSearchParams(addressOf()));
readAddress();
takeTheme(state.theme);
layoutChanged();
performance.mark("front drawn");

function drawDesign() {
  drawAll();
  if (/[#&]mark=/.test(location.hash) && drawer.hidden) openDrawer(state.marked);
  performance.mark("all drawn");
  document.documentElement.dataset.ready = "yes";
}
requestAnimationFrame(() => setTimeout(drawDesign));

window.addEventListener("hashchange", takeAddress);

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
