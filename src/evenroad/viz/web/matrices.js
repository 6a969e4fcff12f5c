// Matrices, column by column, and where a robot's links are.
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const length = Math.hypot(...a) || 1; return a.map((each) => each / length); };
const at3 = (pose) => [pose[12], pose[13], pose[14]];
const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

function times4(a, b) {
  const c = new Float64Array(16);
  for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++)
    for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}
const moved = (pose, [x, y, z]) => [0, 1, 2].map((k) => pose[k] * x + pose[4 + k] * y + pose[8 + k] * z + pose[12 + k]);
function seenBy(matrix, [x, y, z]) { // a point in a picture that is 2 x 2 large, and its depth
  const [u, v, , w] = [0, 1, 2, 3].map((k) => matrix[k] * x + matrix[4 + k] * y + matrix[8 + k] * z + matrix[12 + k]);
  return [u / w, v / w, w];
}
function lookAlong(back, from) { // the transform into the frame of a camera that looks against `back`; z is up
  const right = unit(cross([0, 0, 1], back)), up = cross(back, right);
  return { right, up, back, from, matrix: [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0,
    right[2], up[2], back[2], 0, -dot(right, from), -dot(up, from), -dot(back, from), 1] };
}
function quaternion(pose) { // x, y, z, w of a pose's rotation, by the largest of the four
  const m = (row, column) => pose[4 * column + row], trace = m(0, 0) + m(1, 1) + m(2, 2);
  if (trace > 0) return [m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1), 1 + trace];
  const i = m(0, 0) > m(1, 1) ? (m(0, 0) > m(2, 2) ? 0 : 2) : (m(1, 1) > m(2, 2) ? 1 : 2), j = (i + 1) % 3, k = (i + 2) % 3;
  const found = [0, 0, 0, m(k, j) - m(j, k)];
  found[i] = 1 + m(i, i) - m(j, j) - m(k, k); found[j] = m(j, i) + m(i, j); found[k] = m(k, i) + m(i, k);
  return found;
}

function motion(joint, value) {
  if (joint.kind === "fixed") return identity();
  const [x, y, z] = joint.axis;
  if (joint.kind === "prismatic") return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x * value, y * value, z * value, 1];
  const s = Math.sin(value), v = 1 - Math.cos(value), c = 1 - v;
  return [c + x * x * v, z * s + x * y * v, -y * s + x * z * v, 0, -z * s + x * y * v, c + y * y * v, x * s + y * z * v, 0,
    y * s + x * z * v, -x * s + y * z * v, c + z * z * v, 0, 0, 0, 0, 1];
}
function posesAt(value) { // frames of all links, for a function from the number of a joint to its value
  const poses = new Array(data.links); poses[0] = identity();
  data.joints.forEach((joint, number) => {
    poses[joint.child] = times4(times4(poses[joint.parent], joint.origin),
      motion(joint, joint.kind === "fixed" ? 0 : value(number)));
  });
  return poses;
}
const posesOf = (i) => posesAt((number) => data.joints[number].values[i]);
