// The camera: it turns around a point, never goes under the floor, and is fitted to what is to be seen.
const ZOOM = 2, LOWEST = 0.04, MARGIN = 0.94; // the lens; least height above the floor, and share of the free area that is filled

function makeCamera(turn, seen) { // seen: points that are fitted, the floor's height, and the size of the scene
  const eye = { turn, up: 0.42, away: 1, at: [0, 0, 0], own: false };
  function back() {
    const flat = Math.cos(eye.up);
    return [flat * Math.cos(eye.turn), flat * Math.sin(eye.turn), Math.sin(eye.up)];
  }
  function lens() { // its middle is that of the free area
    const { left, top, right, bottom } = freeArea(), ratio = innerWidth / innerHeight;
    const first = Math.max(0.02 * eye.away, 0.002 * seen.size), last = eye.away + 12 * seen.size;
    const aside = (left + right) / innerWidth - 1, above = 1 - (top + bottom) / innerHeight;
    return { across: ZOOM / Math.max(ratio, 1), up: ZOOM * Math.min(ratio, 1), aside, above, first, last };
  }
  function view() {
    const looking = lookAlong(back(), eye.at.map((each, k) => each + eye.away * back()[k])), { across, up, aside, above, first, last } = lens();
    const projected = [across, 0, 0, 0, 0, up, 0, 0, -aside, -above, (last + first) / (first - last), -1,
      0, 0, 2 * last * first / (first - last), 0];
    return { ...looking, matrix: times4(projected, looking.matrix) };
  }
  function settle() { // above the floor, and neither too near nor too far
    const low = seen.ground + LOWEST * seen.size;
    eye.away = Math.min(Math.max(eye.away, 0.05 * seen.size), 6 * seen.size);
    eye.at[2] = Math.max(eye.at[2], seen.ground);
    const least = Math.asin(Math.min((low - eye.at[2]) / eye.away, 1));
    eye.up = Math.min(Math.max(eye.up, least, -1.5), 1.55);
  }
  function fitted() { // the nearest camera from this side that has all points in the free area
    const { left, top, right, bottom } = freeArea(), points = seen.points();
    const wide = MARGIN * (right - left) / innerWidth, high = MARGIN * (bottom - top) / innerHeight;
    eye.at = [0, 1, 2].map((k) => 0.5 * (Math.min(...points.map((p) => p[k])) + Math.max(...points.map((p) => p[k]))));
    eye.away = seen.size; eye.own = false;
    for (let i = 0; i < 6; i++) {
      const { matrix, right: aside, up } = view(), { across, up: zoom, aside: x, above: y } = lens(), low = [1e9, 1e9], most = [-1e9, -1e9];
      for (const point of points) seenBy(matrix, point).slice(0, 2).forEach((each, k) => {
        low[k] = Math.min(low[k], each - [x, y][k]); most[k] = Math.max(most[k], each - [x, y][k]);
      });
      const off = [0, 1].map((k) => 0.5 * (low[k] + most[k]) * eye.away / [across, zoom][k]);
      eye.at = eye.at.map((each, k) => each + off[0] * aside[k] + off[1] * up[k]);
      eye.away *= Math.max(0.5 * (most[0] - low[0]) / wide, 0.5 * (most[1] - low[1]) / high, 0.4);
    }
    settle();
  }
  function turned(x, y) { eye.turn -= 0.008 * x; eye.up += 0.008 * y; eye.own = true; settle(); }
  function shifted(x, y) {
    const { right, up } = view(), size = eye.away / innerHeight;
    eye.at = eye.at.map((each, k) => each - size * x * right[k] + size * y * up[k]);
    eye.own = true; settle();
  }
  function nearer(factor) { eye.away *= factor; eye.own = true; settle(); }
  return { eye, view, fitted, turned, shifted, nearer };
}

function listenTo(pressed, dragged, clicked, camera) { // the pointer, the wheel, and one or two fingers
  const fingers = new Map();
  let began = null, takes = false;
  const apart = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
  canvas.onpointerdown = (event) => {
    canvas.setPointerCapture(event.pointerId); fingers.set(event.pointerId, [event.clientX, event.clientY]);
    began = [event.clientX, event.clientY]; state.held = true;
    takes = fingers.size === 1 && pressed(...began);
  };
  canvas.onpointerup = canvas.onpointercancel = (event) => {
    fingers.delete(event.pointerId);
    if (!takes && began && Math.hypot(event.clientX - began[0], event.clientY - began[1]) < 4) clicked(...began);
    pressed(null); began = null; takes = false; state.held = fingers.size > 0; draw();
  };
  canvas.onpointermove = (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const x = event.clientX - before[0], y = event.clientY - before[1], wide = fingers.size > 1 ? apart() : 0;
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (takes) dragged(x, y);
    else if (wide) { camera.nearer(wide / Math.max(apart(), 1)); camera.shifted(0.5 * x, 0.5 * y); }
    else if (event.shiftKey || event.buttons === 2) camera.shifted(x, y);
    else camera.turned(x, y);
    draw();
  };
  canvas.oncontextmenu = (event) => event.preventDefault();
  canvas.addEventListener("wheel", (event) => { event.preventDefault(); camera.nearer(Math.exp(0.001 * event.deltaY)); draw(); }, { passive: false });
}
