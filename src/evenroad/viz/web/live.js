// A page that plans again: what it sends to the computer that serves it, and what it offers to change.
const pending = [];
let isBusy = false, accept = () => {};

async function send(change) { // one change at a time; of those that wait for the same thing only the last counts
  const alike = pending.findIndex((each) => each.do === change.do && each.name === change.name);
  if (alike >= 0) pending.splice(alike, 1);
  pending.push(change);
  if (isBusy) return;
  isBusy = true;
  while (pending.length) {
    try {
      const plan = await ask({ ...pending.shift(), coloured: state.coloured });
      take(plan); accept(plan); update(); sliders(); draw();
    } catch (error) { $("title").textContent = `no answer: ${error.message}`; pending.length = 0; }
  }
  isBusy = false;
  if (state.graph) graph();
}
async function ask(change) {
  const answer = await fetch(location.pathname, { method: "POST", body: JSON.stringify(change) });
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}
async function graph() {
  data.graph = (await ask({ do: "graph", coloured: state.coloured })).graph;
  accept({}); draw();
}
function offerChanges() {
  option(live.graph, false, (on) => { state.graph = on; data.graph = []; if (on) graph(); else accept({}); });
  option("move start and goal by hand", true, (on) => { state.hands = on; });
  const [joints, obstacles, chosen] = [0, 1, 2].map(() => $("live").appendChild(document.createElement("p")));
  joints.append("take joints as ");
  for (const name of ["start", "goal"]) button(name, joints, () => {
    const values = Object.fromEntries(inputs.map(([number]) => [data.joints[number].name, valueOf(number)]));
    state.byHand = null;
    send({ do: "joints", name, values });
  });
  obstacles.append("add a ");
  for (const name of live.new) button(name, obstacles, () => send({ do: "add", name }));
  button("remove", chosen, () => { if (state.chosen) send({ do: "remove", name: state.chosen }); }).id = "remove";
  chosen.append(Object.assign(document.createElement("span"), { id: "chosen" }));
  choose(null);
}
function choose(name) {
  state.chosen = name;
  $("chosen").textContent = name ? ` ${name}` : " click an obstacle to move it";
}
