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

// A report simulates once all of it has come; on the live page the server has the scene.
loaded.then(() => {
  if (run.paper || !byId("scene")) return;
  whatIfPart();
  startWhatIf(state.marked ?? rowOf.get(run.chosen) ?? rowOf.get(run.knee), false);
});

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
