// A run under way: how far it is, failures and the front as it grows.
function progressPart() {
  const part = laterPart("live", "Progress", "summary");
  const said = element("p", { id: "progress-words", role: "status" }), bar = element("progress", { "aria-label": "share of the simulations" });
  const again = plainButton("", () => location.reload(), { hidden: true, id: "new-front" });
  part.append(said, bar, again);
  const strip = part.appendChild(element("figure", element("h3", "The front as it grows"),
    legend([["the front", "var(--pale)"], ["new since this page was loaded", BLUE]])));
  const draw = frontStrip(strip, "The front as it grows");
  let generation = -1;

  async function takeFront() {
    const now = await ask("front");
    drawGrowth(Object.assign(run.convergence, now));
    const isNew = now.ids.map((id) => !rowOf.has(id)), fresh = isNew.filter(Boolean).length;
    draw([paleFront(now.f), { rows: now.f.filter((_, i) => isNew[i]), colour: BLUE, alpha: 0.8 }]);
    again.hidden = !fresh;
    again.textContent = `${count(fresh)} new designs on the front: show them in all pictures`;
    part.dataset.generation = now.generation;
  }

  function take(status) {
    const isOn = status.state === "running", left = status.left_s === null ? "" : `, ${status.left_s < 90 ? `${Math.round(status.left_s)} s` : `${Math.round(status.left_s / 60)} min`} left`;
    const pace = status.per_second === null ? "" : `, ${show(status.per_second)} per second`;
    said.textContent = `${status.reason ? `${status.reason}. ` : ""}${status.state[0].toUpperCase()}${status.state.slice(1)}: ${count(status.simulated)} of ${count(status.max_evals)} designs simulated${isOn ? pace + left : ""}; ` +
      `${count(status.failed)} failed; ${count(status.front)} on the front after generation ${Math.max(0, status.generation)}, hypervolume ${status.hypervolume === null ? "\u2013" : show(100 * status.hypervolume)} %`;
    bar.max = status.max_evals;
    bar.value = status.simulated;
    if (!part.dataset.state) document.querySelector('#parts a[href="#live"]').hidden = part.hidden = status.state === "finished"; // all of it stands below
    if (!part.dataset.state && status.state === "running" && !run.detail) byId("provenance").before(byId("summary")); // it waits
    part.dataset.state = status.state;
    if (status.generation === generation) return;
    generation = status.generation;
    takeFront().catch((error) => (said.textContent = error.message));
  }

  // One stream for the page in sight: a browser has six connections for all its tabs.
  let events;
  function follow_() {
    events?.close();
    events = undefined;
    if (document.hidden) return;
    events = new EventSource("events");
    events.onmessage = ({ data }) => take(JSON.parse(data));
    events.onerror = () => (said.textContent = "The server does not answer (imtet serve has ended?). Asking again.");
  }
  document.onvisibilitychange = follow_;
  window.onpagehide = () => events?.close();
  follow_();
}
