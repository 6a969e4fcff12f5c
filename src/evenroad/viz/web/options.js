// What the side shows: boxes to check, the scale of colours, and a slider for each joint.
function option(name, checked, change) {
  const label = document.createElement("label"), box = document.createElement("input");
  box.type = "checkbox"; box.checked = checked; box.id = "show-" + name.replace(/\W+/g, "-");
  box.onchange = () => { change(box.checked); draw(); };
  label.append(box, " " + name); $("options").append(label);
}
function button(name, parent, click) {
  const made = Object.assign(document.createElement("button"), { textContent: name, onclick: click });
  parent.append(made);
  return made;
}
const NAMES = { visual: "visual", collision: "collision bodies", capsules: "capsules around them" };

function offerOptions() {
  data.sets.forEach((name, i) => {
    if (i === 0) state.shown.add(name);
    option(NAMES[name], i === 0, (on) => on ? state.shown.add(name) : state.shown.delete(name));
  });
  if (data.clearance) offerClearance();
  data.joints.forEach((joint, number) => { if (joint.values && !joint.mimic) offerJoint(joint, number); });
  if (!inputs.length) $("values").remove();
}
function offerClearance() {
  option("colour by clearance", false, (on) => {
    state.coloured = on;
    if (on && !data.clearance) send({ do: "measure" });
  });
  const scale = document.createElement("div"), row = document.createElement("div");
  scale.id = "scale"; row.className = "row";
  const ends = [0, 1].map(() => row.appendChild(document.createElement("span")));
  update = () => [near, far].forEach((each, i) => { ends[i].textContent = data.clearance ? length(each) : ""; });
  $("options").append(scale, row); update();
}

const inputs = []; // number of a joint, its slider, and where its value stands
function offerJoint(joint, number) {
  const row = document.createElement("div"), slider = document.createElement("input"), value = document.createElement("span");
  row.className = "row"; row.append(joint.name, value);
  slider.type = "range"; slider.min = joint.limits[0]; slider.max = joint.limits[1]; slider.step = 0.001;
  slider.setAttribute("aria-label", joint.name);
  slider.oninput = () => {
    state.playing = false;
    if (!state.byHand) state.byHand = data.joints.map((each) => each.values ? between(each.values, state.time) : 0);
    state.byHand[number] = +slider.value; sliders(); draw();
  };
  $("joints").append(row, slider); inputs.push([number, slider, value]);
}
function valueOf(number) {
  const joint = data.joints[number];
  if (joint.mimic) {
    const [name, times, offset] = joint.mimic;
    return times * valueOf(data.joints.findIndex((each) => each.name === name)) + offset;
  }
  return state.byHand ? state.byHand[number] : between(joint.values, state.time);
}
function sliders() {
  if (inputs.length && !$("values").open) return;
  for (const [number, slider, value] of inputs) {
    slider.value = valueOf(number);
    value.textContent = valueOf(number).toFixed(3) + (data.joints[number].kind === "prismatic" ? " m" : " rad");
  }
}
