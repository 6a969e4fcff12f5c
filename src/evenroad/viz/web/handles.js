// Start and goal as translucent arms, and handles that move their tips, and a chosen obstacle: three arrows, three rings.
const GREEN = [0.11, 0.62, 0.35], BLUE = [0.18, 0.37, 0.82];

function offerHandles(arm) {
  const { painter, bodies, camera } = arm, { gl } = painter, REACH = 0.16;
  const parts = [0, 1, 2].flatMap((axis) => {
    const along = (s) => { const point = [0, 0, 0]; point[axis] = REACH * s; return point; };
    const around = (i) => {
      const point = [0, 0, 0], turn = 2 * Math.PI * i / 48;
      point[(axis + 1) % 3] = 0.75 * REACH * Math.cos(turn); point[(axis + 2) % 3] = 0.75 * REACH * Math.sin(turn);
      return point;
    };
    return [{ axis, turns: false, points: [0, 0.2, 0.4, 0.6, 0.8, 1].map(along) },
      { axis, turns: true, points: Array.from({ length: 49 }, (_, i) => around(i)) }];
  });
  for (const part of parts) part.mesh = tube(painter, part.points, () => [0, 1, 2].map((k) => k === part.axis ? 0.85 : 0.2), 0.004);
  let grip = null, lines = null; // what is dragged: its handle and part, and by how many metres or radians a pixel moves it

  function handles() { // what is dragged is where the pointer wants it, all others where the arm and the obstacles are
    const terminals = state.hands ? Object.entries(data.terminals).map(([name, { pose }]) => ({ do: "pose", name, pose })) : [];
    const chosen = bodies.filter((body) => body.set === "scene" && body.name === state.chosen);
    return [...terminals, ...chosen.map(({ name, pose }) => ({ do: "move", name, pose }))].map((each) =>
      grip && grip.handle.do === each.do && grip.handle.name === each.name ? grip.handle : each);
  }
  arm.after = (over) => {
    if (lines) painter.paint(lines, identity(), [0.42, 0.54, 0.66, 1], PLAIN, gl.LINES);
    const own = bodies.filter((body) => body.set === data.sets[0]);
    // Where the arm itself is, too, only the arm is seen.
    gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(2, 8);
    for (const [name, colour] of [["start", GREEN], ["goal", BLUE]]) {
      const poses = posesAt((number) => data.terminals[name].values[number]);
      over(own, (body) => poses[body.link], () => [...colour, 0.4]);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL); gl.clear(gl.DEPTH_BUFFER_BIT);
    for (const handle of handles()) for (const part of parts) painter.paint(part.mesh, handle.pose, [0, 0, 0, -1], PATH);
  };
  accept = (plan) => {
    for (const body of plan.bodies || []) {
      const known = bodies.find((each) => each.set === "scene" && each.name === body.name);
      if (known) known.pose = body.pose; else { bodies.push(arm.bodyOf(body)); choose(body.name); }
    }
    if (plan.names) for (let i = bodies.length; i--;)
      if (bodies[i].set === "scene" && !plan.names.includes(bodies[i].name)) bodies.splice(i, 1).forEach(painter.discard);
    if (state.chosen && !data.names.includes(state.chosen)) choose(null);
    if (plan.times) arm.follow();
    const points = new Float32Array(state.graph && data.graph || []), count = points.length / 3;
    if (lines) painter.discard(lines);
    lines = count ? painter.mesh(points, new Float32Array(3 * count), Uint32Array.from({ length: count }, (_, i) => i)) : null;
  };

  function pixel(matrix, point) {
    const [x, y, depth] = seenBy(matrix, point);
    return [innerWidth * (0.5 + 0.5 * x), innerHeight * (0.5 - 0.5 * y), depth];
  }
  function handlePixels() { // of each handle's arrows: name, axis, and the pixels of its points
    const { matrix } = camera.view();
    return handles().flatMap(({ name, pose }) => parts.filter((part) => !part.turns).map(({ axis, points }) =>
      ({ name, axis, pixels: points.map((point) => pixel(matrix, moved(pose, point)).slice(0, 2)) })));
  }
  function gripped(x, y, most = 12) { // the handle's part within some pixels
    const { matrix } = camera.view();
    let best = null, nearest = most;
    for (const handle of handles()) for (const part of parts) {
      const seen = part.points.map((point) => pixel(matrix, moved(handle.pose, point)));
      // Arrows begin apart from each other.
      for (let i = part.turns ? 1 : 2; i < seen.length; i++) {
        const [a, b] = [seen[i - 1], seen[i]], d = [b[0] - a[0], b[1] - a[1]], square = d[0] * d[0] + d[1] * d[1];
        const s = Math.min(Math.max(((x - a[0]) * d[0] + (y - a[1]) * d[1]) / Math.max(square, 1e-9), 0), 1);
        const off = Math.hypot(x - a[0] - s * d[0], y - a[1] - s * d[1]);
        if (off < nearest && square > 1) {
          const step = part.turns ? 2 * Math.PI / 48 : REACH / 5;
          nearest = off; best = { handle, part, per: d.map((each) => step * each / square) };
        }
      }
    }
    return best;
  }
  function dragged(dx, dy) {
    const { handle, part, per } = grip, by = dx * per[0] + dy * per[1], axis = [0, 1, 2].map((k) => k === part.axis ? 1 : 0);
    handle.pose = [...times4(handle.pose, motion({ kind: part.turns ? "revolute" : "prismatic", axis }, by))];
    send({ do: handle.do, name: handle.name, xyz: at3(handle.pose), xyzw: quaternion(handle.pose) });
  }
  function clicked(x, y) { // the obstacle under a pixel, before which no other body is
    const { matrix } = camera.view(), poses = posesAt(valueOf), first = data.sets.find((name) => state.shown.has(name));
    let name = null, nearest = Infinity;
    for (const body of bodies) {
      if (body.set !== "scene" && body.set !== first) continue;
      const whole = times4(matrix, body.pose || poses[body.link]), seen = everyNth(body.vertices, 1).map((vertex) => pixel(whole, vertex));
      for (let i = 0; i < body.corners.length; i += 3) {
        const depth = depthAt(x, y, [0, 1, 2].map((k) => seen[body.corners[i + k]]));
        if (depth < nearest) { nearest = depth; name = body.set === "scene" ? body.name : null; }
      }
    }
    choose(name);
  }
  const pressed = (x, y) => { grip = x === null ? null : gripped(x, y); return grip !== null; };
  return { pressed, dragged, clicked, handlePixels };
}

function depthAt(x, y, [a, b, c]) { // of a triangle's pixels and depths; Infinity beside it, or behind the camera
  if (a[2] <= 0 || b[2] <= 0 || c[2] <= 0) return Infinity;
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
  const s = ((b[0] - x) * (c[1] - y) - (c[0] - x) * (b[1] - y)) / area, t = ((c[0] - x) * (a[1] - y) - (a[0] - x) * (c[1] - y)) / area;
  return s >= 0 && t >= 0 && s + t <= 1 ? 1 / (s / a[2] + t / b[2] + (1 - s - t) / c[2]) : Infinity;
}
