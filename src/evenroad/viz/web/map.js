// A disk or a car on its map: obstacles, the path and what it sweeps, and the robot at the time that is shown.
function showMap() {
  const shown = canvas.getContext("2d"), layer = document.createElement("canvas"), picture = new Image();
  const last = data.states.length - 1;
  let pen = shown, painted = ""; // what is drawn on, and what the layer of all that stands still was painted for
  if (data.picture) { picture.onload = () => { painted = ""; draw(); }; picture.src = data.picture; }
  const reach = data.radius || Math.max(...data.outlines.flat().map((each) => Math.hypot(...each)));
  const eye = { scale: 1, at: [0, 0], own: false }; // pixels of a cell, and the map's position in the middle of the window
  const css = (colour, opacity) => `rgba(${colour.map((each) => Math.round(255 * each))}, ${opacity})`;

  function fitted() { // the whole map in what no pane covers
    const { left, top, right, bottom } = freeArea(), [width, height] = data.size;
    eye.scale = 0.98 * Math.min((right - left - 16) / width, (bottom - top) / height);
    eye.at = [width / 2 + (innerWidth - left - right) / 2 / eye.scale, height / 2 + (innerHeight - top - bottom) / 2 / eye.scale];
    eye.own = false;
  }
  function obstacles(dark, thin) { // polygons with their holes; walls of no thickness are lines
    pen.fillStyle = dark ? "#242424" : "#fff"; pen.fillRect(0, 0, ...data.size);
    pen.fillStyle = pen.strokeStyle = dark ? "#bdbdbd" : "#282828"; pen.lineWidth = thin;
    for (const borders of data.polygons) {
      pen.beginPath();
      for (const border of borders) { border.forEach((at, i) => pen[i ? "lineTo" : "moveTo"](...at)); pen.closePath(); }
      pen.fill("evenodd"); pen.stroke();
    }
  }
  function outline([x, y, angle = 0]) { // of the robot at a state
    pen.beginPath();
    if (data.radius) { pen.arc(x, y, data.radius, 0, 2 * Math.PI); return; }
    const c = Math.cos(angle), s = Math.sin(angle);
    for (const corners of data.outlines) {
      corners.forEach(([a, b], i) => pen[i ? "lineTo" : "moveTo"](x + c * a - s * b, y + s * a + c * b));
      pen.closePath();
    }
  }
  function robot(state, fill, line) {
    outline(state); pen.fillStyle = fill; pen.fill();
    if (line) { pen.strokeStyle = line; pen.stroke(); }
    if (data.radius) return;
    // An arrow from the reference point says where its front is.
    const [x, y, angle] = state, at = (a, b) => [x + Math.cos(angle) * a - Math.sin(angle) * b, y + Math.sin(angle) * a + Math.cos(angle) * b];
    pen.beginPath(); pen.moveTo(...at(0.45 * reach, 0)); pen.lineTo(...at(0, 0.22 * reach)); pen.lineTo(...at(0, -0.22 * reach)); pen.closePath();
    pen.fillStyle = line || fill; pen.fill();
  }
  function path(dark) {
    for (let i = 1; i <= last; i++) {
      pen.strokeStyle = isColoured() ? css(hue(data.clearance[i]), 1) : dark ? "#ff7a7f" : "#d1343b";
      pen.beginPath(); pen.moveTo(...data.states[i - 1].slice(0, 2)); pen.lineTo(...data.states[i].slice(0, 2)); pen.stroke();
    }
  }
  function paintStill(dark, thin) { // the map, what the robot sweeps, its path, start and goal
    pen.imageSmoothingEnabled = false; pen.lineJoin = pen.lineCap = "round";
    if (data.picture) { pen.filter = dark ? "invert(0.86)" : "none"; pen.drawImage(picture, 0, 0, ...data.size); pen.filter = "none"; }
    else obstacles(dark, thin);
    pen.fillStyle = dark ? "#2c4763" : "#cfe4f7";
    if (state.swept) for (const each of data.states) { outline(each); pen.fill(); }
    pen.lineWidth = 2.5 * thin;
    path(dark);
    pen.lineWidth = 1.5 * thin;
    robot(data.states[0], dark ? "rgba(48, 190, 116, 0.6)" : "rgba(27, 158, 90, 0.4)");
    robot(data.states[last], dark ? "rgba(92, 140, 245, 0.6)" : "rgba(47, 95, 208, 0.4)");
  }
  draw = () => {
    const dense = devicePixelRatio || 1, dark = isDark(), size = [innerWidth, innerHeight].map((each) => Math.round(each * dense));
    if (!eye.own) fitted();
    const scale = eye.scale * dense, [x, y] = eye.at, thin = dense / scale;
    const frame = [scale, 0, 0, scale, size[0] / 2 - scale * x, size[1] / 2 - scale * y];
    const now = [size, frame, dark, state.swept, isColoured()].join();
    if (now !== painted) {
      [layer.width, layer.height] = size; painted = now; pen = layer.getContext("2d");
      pen.setTransform(...frame);
      paintStill(dark, thin);
      pen = shown;
    }
    [canvas.width, canvas.height] = size;
    pen.drawImage(layer, 0, 0); pen.setTransform(...frame); pen.lineWidth = 1.5 * thin;
    const [a, b, s] = share(state.time), pose = data.states[a].map((each, k) => each + s * (data.states[b][k] - each));
    robot(pose, isColoured() ? css(hueNow(), 0.85) : "rgba(209, 52, 59, 0.75)", dark ? "#ffc9c9" : "#8d1e24");
    say();
  };
  fit = () => { fitted(); draw(); };
  option("swept area", true, (on) => { state.swept = on; });
  const shifted = (dx, dy) => { eye.at = [eye.at[0] - dx / eye.scale, eye.at[1] - dy / eye.scale]; eye.own = true; };
  return { shifted, turned: shifted, nearer: (factor) => { eye.scale /= factor; eye.own = true; } };
}
