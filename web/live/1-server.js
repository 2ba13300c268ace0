// ---- live: what only a page with the program behind it has. Addresses are relative to /TOKEN/RUN/.
async function ask(where, body) {
  const answer = await fetch(where, body ? { method: "POST", body: JSON.stringify(body) } : {}).catch(() => {
    throw new Error("the server does not answer (imtet serve has ended?)");
  });
  const said = await answer.json();
  if (!answer.ok) throw Object.assign(new Error(said.error), { code: answer.status });
  return said;
}

// What the engine of the page simulates with is asked for once.
sceneOf = () => ask("scene");
