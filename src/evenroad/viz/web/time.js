"use strict";
// The plan that is shown, the time along it, and the bar that plays it.
const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent), live = data.live, canvas = $("view");
const state = { time: 0, playing: false, byHand: null, shown: new Set(), coloured: false, last: 0, rest: 0, drawn: 0, held: false,
  graph: false, hands: true, chosen: null, swept: true };
const REST = 700; // milliseconds at the end before the path is played again
let times, end, near, far;
let update = () => {}, draw = () => {}, fit = () => {};

function take(plan) { // a plan: the first one, or that of a page that plans again
  Object.assign(data, plan);
  if (plan.values) data.joints.forEach((joint, number) => { joint.values = plan.values[number]; });
  times = data.times; end = times[times.length - 1];
  near = data.clearance ? Math.min(...data.clearance) : 0; far = data.clearance ? Math.max(...data.clearance) : 1;
  $("title").textContent = data.title; $("note").textContent = data.note || "";
  $("time").max = end; state.time = Math.min(state.time, end);
}
take({ ...data, path: data.path !== false });
document.title = data.name + " · evenroad";

function share(time) { // number of the state before a time, that of the next, and how far it is to that
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  const step = times[high] - times[low];
  return [low, high, step > 0 ? Math.min(Math.max((time - times[low]) / step, 0), 1) : 0];
}
function between(values, time) {
  const [a, b, s] = share(time);
  return values[a] + s * (values[b] - values[a]);
}
const length = (value) => data.unit === "m" ? (1000 * value).toFixed(0) + " mm" : value.toFixed(1) + " px";

function say() {
  $("time").value = state.time;
  const clear = data.clearance ? " · " + length(between(data.clearance, state.time)) + " clear" : "";
  const now = data.timed ? `${state.time.toFixed(2)} s of ${end.toFixed(2)} s` : `${(100 * state.time / end).toFixed(0)} %`;
  $("now").value = now + (state.byHand ? " · by hand" : clear);
  $("play").textContent = state.playing ? "Pause" : "Play";
  state.drawn = state.drawn || performance.now();
}
function go(time) { state.time = Math.min(Math.max(time, 0), end); state.byHand = null; sliders(); draw(); }
function play(on) {
  if (on && state.time >= end) state.time = 0;
  state.playing = on; state.rest = 0; state.last = performance.now();
  if (on) { state.byHand = null; requestAnimationFrame(frame); }
  if (on) say(); else draw();
}
function frame(now) {
  if (!state.playing) return;
  const passed = Math.min(now - state.last, 100);
  state.last = now;
  let time = state.time + passed / 1000 * +$("speed").value;
  if (state.rest > 0) {
    state.rest -= passed;
    time = state.rest > 0 ? end : 0;
  } else if (time >= end) {
    time = end;
    if ($("loop").checked) state.rest = REST; else state.playing = false;
  }
  if (time !== state.time) go(time); else say();
  if (state.playing) requestAnimationFrame(frame);
}
$("play").onclick = () => play(!state.playing);
$("time").oninput = (event) => { state.playing = false; go(+event.target.value); };
$("fit").onclick = () => fit();
addEventListener("keydown", (event) => {
  if (["BUTTON", "INPUT", "SELECT", "SUMMARY"].includes(event.target.tagName)) return;
  if (event.key === " ") { event.preventDefault(); play(!state.playing); }
  if (event.key === "f") fit();
});
addEventListener("resize", () => draw());

function hue(clear) { // red, yellow, green
  const s = Math.min(Math.max((clear - near) / Math.max(far - near, 1e-9), 0), 1);
  const stops = [[0.82, 0.2, 0.23], [0.91, 0.76, 0.23], [0.18, 0.62, 0.35]], i = s < 0.5 ? 0 : 1, t = 2 * s - i;
  return stops[i].map((each, k) => each + t * (stops[i + 1][k] - each));
}
const hueNow = () => hue(between(data.clearance, state.time));
const isColoured = () => state.coloured && data.clearance;
const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => draw());

function freeArea() { // what no pane covers: left, top, right and bottom [pixels]
  const side = $("side"), beside = side.open && innerWidth > 640, below = side.open && !beside ? side : $("bar");
  return { left: 0, top: $("said").offsetTop + $("said").offsetHeight + 8,
    right: beside ? side.offsetLeft - 8 : innerWidth, bottom: below.offsetTop - 8 };
}
