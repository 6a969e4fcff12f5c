// What paints triangles: programs and buffers of WebGL, and a lamp whose shadows fall on all bodies.
const VERTEX = `#version 300 es
in vec3 at; in vec3 normal; in vec3 tint;
uniform mat4 model, camera, lamp;
out vec3 world, turned, tinted, lit_at;
void main() {
  vec4 where = model * vec4(at, 1.0);
  world = where.xyz; turned = mat3(model) * normal; tinted = tint;
  lit_at = (lamp * vec4(world, 1.0)).xyz * 0.5 + 0.5;
  gl_Position = camera * where;
}`;
const FRAGMENT = `#version 300 es
precision highp float; precision highp sampler2DShadow;
in vec3 world, turned, tinted, lit_at; out vec4 seen;
uniform vec3 eye, light, paper, floor_at; uniform vec4 colour; uniform int kind; uniform float reach, spacing;
uniform sampler2DShadow shadows;
float lamplight() { // share of the lamp that is seen from here
  if (any(lessThan(lit_at, vec3(0.0))) || any(greaterThan(lit_at, vec3(1.0)))) return 1.0;
  vec2 step = vec2(0.6, -0.6) / 1400.0;
  float near = lit_at.z - 0.0008;
  return 0.5 * (texture(shadows, vec3(lit_at.xy + step, near)) + texture(shadows, vec3(lit_at.xy - step, near)));
}
void main() {
  if (kind == 1) { // the floor: fine lines that fade into the paper
    float away = smoothstep(0.35, 1.0, length(world.xy - floor_at.xy) / reach);
    if (away == 1.0) { seen = vec4(paper, 1.0); return; }
    vec2 lines = abs(fract(world.xy / spacing - 0.5) - 0.5) / fwidth(world.xy / spacing);
    float line = clamp(1.2 - min(lines.x, lines.y), 0.0, 1.0) * 0.16;
    vec3 ground = mix(paper * 0.96, vec3(0.5), line) * mix(0.66, 1.0, lamplight());
    seen = vec4(mix(ground, paper, away), 1.0); return;
  }
  if (kind == 2) { seen = colour; return; }
  vec3 n = normalize(turned), ray = normalize(world - eye), base = colour.a < 0.0 ? tinted : colour.rgb;
  if (dot(n, ray) > 0.0) n = -n;
  float facing = max(dot(n, light), 0.0), lamp = kind == 0 && facing > 0.0 ? lamplight() : 1.0;
  if (kind == 4) { seen = vec4(base * (0.78 + 0.3 * facing), abs(colour.a)); return; }
  float shine = pow(max(dot(n, normalize(light - ray)), 0.0), 40.0);
  vec3 shown = base * (0.5 + 0.14 * n.z + 0.54 * facing * lamp) + 0.2 * shine * lamp;
  seen = vec4(shown, kind == 3 ? colour.a : 1.0);
}`;
const DEPTH_VERTEX = `#version 300 es
in vec3 at; uniform mat4 model, camera;
void main() { gl_Position = camera * model * vec4(at, 1.0); }`;
const DEPTH_FRAGMENT = `#version 300 es
precision highp float; void main() {}`;
const BODY = 0, FLOOR = 1, PLAIN = 2, GHOST = 3, PATH = 4; // kinds of paint
const SHADOWS = 1400; // side of the picture that the lamp sees [pixels]

function makePainter(gl) {
  const lit = program(VERTEX, FRAGMENT), depth = program(DEPTH_VERTEX, DEPTH_FRAGMENT), [target, shadows] = lampPicture();
  let now = lit;
  function program(...texts) {
    const made = gl.createProgram();
    texts.forEach((text, i) => {
      const shader = gl.createShader([gl.VERTEX_SHADER, gl.FRAGMENT_SHADER][i]);
      gl.shaderSource(shader, text); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    });
    ["at", "normal", "tint"].forEach((name, i) => gl.bindAttribLocation(made, i, name));
    gl.linkProgram(made);
    const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS), at = {};
    for (let i = 0; i < count; i++) {
      const { name } = gl.getActiveUniform(made, i);
      at[name] = gl.getUniformLocation(made, name);
    }
    return { made, at };
  }
  function lampPicture() {
    const texture = gl.createTexture(), buffer = gl.createFramebuffer();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOWS, SHADOWS);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
    gl.drawBuffers([gl.NONE]); gl.bindFramebuffer(gl.FRAMEBUFFER, null); gl.bindTexture(gl.TEXTURE_2D, null);
    return [buffer, texture];
  }

  function mesh(vertices, normals, triangles, tints) {
    const vao = gl.createVertexArray(), buffers = []; gl.bindVertexArray(vao);
    const fill = (target, array) => {
      buffers.push(gl.createBuffer());
      gl.bindBuffer(target, buffers.at(-1)); gl.bufferData(target, array, gl.STATIC_DRAW);
    };
    const attribute = (i, array, size, type, normalised) => {
      fill(gl.ARRAY_BUFFER, array);
      gl.enableVertexAttribArray(i); gl.vertexAttribPointer(i, 3, type, normalised, size, 0);
    };
    const small = normals.BYTES_PER_ELEMENT === 1;
    attribute(0, vertices, 12, gl.FLOAT, false);
    attribute(1, normals, small ? 4 : 12, small ? gl.BYTE : gl.FLOAT, true);
    if (tints) attribute(2, tints, 12, gl.FLOAT, false);
    fill(gl.ELEMENT_ARRAY_BUFFER, triangles);
    return { vao, buffers, count: triangles.length };
  }
  function discard({ vao, buffers }) { gl.deleteVertexArray(vao); buffers.forEach((each) => gl.deleteBuffer(each)); }
  function paint(shape, pose, colour, kind, drawn = gl.TRIANGLES) {
    gl.uniformMatrix4fv(now.at.model, false, new Float32Array(pose));
    if (now === lit) { gl.uniform4fv(lit.at.colour, colour); gl.uniform1i(lit.at.kind, kind); }
    gl.bindVertexArray(shape.vao); gl.drawElements(drawn, shape.count, gl.UNSIGNED_INT, 0);
  }
  function lightUp(lamp, bodies) { // the lamp's picture, from which shadows follow; bodies are a function that paints them
    now = depth; gl.useProgram(depth.made);
    gl.bindTexture(gl.TEXTURE_2D, null); gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.viewport(0, 0, SHADOWS, SHADOWS); gl.clear(gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.POLYGON_OFFSET_FILL); gl.polygonOffset(2, 4);
    gl.uniformMatrix4fv(depth.at.camera, false, new Float32Array(lamp));
    bodies();
    gl.disable(gl.POLYGON_OFFSET_FILL); gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }
  function begin(view, lamp, light, ground, paper) { // a picture without bodies
    now = lit; gl.useProgram(lit.made);
    const { at } = lit;
    gl.bindTexture(gl.TEXTURE_2D, shadows); gl.uniform1i(at.shadows, 0);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...paper, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(at.camera, false, new Float32Array(view.matrix));
    gl.uniformMatrix4fv(at.lamp, false, new Float32Array(lamp));
    gl.uniform3fv(at.eye, view.from); gl.uniform3fv(at.light, light); gl.uniform3fv(at.paper, paper);
    gl.uniform3fv(at.floor_at, ground.at); gl.uniform1f(at.reach, ground.reach); gl.uniform1f(at.spacing, ground.spacing);
  }
  return { gl, mesh, discard, paint, lightUp, begin };
}

function tube(painter, points, tint, radius) { // a tube through points, whose colour is a function of the point's number
  const vertices = [], normals = [], tints = [], triangles = [], sides = 8;
  points.forEach((point, i) => {
    const before = points[Math.max(i - 1, 0)], along = unit(points[Math.min(i + 1, points.length - 1)].map((each, k) => each - before[k]));
    const aside = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), up = cross(along, aside);
    for (let s = 0; s < sides; s++) {
      const turn = 2 * Math.PI * s / sides, n = aside.map((each, k) => Math.cos(turn) * each + Math.sin(turn) * up[k]);
      vertices.push(...point.map((each, k) => each + radius * n[k])); normals.push(...n); tints.push(...tint(i));
      if (i) for (const t of [[0, 1, 2], [1, 3, 2]]) triangles.push(...t.map((corner) =>
        (i - 1 + (corner >> 1)) * sides + (s + (corner & 1)) % sides));
    }
  });
  const [v, n, c] = [vertices, normals, tints].map((each) => new Float32Array(each));
  return painter.mesh(v, n, new Uint32Array(triangles), c);
}
function bytes(text) { return Uint8Array.from(atob(text), (each) => each.charCodeAt(0)).buffer; }
