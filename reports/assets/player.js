// 3D playback on WebGL2: instanced meshes, one shadow map, ground grid, orbit and zoom. Without WebGL2 the film remains.
async function startPlayer(figure) {
  const stage = figure.querySelector(".stage");
  const scene = JSON.parse(figure.querySelector(".scene").textContent);
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) {
    stage.innerHTML = '<p class="absent">This browser offers no WebGL2; the film below shows the run.</p>';
    figure.querySelector(".controls").remove();
    return false;
  }
  const vertices = new Float32Array(await unpacked(figure.querySelector(".meshes").textContent));
  const poses = decodedPoses(scene, new Int16Array(await unpacked(figure.querySelector(".poses").textContent)));
  stage.append(canvas);
  const reading = document.createElement("span");
  reading.className = "reading";
  stage.append(reading);
  stage.tabIndex = 0;
  const draw = sceneRenderer(gl, scene, vertices, poses);
  const camera = { azimuth: -0.95, elevation: 0.3, distance: 1.45 * scene.reach };
  let frame = 0, playing = false, clock = 0;

  const controls = name => figure.querySelector("." + name);
  const seek = controls("seek"), play = controls("play"), time = () => scene.start + frame / scene.rate;
  seek.max = scene.frames - 1;
  const show = () => {
    const width = Math.max(1, Math.round(stage.clientWidth * Math.min(devicePixelRatio, 2)));
    const height = Math.max(1, Math.round(stage.clientHeight * Math.min(devicePixelRatio, 2)));
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    draw(frame, camera);
  };
  const speed = () => {
    const a = Math.max(0, frame - 1), b = Math.min(scene.frames - 1, frame + 1);
    const d = [0, 1, 2].map(k => scene.origin[3 * b + k] - scene.origin[3 * a + k]);
    return b > a ? Math.hypot(...d) * scene.rate / (b - a) : 0;
  };
  const set = f => {
    frame = Math.max(0, Math.min(scene.frames - 1, Math.round(f)));
    seek.value = frame;
    controls("clock").textContent = `${time().toFixed(2)} of ${(scene.start + (scene.frames - 1) / scene.rate).toFixed(1)} s`;
    reading.textContent = `${speed().toFixed(1)} m/s`;
    show();
    document.dispatchEvent(new CustomEvent("grouser-time", { detail: { part: figure.dataset.player, time: time() } }));
  };
  const tick = now => {
    if (!playing) return;
    const steps = Math.floor((now - clock) / 1000 * scene.rate * Number(controls("rate").value));
    if (steps > 0) {
      clock = now;
      set(frame + steps >= scene.frames ? 0 : frame + steps);
    }
    requestAnimationFrame(tick);
  };
  const toggle = () => {
    playing = !playing;
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-label", play.textContent);
    clock = performance.now();
    if (playing) requestAnimationFrame(tick);
  };

  play.onclick = toggle;
  seek.oninput = () => set(Number(seek.value));
  const views = { quarter: [-0.95, 0.3, 1.45], side: [-Math.PI / 2, 0.06, 1.35], front: [0, 0.16, 1.25], top: [-Math.PI / 2, 1.5, 1.6] };
  controls("view").onchange = e => {
    const [azimuth, elevation, distance] = views[e.target.value];
    Object.assign(camera, { azimuth, elevation, distance: distance * scene.reach });
    show();
  };
  orbit(stage, camera, scene, show);
  stage.addEventListener("keydown", e => {
    if (e.key === " ") toggle();
    else if (e.key === "ArrowRight") set(frame + 1);
    else if (e.key === "ArrowLeft") set(frame - 1);
    else return;
    e.preventDefault();
  });
  document.addEventListener("grouser-seek", e => { if (e.detail.part === figure.dataset.player) set((e.detail.time - scene.start) * scene.rate); });
  new ResizeObserver(show).observe(stage);
  set(Math.round(0.4 * scene.frames));
  return true;
}

// Pointers turn the camera, two of them or the wheel zoom.
function orbit(stage, camera, scene, show) {
  const pointers = new Map();
  let gap = 0;
  const zoom = factor => { camera.distance = Math.max(0.25 * scene.reach, Math.min(6 * scene.reach, camera.distance * factor)); };
  stage.addEventListener("pointerdown", e => { stage.setPointerCapture(e.pointerId); pointers.set(e.pointerId, e); gap = 0; });
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, e => { pointers.delete(e.pointerId); gap = 0; });
  stage.addEventListener("pointermove", e => {
    const before = pointers.get(e.pointerId);
    if (!before) return;
    if (pointers.size === 1) {
      camera.azimuth -= (e.clientX - before.clientX) * 0.008;
      camera.elevation = Math.max(0.01, Math.min(1.54, camera.elevation + (e.clientY - before.clientY) * 0.006));
    }
    pointers.set(e.pointerId, e);
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()], wide = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (gap > 0) zoom(gap / wide);
      gap = wide;
    }
    show();
  });
  stage.addEventListener("wheel", e => { e.preventDefault(); zoom(Math.exp(e.deltaY * 0.001)); show(); }, { passive: false });
}

// Poses travel as differences from frame to frame, [body][x y z qx qy qz qw][frame]; here they become [frame][body][7],
// positions relative to the origin track.
function decodedPoses(scene, steps) {
  const { frames, bodies } = scene, poses = new Float32Array(frames * bodies * 7);
  for (let body = 0, at = 0; body < bodies; ++body)
    for (let k = 0; k < 7; ++k) {
      const scale = k < 3 ? scene.position_step : scene.rotation_step;
      for (let frame = 0, sum = 0; frame < frames; ++frame) {
        sum = (sum + steps[at++]) << 16 >> 16;
        poses[(frame * bodies + body) * 7 + k] = sum * scale;
      }
    }
  return poses;
}

const player_shaders = (() => {
  const common = `#version 300 es
precision highp float; precision highp sampler2DShadow;
uniform mat4 view, sun; uniform vec3 eye, light, focus; uniform float reach;`;
  const place = `
layout(location=0) in vec3 p; layout(location=1) in vec3 n; layout(location=2) in vec3 t; layout(location=3) in vec4 q; layout(location=4) in vec3 c;
vec3 turned(vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }`;
  const lit = `
uniform sampler2DShadow shadow;
const vec3 haze = vec3(0.60, 0.68, 0.75);
float lightness(vec3 w, vec3 n) {
  vec3 s = (sun * vec4(w + n * 0.012 * reach / 4.0, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(s, vec3(0.0))) || any(greaterThan(s, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int i = -1; i <= 1; ++i) for (int j = -1; j <= 1; ++j) sum += texture(shadow, vec3(s.xy + vec2(i, j) / 2048.0, s.z - 0.0012));
  return sum / 9.0;
}
vec3 shaded(vec3 a, vec3 n, vec3 w, float gloss) {
  vec3 v = normalize(eye - w);
  float nl = max(dot(n, light), 0.0), s = nl > 0.0 ? lightness(w, n) : 0.0;
  vec3 c = a * (mix(vec3(0.17, 0.16, 0.14), vec3(0.40, 0.46, 0.54), n.z * 0.5 + 0.5) + nl * s * vec3(1.75, 1.68, 1.55));
  c += gloss * s * pow(max(dot(n, normalize(v + light)), 0.0), 40.0);
  float far = length(w - eye) / (14.0 * reach);
  c = mix(c, haze, 1.0 - exp(-far * far));
  return pow(c, vec3(1.0 / 2.2));
}`;
  return {
    body: [common + place + `out vec3 normal, world, color;
void main() { world = turned(p) + t; normal = turned(n); color = c; gl_Position = view * vec4(world, 1.0); }`,
      common + lit + `in vec3 normal, world, color; out vec4 o;
void main() { vec3 n = normalize(gl_FrontFacing ? normal : -normal); o = vec4(shaded(color, n, world, 0.12), 1.0); }`],
    shadow: [common + place + `void main() { gl_Position = sun * vec4(turned(p) + t, 1.0); }`, common + `void main() {}`],
    ground: [common + `uniform vec3 origin; out vec3 world;
void main() { vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0; world = vec3(focus.xy + corner * 60.0 * reach, -origin.z); gl_Position = view * vec4(world, 1.0); }`,
      common + lit + `uniform vec3 origin; in vec3 world; out vec4 o;
float lines(vec2 g, float wide) { vec2 f = fwidth(g), d = abs(fract(g - 0.5) - 0.5); vec2 a = clamp((wide + f * 0.5 - d) / f, 0.0, 1.0) * min(vec2(1.0), wide * 3.0 / f); return max(a.x, a.y); }
void main() { vec2 g = world.xy + origin.xy; float k = max(0.55 * lines(g, 0.010), 0.9 * lines(g / 10.0, 0.0025));
  o = vec4(shaded(mix(vec3(0.36, 0.345, 0.315), vec3(0.20, 0.19, 0.175), k), vec3(0.0, 0.0, 1.0), world, 0.0), 1.0); }`],
  };
})();

function sceneRenderer(gl, scene, vertices, poses) {
  const program = ([vertex, fragment]) => {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    const at = {};
    for (const name of ["view", "sun", "eye", "light", "focus", "reach", "origin", "shadow"]) at[name] = gl.getUniformLocation(made, name);
    return { made, at };
  };
  const bodyPass = program(player_shaders.body), shadowPass = program(player_shaders.shadow), groundPass = program(player_shaders.ground);
  const buffer = (data, use) => {
    const made = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, data, use);
    return made;
  };
  const attribute = (i, size, stride, offset, divisor) => {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, size, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(i, divisor);
  };
  const meshBuffer = buffer(vertices, gl.STATIC_DRAW);
  const batches = scene.meshes.map((mesh, k) => {
    const mine = scene.instances.filter(instance => instance.mesh === k);
    const vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, meshBuffer);
    attribute(0, 3, 24, 24 * mesh.first, 0);
    attribute(1, 3, 24, 24 * mesh.first + 12, 0);
    const poseBuffer = buffer(mine.length * 28, gl.DYNAMIC_DRAW);
    attribute(2, 3, 28, 0, 1);
    attribute(3, 4, 28, 12, 1);
    buffer(new Float32Array(mine.flatMap(instance => instance.color)), gl.STATIC_DRAW);
    attribute(4, 3, 12, 0, 1);
    return { vao, poseBuffer, mine, count: mesh.count, poses: new Float32Array(mine.length * 7) };
  }).filter(batch => batch.mine.length > 0);

  const map = gl.createTexture(), mapSize = 2048;
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, mapSize, mapSize);
  for (const [key, value] of [[gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE], [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
    [gl.TEXTURE_MAG_FILTER, gl.LINEAR], [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]]) gl.texParameteri(gl.TEXTURE_2D, key, value);
  const shadowFrame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, shadowFrame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);

  return (frame, camera) => {
    const { azimuth, elevation, distance } = camera, { reach } = scene;
    const origin = scene.origin.slice(3 * frame, 3 * frame + 3), focus = [scene.focus[0], scene.focus[1], scene.focus[2]];
    const eye = [focus[0] + distance * Math.cos(elevation) * Math.cos(azimuth), focus[1] + distance * Math.cos(elevation) * Math.sin(azimuth),
      Math.max(0.1 - origin[2], focus[2] + distance * Math.sin(elevation))];
    const light = unit([0.35, -0.62, 0.92]);
    const view = product(perspective(0.62, gl.drawingBufferWidth / gl.drawingBufferHeight, 0.05 * reach, 80 * reach), looking(eye, focus));
    const sun = product(orthographic(1.0 * reach, 0.1 * reach, 6 * reach), looking(focus.map((x, i) => x + 3 * reach * light[i]), focus));
    const use = pass => {
      gl.useProgram(pass.made);
      gl.uniformMatrix4fv(pass.at.view, false, view);
      gl.uniformMatrix4fv(pass.at.sun, false, sun);
      gl.uniform3fv(pass.at.eye, eye); gl.uniform3fv(pass.at.light, light); gl.uniform3fv(pass.at.focus, focus);
      gl.uniform3fv(pass.at.origin, origin); gl.uniform1f(pass.at.reach, reach); gl.uniform1i(pass.at.shadow, 0);
    };
    const bodies = () => {
      for (const batch of batches) {
        gl.bindVertexArray(batch.vao);
        gl.drawArraysInstanced(gl.TRIANGLES, 0, batch.count, batch.mine.length);
      }
    };
    for (const batch of batches) {
      batch.mine.forEach((instance, i) => {
        const at = (frame * scene.bodies + instance.body) * 7;
        batch.poses.set(poses.subarray(at, at + 7), 7 * i);
      });
      gl.bindBuffer(gl.ARRAY_BUFFER, batch.poseBuffer);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, batch.poses);
    }
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.bindTexture(gl.TEXTURE_2D, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, shadowFrame);
    gl.viewport(0, 0, mapSize, mapSize);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    use(shadowPass); bodies();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0.793, 0.839, 0.877, 1);  // the haze, as the shaders show it
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    use(bodyPass); bodies();
    gl.disable(gl.CULL_FACE);
    use(groundPass);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  };
}

// Column-major 4 x 4 matrices and what a camera needs of vectors.
const minus = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const size = Math.hypot(...a); return a.map(x => x / size); };
const product = (a, b) => {
  const out = new Float32Array(16);
  for (let c = 0; c < 4; ++c) for (let r = 0; r < 4; ++r) for (let k = 0; k < 4; ++k) out[c * 4 + r] += a[k * 4 + r] * b[c * 4 + k];
  return out;
};
const looking = (eye, at) => {
  const f = unit(minus(at, eye)), s = unit(cross(f, Math.abs(f[2]) > 0.999 ? [0, 1, 0] : [0, 0, 1])), u = cross(s, f);
  return [s[0], u[0], -f[0], 0, s[1], u[1], -f[1], 0, s[2], u[2], -f[2], 0, -dot(s, eye), -dot(u, eye), dot(f, eye), 1];
};
const perspective = (angle, aspect, near, far) => {
  const t = 1 / Math.tan(angle / 2);
  return [t / aspect, 0, 0, 0, 0, t, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
};
const orthographic = (half, near, far) => [1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1];
