// In order; what is on the first screen is drawn first. On paper there are drawings alone.
findKept();
(run.paper ? drawPaper : drawPage)();

function drawPage() {
  byId("first").remove();
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
}

function drawDesign() {
  drawAll();
  if (/[#&]mark=/.test(location.hash) && drawer.hidden) openDrawer(state.marked);
  performance.mark("all drawn");
  root.dataset.ready = "yes";
}
requestAnimationFrame(() => setTimeout(drawDesign));

window.onhashchange = takeAddress;

let width = window.innerWidth, timer;
window.onresize = () => {
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (window.innerWidth === width) return;
    width = window.innerWidth;
    layoutChanged();
    drawDesign();
  }, 150);
};
