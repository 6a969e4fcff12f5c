// An arm in its scene: bodies, floor and paths, and the picture of them at the time that is shown.
const RED = [0.86, 0.16, 0.2];

function showArm() {
  // Without a graphics card edges are smooth only while nothing moves.
  const bySoftware = isDrawnBySoftware(), gl = canvas.getContext("webgl2", { antialias: !bySoftware, alpha: false });
  if (!gl) { $("note").textContent = "This browser has no WebGL 2, which shows an arm."; return null; }
  const painter = makePainter(gl), bodies = data.bodies.map(bodyOf);
  function bodyOf(body) {
    const vertices = new Float32Array(bytes(body.v)), corners = new Uint32Array(bytes(body.t));
    return { ...body, vertices, corners, ...painter.mesh(vertices, new Int8Array(bytes(body.n)), corners) };
  }

  // What is to be seen: the arm at some states, its tips along the path, and the scene as far as it is near.
  const arm = boundsOf([0, times.length >> 1, times.length - 1].flatMap((i) => {
    const poses = posesOf(i), shown = bodies.filter((body) => body.set === data.sets[0]);
    return shown.flatMap((body) => everyNth(body.vertices, 7).map((vertex) => moved(poses[body.link], vertex)));
  }).concat(times.flatMap((_, i) => data.tips.map((tip) => at3(posesOf(i)[tip])))));
  const whole = boundsOf(bodies.filter((body) => body.set === "scene").flatMap(cornersOf).concat(arm.low && [arm.low, arm.high]));
  const near = 0.4 * Math.max(...arm.low.map((each, k) => arm.high[k] - each));
  function points() { // corners of the arm's box, and of the obstacles' boxes near to it
    const low = arm.low.map((each) => each - near), high = arm.high.map((each) => each + near);
    const boxes = bodies.filter((body) => body.set === "scene").map((body) => boundsOf(cornersOf(body)))
      .filter((box) => [0, 1, 2].every((k) => box.low[k] < high[k] && box.high[k] > low[k]))
      .map((box) => ({ low: box.low.map((each, k) => Math.max(each, low[k])), high: box.high.map((each, k) => Math.min(each, high[k])) }));
    return [...boxes, arm].flatMap(boxCorners);
  }
  const fitted = boundsOf(points()), size = Math.max(Math.hypot(...fitted.low.map((each, k) => fitted.high[k] - each)), 0.1);
  const ground = { z: Math.min(whole.low[2], 0) - 0.002 * size, at: [0, 1, 2].map((k) => 0.5 * (fitted.low[k] + fitted.high[k])) };
  ground.reach = 2.2 * Math.max(size, 0.5 * Math.hypot(...whole.low.slice(0, 2).map((each, k) => Math.min(whole.high[k] - each, 20))));
  ground.spacing = [0.05, 0.1, 0.25, 0.5, 1, 2.5, 5].find((each) => each > 0.12 * size) || 10;
  const [x, y] = ground.at, r = ground.reach;
  const floor = painter.mesh(new Float32Array([x - r, y - r, ground.z, x + r, y - r, ground.z, x + r, y + r, ground.z, x - r, y + r, ground.z]),
    new Float32Array(12), new Uint32Array([0, 1, 2, 0, 2, 3]));
  const camera = makeCamera(data.turn, { points, ground: ground.z, size });

  // The lamp stands behind the camera's left shoulder, as the page opens, high above.
  const { right, back } = lookAlong([Math.cos(data.turn), Math.sin(data.turn), 0], [0, 0, 0]);
  const light = unit(back.map((each, k) => (k === 2 ? 1.15 : 0) + 0.55 * each - 0.5 * right[k]));
  const lamp = times4([1 / size, 0, 0, 0, 0, 1 / size, 0, 0, 0, 0, -0.4 / size, 0, 0, 0, 0, 1], lookAlong(light, ground.at).matrix);

  let trails = [];
  function follow() { // the path of each tip as a tube, red and coloured by clearance
    trails.flat().forEach(painter.discard);
    const thick = Math.min(Math.max(0.0045 * size, 0.003), 0.02);
    const colours = [() => RED, ...(data.clearance ? [(i) => hue(data.clearance[i])] : [])];
    trails = !data.path ? [] : data.tips.map((tip) => {
      const points = times.map((_, i) => at3(posesOf(i)[tip]));
      return colours.map((tint) => tube(painter, points, tint, thick));
    });
  }
  follow();

  const made = { painter, bodies, bodyOf, camera, follow, points, ground: ground.z, after: () => {} };
  draw = () => {
    const paper = getComputedStyle(document.body).backgroundColor.match(/\d+/g).slice(0, 3).map((each) => each / 255);
    const moves = state.playing || state.held;
    const dense = bySoftware ? (moves ? 0.75 : live ? 1 : 1.25) : Math.min(devicePixelRatio || 1, 2);
    [canvas.width, canvas.height] = [innerWidth, innerHeight].map((each) => Math.round(each * dense));
    if (!camera.eye.own) camera.fitted();
    const view = camera.view(), poses = posesAt(valueOf), poseOf = (body) => body.pose || poses[body.link];
    // The first way to show the arm is solid; others are seen through, over it.
    const first = data.sets.find((name) => state.shown.has(name));
    const shown = bodies.filter((body) => (["scene", "held", first].includes(body.set)) && isThere(body));
    painter.lightUp(lamp, () => { for (const body of shown) painter.paint(body, poseOf(body)); });
    painter.begin(view, lamp, light, ground, paper);
    painter.paint(floor, identity(), [0, 0, 0, 1], FLOOR);
    for (const body of shown) painter.paint(body, poseOf(body), [...colourOf(body), 1], BODY);
    paintTrails();
    over(bodies.filter((body) => !["scene", "held", first].includes(body.set) && state.shown.has(body.set)), poseOf, () => [0.93, 0.6, 0.12, 0.4]);
    made.after(over);
    say();
  };
  function isThere(body) { // a body of a task, which is now here and now held
    return !body.when || body.when.some(([from, to]) => from <= state.time && state.time < to);
  }
  function colourOf(body) {
    if (!isColoured() || ["scene", "held"].includes(body.set) || state.byHand) return body.colour;
    return hueNow().map((each, k) => 0.75 * each + 0.25 * body.colour[k]);
  }
  function paintTrails() { // also where bodies hide them, faintly
    const chosen = trails.map(([red, coloured]) => isColoured() ? coloured : red);
    for (const trail of chosen) painter.paint(trail, identity(), [0, 0, 0, -1], PATH);
    blend(() => {
      gl.depthFunc(gl.GREATER); gl.depthMask(false);
      for (const trail of chosen) painter.paint(trail, identity(), [0, 0, 0, -0.35], PATH);
      gl.depthFunc(gl.LESS); gl.depthMask(true);
    });
  }
  function blend(paint) {
    gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    paint();
    gl.disable(gl.BLEND);
  }
  function over(shown, poseOf, colour) { // translucent bodies: depth first, so that of each pixel only the nearest face is blended
    blend(() => {
      gl.colorMask(false, false, false, false);
      for (const body of shown) painter.paint(body, poseOf(body), [0, 0, 0, 0], PLAIN);
      gl.colorMask(true, true, true, true); gl.depthFunc(gl.EQUAL);
      for (const body of shown) painter.paint(body, poseOf(body), colour(body), GHOST);
      gl.depthFunc(gl.LESS);
    });
  }
  fit = () => { camera.eye.turn = data.turn; camera.eye.up = 0.42; camera.fitted(); draw(); };
  return made;
}

function isDrawnBySoftware() {
  const gl = document.createElement("canvas").getContext("webgl2"), names = gl && gl.getExtension("WEBGL_debug_renderer_info");
  return Boolean(names) && /swiftshader|llvmpipe|softpipe|basic render/i.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}
function everyNth(vertices, step) {
  const found = [];
  for (let i = 0; i < vertices.length; i += 3 * step) found.push(vertices.subarray(i, i + 3));
  return found;
}
function boundsOf(points) {
  const low = [1e9, 1e9, 1e9], high = [-1e9, -1e9, -1e9];
  for (const point of points) for (let k = 0; k < 3; k++) {
    low[k] = Math.min(low[k], point[k]); high[k] = Math.max(high[k], point[k]);
  }
  return { low, high };
}
function boxCorners({ low, high }) {
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => i >> k & 1 ? high[k] : low[k]));
}
function cornersOf(body) { // of the box around an obstacle, where that is now
  body.box = body.box || boxCorners(boundsOf(everyNth(body.vertices, 1)));
  return body.box.map((corner) => moved(body.pose, corner));
}
