// In order; what is on the first screen is drawn first.

summaryPart();
frontPart();
growthPart();
designPart();
provenancePart();
contents();
layoutChanged();
performance.mark("front drawn");

function drawDesign() {
  for (const draw of drawings) draw();
  performance.mark("all drawn");
  document.documentElement.dataset.ready = "yes";
}
requestAnimationFrame(() => setTimeout(drawDesign));

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
