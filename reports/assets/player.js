// 3D playback on WebGL2: instanced meshes, one shadow map, ground grid, orbit and zoom. Without WebGL2 the film stands in
// its place, without a film pictures do.
function standIn(figure) {
  const film = figure.parentElement.querySelector(".film"), stills = figure.parentElement.querySelector(".stills");
  const note = document.createElement("p");
  note.className = "lead";
  note.textContent = film ? "This browser offers no WebGL2: the film shows the run." : "This browser offers no WebGL2: pictures show the run.";
  if (stills) stills.hidden = false;
  figure.replaceWith(note);
}

async function startPlayer(figure) {
  const stage = figure.querySelector(".stage");
  const scene = JSON.parse(figure.querySelector(".scene").textContent);
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) {
    standIn(figure);
    return false;
  }
  const vertices = new Float32Array(await unpacked(figure.querySelector(".vertices").textContent));
  const indices = new Uint32Array(await unpacked(figure.querySelector(".indices").textContent));
  const poses = decodedPoses(scene, new Int16Array(await unpacked(figure.querySelector(".poses").textContent)));
  const packedTerrain = figure.querySelector(".terrain");
  const terrain = packedTerrain ? terrainOf(new Float32Array(await unpacked(packedTerrain.textContent))) : null;
  stage.append(canvas);
  const reading = document.createElement("span");
  reading.className = "reading";
  stage.append(reading);
  stage.tabIndex = 0;
  const draw = sceneRenderer(gl, scene, vertices, indices, poses, terrain);
  const camera = { azimuth: -0.85, elevation: 0.27, distance: 2.6 * scene.reach };
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
  const views = { quarter: [-0.85, 0.27, 2.6], side: [-Math.PI / 2, 0.06, 1.35], front: [0, 0.16, 1.25], top: [-Math.PI / 2, 1.5, 1.6] };
  controls("view").onchange = e => {
    const [azimuth, elevation, distance] = views[e.target.value];
    Object.assign(camera, { azimuth, elevation, distance: distance * scene.reach });
    show();
  };
  orbit(stage, camera, scene, show);
  const turn = (azimuth, elevation) => {
    camera.azimuth += azimuth;
    camera.elevation = Math.max(0.01, Math.min(1.54, camera.elevation + elevation));
    show();
  };
  const zoom = factor => { camera.distance = Math.max(0.25 * scene.reach, Math.min(6 * scene.reach, camera.distance * factor)); show(); };
  const keys = {
    " ": toggle, Home: () => set(0), End: () => set(scene.frames - 1), "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9),
    ArrowRight: e => e.shiftKey ? turn(-0.08, 0) : set(frame + 1), ArrowLeft: e => e.shiftKey ? turn(0.08, 0) : set(frame - 1),
    ArrowUp: e => e.shiftKey ? turn(0, 0.05) : set(frame + Math.round(scene.rate)), ArrowDown: e => e.shiftKey ? turn(0, -0.05) : set(frame - Math.round(scene.rate)),
  };
  stage.addEventListener("keydown", e => {
    if (!keys[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
    keys[e.key](e);
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

// Ground that is not level: a grid of heights, as triangles and as a height at any place.
function terrainOf(values) {
  const [rows, columns] = values, x = values.subarray(2, 2 + rows), y = values.subarray(2 + rows, 2 + rows + columns);
  const heights = values.subarray(2 + rows + columns), points = new Float32Array(6 * rows * columns), indices = [];
  // Slope between the neighbours on both sides.
  const slope = (axis, at, stride, k) => {
    const a = Math.max(0, at - 1), b = Math.min(axis.length - 1, at + 1);
    return (heights[k + (b - at) * stride] - heights[k + (a - at) * stride]) / (axis[b] - axis[a]);
  };
  for (let i = 0; i < rows; ++i)
    for (let j = 0; j < columns; ++j) {
      const k = i * columns + j;
      points.set([x[i], y[j], heights[k], ...unit([-slope(x, i, columns, k), -slope(y, j, 1, k), 1])], 6 * k);
      if (i + 1 < rows && j + 1 < columns) indices.push(k, k + columns, k + 1, k + 1, k + columns, k + columns + 1);
    }
  const cell = (axis, at) => {
    let low = 0, high = axis.length - 1;
    while (high - low > 1) { const mid = low + high >> 1; if (axis[mid] <= at) low = mid; else high = mid; }
    return [low, Math.max(0, Math.min(1, (at - axis[low]) / (axis[high] - axis[low])))];
  };
  const height = (px, py) => {
    const [i, u] = cell(x, px), [j, v] = cell(y, py), at = (a, b) => heights[(i + a) * columns + j + b];
    return (1 - u) * ((1 - v) * at(0, 0) + v * at(0, 1)) + u * ((1 - v) * at(1, 0) + v * at(1, 1));
  };
  return { points, indices: Uint32Array.from(indices), height };
}

// The light of render/shaders, so that this picture and the film look alike. Positions are relative to the chassis origin.
const player_shaders = (() => {
  const common = `#version 300 es
precision highp float; precision highp int; precision highp sampler2DShadow;
uniform mat4 view, shade_view; uniform vec3 eye, sun, focus, origin; uniform float reach, level; uniform vec4 footprint;`;
  const place = `
layout(location=0) in vec3 p; layout(location=1) in vec3 n; layout(location=2) in vec4 c; layout(location=3) in vec3 t; layout(location=4) in vec4 q; layout(location=5) in vec4 tint;
vec3 turned(vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }`;
  const lit = `
uniform sampler2DShadow shadow;
const vec3 horizon = vec3(0.66, 0.74, 0.82), zenith = vec3(0.23, 0.42, 0.68);
vec3 sky_color(vec3 direction) {
  vec3 sky = mix(horizon, zenith, 1.0 - exp(-3.2 * max(direction.z, 0.0)));
  return sky + 0.12 * pow(max(dot(direction, sun), 0.0), 24.0) * vec3(1.0, 0.92, 0.78);
}
float sunlight(vec3 w, vec3 n) {
  vec3 s = (shade_view * vec4(w + n * 0.004 * reach, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(s, vec3(0.002))) || any(greaterThan(s, vec3(0.998)))) return 1.0;
  float sum = 0.0;
  for (int i = -1; i <= 1; ++i) for (int j = -1; j <= 1; ++j) sum += texture(shadow, vec3(s.xy + vec2(i, j) * 1.1 / 2048.0, s.z - 0.0006));
  return sum / 9.0;
}
float under_vehicle(vec2 w, float softness) {
  vec2 d = w - focus.xy, local = abs(vec2(footprint.z * d.x + footprint.w * d.y, -footprint.w * d.x + footprint.z * d.y));
  vec2 inside = smoothstep(vec2(softness), vec2(-softness), local - footprint.xy);
  return inside.x * inside.y;
}
vec3 shaded(vec3 albedo, float gloss, vec3 w, vec3 n, float sky_share) {
  vec3 v = normalize(eye - w), h = normalize(v + sun);
  float facing = dot(n, sun), light = facing > 0.0 ? sunlight(w, n) * facing : 0.0;
  vec3 ambient = mix(vec3(0.20, 0.18, 0.15), vec3(0.40, 0.47, 0.58), 0.5 + 0.5 * n.z) * sky_share;
  float grazing = pow(1.0 - max(dot(n, v), 0.0), 5.0);
  float highlight = gloss * (0.35 + 0.65 * grazing) * pow(max(dot(n, h), 0.0), mix(8.0, 90.0, gloss)) * light;
  vec3 mirrored = 0.35 * gloss * grazing * sky_share * mix(vec3(0.2), horizon, 0.5 + 0.5 * reflect(-v, n).z);
  return albedo * (ambient + light * vec3(2.05, 1.93, 1.72)) + 1.3 * highlight * vec3(1.0, 0.95, 0.85) + mirrored;
}
vec3 developed(vec3 c) {
  c *= 0.62;
  return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}
vec4 seen(vec3 c, vec3 w) {
  float d = length(w - eye);
  return vec4(pow(developed(mix(c, horizon, 1.0 - exp(-d * d / 8100.0))), vec3(1.0 / 2.2)), 1.0);
}`;
  const ground = (given, normal) => common + lit + `in vec3 world; ${given} out vec4 o;
float lines(vec2 u, float width) {
  vec2 size = fwidth(u), drawn = clamp(vec2(width), size, vec2(0.5)), away = abs(fract(u + 0.5) - 0.5);
  vec2 cover = smoothstep(0.5 * drawn + 0.75 * size, 0.5 * drawn - 0.75 * size, away) * clamp(width / drawn, 0.0, 1.0);
  cover = mix(cover, vec2(width), clamp(2.0 * size - 1.0, 0.0, 1.0));
  return cover.x + cover.y - cover.x * cover.y;
}
void main() {
  vec2 g = world.xy + origin.xy;
  vec3 albedo = mix(vec3(0.34, 0.305, 0.25), vec3(0.17, 0.155, 0.13), 0.55 * lines(g, 0.022));
  albedo = mix(albedo, vec3(0.72, 0.68, 0.60), 0.60 * lines(g * 0.1, 0.006));
  o = seen(shaded(albedo, 0.02, world, ${normal}, 1.0 - 0.70 * under_vehicle(world.xy, 0.45)), world);
}`;
  return {
    body: [common + place + `out vec3 normal, world; flat out vec4 surface;
void main() { world = turned(p) + t; normal = turned(n); surface = vec4(mix(c.rgb, tint.rgb, tint.a), c.a); gl_Position = view * vec4(world, 1.0); }`,
      common + lit + `in vec3 normal, world; flat in vec4 surface; out vec4 o;
void main() {
  float share = 1.0 - 0.62 * under_vehicle(world.xy, 0.25) * (1.0 - smoothstep(0.1, 1.3, world.z + origin.z - level));
  o = seen(shaded(surface.rgb, surface.a, world, normalize(normal), share), world);
}`],
    shadow: [common + place + `void main() { gl_Position = shade_view * vec4(turned(p) + t, 1.0); }`, common + `void main() {}`],
    ground: [common + `out vec3 world;
void main() { vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0; world = vec3(focus.xy + corner * 320.0, -origin.z); gl_Position = view * vec4(world, 1.0); }`,
      ground("", "vec3(0.0, 0.0, 1.0)")],
    terrain: [common + `layout(location=0) in vec3 p; layout(location=1) in vec3 n; out vec3 world, normal;
void main() { world = p - origin; normal = n; gl_Position = view * vec4(world, 1.0); }`,
      ground("in vec3 normal;", "normalize(normal)")],
    sky: [common + `uniform mat4 from_clip; out vec3 beyond;
void main() { vec2 clip = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0; vec4 far = from_clip * vec4(clip, 1.0, 1.0); beyond = far.xyz / far.w; gl_Position = vec4(clip, 1.0, 1.0); }`,
      common + lit + `in vec3 beyond; out vec4 o;
void main() { o = vec4(pow(developed(sky_color(normalize(beyond - eye))), vec3(1.0 / 2.2)), 1.0); }`],
  };
})();

function sceneRenderer(gl, scene, vertices, indices, poses, terrain) {
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
    for (const name of ["view", "shade_view", "eye", "sun", "focus", "origin", "reach", "level", "footprint", "shadow", "from_clip"]) at[name] = gl.getUniformLocation(made, name);
    return { made, at };
  };
  const bodyPass = program(player_shaders.body), shadowPass = program(player_shaders.shadow), groundPass = program(terrain ? player_shaders.terrain : player_shaders.ground), skyPass = program(player_shaders.sky);
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
  const indexBuffer = gl.createBuffer();
  gl.bindVertexArray(null);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indexBuffer);
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  const batches = scene.meshes.map((mesh, k) => {
    const mine = scene.instances.filter(instance => instance.mesh === k);
    const vao = gl.createVertexArray(), stride = 40, first = stride * mesh.first_vertex;
    gl.bindVertexArray(vao);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indexBuffer);
    gl.bindBuffer(gl.ARRAY_BUFFER, meshBuffer);
    attribute(0, 3, stride, first, 0);
    attribute(1, 3, stride, first + 12, 0);
    attribute(2, 4, stride, first + 24, 0);
    const poseBuffer = buffer(mine.length * 28, gl.DYNAMIC_DRAW);
    attribute(3, 3, 28, 0, 1);
    attribute(4, 4, 28, 12, 1);
    buffer(new Float32Array(mine.flatMap(instance => instance.tint)), gl.STATIC_DRAW);
    attribute(5, 4, 16, 0, 1);
    return { vao, poseBuffer, mine, first: 4 * mesh.first_index, count: mesh.num_indices, poses: new Float32Array(mine.length * 7) };
  }).filter(batch => batch.mine.length > 0);

  const terrainArray = terrain ? gl.createVertexArray() : null;
  if (terrain) {
    gl.bindVertexArray(terrainArray);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, terrain.indices, gl.STATIC_DRAW);
    buffer(terrain.points, gl.STATIC_DRAW);
    attribute(0, 3, 24, 0, 0);
    attribute(1, 3, 24, 12, 0);
  }
  const heightAt = (x, y) => terrain ? terrain.height(x, y) : 0;

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
    const origin = scene.origin.slice(3 * frame, 3 * frame + 3);
    const [x, y, z, w] = poses.subarray(frame * scene.bodies * 7 + 3, frame * scene.bodies * 7 + 7);  // the chassis
    const heading = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)), c = Math.cos(heading), s = Math.sin(heading);
    const focus = [c * scene.focus[0] - s * scene.focus[1], s * scene.focus[0] + c * scene.focus[1], scene.focus[2]];
    const eye = [focus[0] + distance * Math.cos(elevation) * Math.cos(azimuth), focus[1] + distance * Math.cos(elevation) * Math.sin(azimuth),
      focus[2] + distance * Math.sin(elevation)];
    eye[2] = Math.max(eye[2], 0.1 + heightAt(origin[0] + eye[0], origin[1] + eye[1]) - origin[2]);
    const sun = unit([0.42, -0.55, 0.85]);
    const view = product(perspective(0.6, gl.drawingBufferWidth / gl.drawingBufferHeight, 0.05 * reach, 400), looking(eye, focus));
    const shade = product(orthographic(reach, 0.5 * reach, 3.5 * reach), looking(focus.map((x, i) => x + 2 * reach * sun[i]), focus));
    const use = pass => {
      gl.useProgram(pass.made);
      gl.uniformMatrix4fv(pass.at.view, false, view);
      gl.uniformMatrix4fv(pass.at.shade_view, false, shade);
      for (const [name, value] of Object.entries({ eye, sun, focus, origin })) gl.uniform3fv(pass.at[name], value);
      gl.uniform4fv(pass.at.footprint, [...scene.footprint, c, s]);
      gl.uniform1f(pass.at.reach, reach);
      gl.uniform1f(pass.at.level, heightAt(origin[0] + focus[0], origin[1] + focus[1]));
      gl.uniform1i(pass.at.shadow, 0);
    };
    const bodies = () => {
      for (const batch of batches) {
        gl.bindVertexArray(batch.vao);
        gl.drawElementsInstanced(gl.TRIANGLES, batch.count, gl.UNSIGNED_INT, batch.first, batch.mine.length);
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
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    use(bodyPass); bodies();
    gl.disable(gl.CULL_FACE);
    gl.bindVertexArray(terrainArray);
    use(groundPass);
    if (terrain) gl.drawElements(gl.TRIANGLES, terrain.indices.length, gl.UNSIGNED_INT, 0);
    else gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.bindVertexArray(null);
    gl.depthFunc(gl.LEQUAL);
    use(skyPass);
    gl.uniformMatrix4fv(skyPass.at.from_clip, false, inverse(view));
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 3);
    gl.depthFunc(gl.LESS);
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
// By elimination without pivoting choice beyond the largest: views and perspectives are far from singular.
const inverse = m => {
  const rows = [0, 1, 2, 3].map(r => [m[r], m[4 + r], m[8 + r], m[12 + r], ...[0, 1, 2, 3].map(c => +(c === r))]);
  for (let k = 0; k < 4; ++k) {
    const best = rows.reduce((a, row, r) => r >= k && (a < 0 || Math.abs(row[k]) > Math.abs(rows[a][k])) ? r : a, -1);
    [rows[k], rows[best]] = [rows[best], rows[k]];
    rows[k] = rows[k].map(v => v / rows[k][k]);
    rows.forEach((row, r) => { if (r !== k) { const f = row[k]; rows[r] = row.map((v, c) => v - f * rows[k][c]); } });
  }
  return Float32Array.from({ length: 16 }, (_, i) => rows[i % 4][4 + (i >> 2)]);
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
