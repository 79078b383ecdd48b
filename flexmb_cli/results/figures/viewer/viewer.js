"use strict";
// The report's viewer: bodies as tubes and finite-element surfaces, by WebGL 2 alone.
// Positions of surfaces are superposed from modes here: u = sum of shape times amplitude.

const TUBE = `#version 300 es
in vec3 corner; in vec3 start; in vec3 end; in vec4 paint;
uniform mat4 camera; uniform float radius; out vec3 place; out vec4 colour;
void main() {
  vec3 along = end - start;
  vec3 axis = length(along) > 0.0 ? normalize(along) : vec3(0.0, 0.0, 1.0);
  vec3 side = normalize(cross(axis, abs(axis.x) < 0.9 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
  place = start + along * corner.z + radius * paint.a * (corner.x * side + corner.y * cross(axis, side));
  colour = vec4(paint.rgb, 1.0);
  gl_Position = camera * vec4(place, 1.0);
}`;
const SURFACE = `#version 300 es
in vec3 node; in float value; uniform mat4 camera; uniform vec4 plain; uniform vec2 range;
out vec3 place; out vec4 colour;
// Viridis (van der Walt and Smith, 2015) as a polynomial.
vec3 viridis(float t) {
  vec3 c = vec3(-5.4354, 4.6459, 26.3124);
  c = c * t + vec3(4.7763, -13.7452, -65.3530);
  c = c * t + vec3(6.2284, 14.1800, 56.6906);
  c = c * t + vec3(-4.6342, -5.7991, -19.3324);
  c = c * t + vec3(-0.3309, 0.2148, 0.0951);
  c = c * t + vec3(0.1051, 1.4046, 1.3846);
  return clamp(c * t + vec3(0.2777, 0.0054, 0.3341), 0.0, 1.0);
}
void main() {
  place = node;
  colour = plain.a > 0.0 ? vec4(plain.rgb, 1.0) : vec4(viridis(clamp((value - range.x) / range.y, 0.0, 1.0)), 1.0);
  gl_Position = camera * vec4(node, 1.0);
}`;
const SHADED = `#version 300 es
precision highp float; in vec3 place; in vec4 colour; uniform vec3 eye; uniform float lit; out vec4 seen;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = lit > 0.0 ? 0.55 + 0.45 * abs(dot(normal, normalize(eye))) : 1.0;
  seen = vec4(colour.rgb * light, 1.0);
}`;
const SIDES = 10;

function floats(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}
function integers(text) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Uint32Array(bytes.buffer);
}
function rgb(text) { return [1, 3, 5].map(k => parseInt(text.slice(k, k + 2), 16) / 255); }
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const unit = a => scaled(a, 1 / (Math.hypot(...a) || 1));

class Viewer {
  constructor(box, scene) {
    this.box = box; this.scene = scene; this.frame = 0; this.playing = false;
    this.canvas = box.querySelector("canvas");
    const gl = this.gl = this.canvas.getContext("webgl2", {antialias: true, preserveDrawingBuffer: true});
    if (!gl) throw new Error("this browser has no WebGL 2");
    this.tubes = this.program(TUBE, SHADED, ["corner", "start", "end", "paint"]);
    this.surface = this.program(SURFACE, SHADED, ["node", "value"]);
    this.prepareTube();
    this.surfaces = scene.surfaces.map(one => this.prepareSurface(one));
    this.lines = scene.bodies.map(one => ({...one, marks: floats(one.marks), edges: integers(one.edges)}));
    this.traces = scene.traces.map(one => ({...one, marks: floats(one.marks)}));
    this.joints = {marks: floats(scene.joints.marks), names: scene.joints.names};
    this.turn = {eye: unit(scene.view.eye), up: unit(scene.view.up)};
    this.zoom = 1; this.shift = [0, 0]; this.magnify = 1; this.colouring = this.surfaces.length ? "von Mises stress" : "body";
    this.prepareRanges();
    this.controls();
    this.show(0);
  }

  program(vertex, fragment, names) {
    const gl = this.gl, made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    names.forEach((name, k) => gl.bindAttribLocation(made, k, name));
    gl.linkProgram(made);
    return {made, at: name => gl.getUniformLocation(made, name)};
  }

  prepareTube() {
    const gl = this.gl, corners = [];
    for (let k = 0; k < SIDES; k++) {
      const [a, b] = [2 * Math.PI * k / SIDES, 2 * Math.PI * (k + 1) / SIDES];
      const [p, q] = [[Math.cos(a), Math.sin(a)], [Math.cos(b), Math.sin(b)]];
      corners.push(...p, 0, ...q, 0, ...q, 1, ...p, 0, ...q, 1, ...p, 1);
      corners.push(0, 0, 0, ...q, 0, ...p, 0, 0, 0, 1, ...p, 1, ...q, 1);
    }
    this.tubeCount = corners.length / 3;
    this.tubeArray = gl.createVertexArray(); this.tubeBuffer = gl.createBuffer();
    gl.bindVertexArray(this.tubeArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0); gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.tubeBuffer);
    [[1, 3, 0], [2, 3, 12], [3, 4, 24]].forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place); gl.vertexAttribPointer(place, size, gl.FLOAT, false, 40, offset);
      gl.vertexAttribDivisor(place, 1);
    });
  }

  prepareSurface(one) {
    const gl = this.gl, arrays = {};
    for (const key of ["nodes", "shape", "stress", "amplitude", "origin", "turn"]) arrays[key] = floats(one[key]);
    const made = {...one, ...arrays, triangles: integers(one.triangles), count: arrays.nodes.length / 3};
    made.places = new Float32Array(3 * made.count); made.values = new Float32Array(made.count);
    made.array = gl.createVertexArray(); made.placeBuffer = gl.createBuffer(); made.valueBuffer = gl.createBuffer();
    gl.bindVertexArray(made.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, made.placeBuffer); gl.enableVertexAttribArray(0); gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, made.valueBuffer); gl.enableVertexAttribArray(1); gl.vertexAttribPointer(1, 1, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, made.triangles, gl.STATIC_DRAW);
    return made;
  }

  // Largest values over all frames, so that colours mean the same throughout.
  prepareRanges() {
    this.ranges = {"von Mises stress": [0, 0, "Pa"], "deformation": [0, 0, "m"]};
    const every = Math.max(1, Math.floor(this.scene.time.length / 60));
    for (const name of Object.keys(this.ranges)) for (const one of this.surfaces)
      for (let k = 0; k < this.scene.time.length; k += every) {
        this.fill(one, k, name);
        for (const value of one.values) this.ranges[name][1] = Math.max(this.ranges[name][1], value);
      }
  }

  fill(one, frame, colouring) {
    const N = one.modes, u = one.displaced || (one.displaced = new Float32Array(3 * one.count));
    const eta = one.amplitude.subarray(frame * N, (frame + 1) * N);
    for (let r = 0, at = 0; r < 3 * one.count; r++) {
      let sum = 0;
      for (let k = 0; k < N; k++) sum += one.shape[at++] * eta[k];
      u[r] = sum;
    }
    const A = one.turn.subarray(9 * frame, 9 * frame + 9), o = one.origin.subarray(3 * frame, 3 * frame + 3);
    for (let n = 0; n < one.count; n++) {
      const x = one.nodes[3 * n] + this.magnify * u[3 * n], y = one.nodes[3 * n + 1] + this.magnify * u[3 * n + 1];
      const z = one.nodes[3 * n + 2] + this.magnify * u[3 * n + 2];
      for (let i = 0; i < 3; i++) one.places[3 * n + i] = o[i] + A[3 * i] * x + A[3 * i + 1] * y + A[3 * i + 2] * z;
    }
    if (colouring === "deformation")
      for (let n = 0; n < one.count; n++) one.values[n] = Math.hypot(u[3 * n], u[3 * n + 1], u[3 * n + 2]);
    if (colouring === "von Mises stress")
      for (let n = 0, at = 0, s = [0, 0, 0, 0, 0, 0]; n < one.count; n++) {
        for (let c = 0; c < 6; c++) { let sum = 0; for (let k = 0; k < N; k++) sum += one.stress[at++] * eta[k]; s[c] = sum; }
        const direct = (s[0] - s[1]) ** 2 + (s[1] - s[2]) ** 2 + (s[2] - s[0]) ** 2;
        one.values[n] = Math.sqrt(direct / 2 + 3 * (s[3] ** 2 + s[4] ** 2 + s[5] ** 2));
      }
  }

  camera() {
    const {low, high} = this.scene.box, size = Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) || 1;
    const back = this.turn.eye, right = unit(cross(this.turn.up, back)), up = cross(back, right);
    let wide = 0, tall = 0;
    const middle = low.map((x, k) => (x + high[k]) / 2);
    for (let k = 0; k < 8; k++) {
      const c = [0, 1, 2].map(i => ((k >> i) & 1 ? high[i] : low[i]) - middle[i]);
      wide = Math.max(wide, Math.abs(dot(c, right))); tall = Math.max(tall, Math.abs(dot(c, up)));
    }
    const aspect = this.canvas.width / this.canvas.height;
    const half = 1.12 * Math.max(tall, wide / aspect, 0.02 * size) / this.zoom;
    this.scale = {half, aspect, right, up, middle};
    const rows = [scaled(right, 1 / (half * aspect)), scaled(up, 1 / half), scaled(back, -1 / (2 * size))], m = [];
    for (let c = 0; c < 3; c++) m.push(rows[0][c], rows[1][c], rows[2][c], 0);
    m.push(-dot(rows[0], middle) + this.shift[0], -dot(rows[1], middle) + this.shift[1], -dot(rows[2], middle), 1);
    return new Float32Array(m);
  }

  show(frame) {
    this.frame = frame;
    const gl = this.gl, ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(this.canvas.clientWidth * ratio), Math.round(this.canvas.clientHeight * ratio)];
    if (this.canvas.width !== w || this.canvas.height !== h) { this.canvas.width = w; this.canvas.height = h; }
    const camera = this.camera();
    gl.viewport(0, 0, w, h); gl.enable(gl.DEPTH_TEST);
    const ground = rgb(getComputedStyle(document.documentElement).getPropertyValue("--canvas").trim());
    gl.clearColor(...ground, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawTubes(camera); this.drawSurfaces(camera);
    this.tell();
  }

  drawTubes(camera) {
    const gl = this.gl, data = [];
    for (const body of this.lines) {
      const n = body.places, first = body.still ? 0 : 3 * n * this.frame, colour = rgb(body.colour);
      const at = k => [body.marks[first + 3 * k], body.marks[first + 3 * k + 1], body.marks[first + 3 * k + 2]];
      for (let e = 0; e < body.edges.length; e += 2) data.push(...at(body.edges[e]), ...at(body.edges[e + 1]), ...colour, body.still ? 0.6 : 1);
    }
    for (const trace of this.traces) {
      const colour = rgb(trace.colour), m = trace.marks;
      for (let k = 0; k + 5 < m.length; k += 3) data.push(m[k], m[k + 1], m[k + 2], m[k + 3], m[k + 4], m[k + 5], ...colour, 0.3);
    }
    const j = this.joints, count = j.names.length, axis = scaled(this.turn.eye, 1.6 * this.radius());
    for (let k = 0; k < count; k++) {
      const at = 3 * (count * this.frame + k), p = [j.marks[at], j.marks[at + 1], j.marks[at + 2]];
      data.push(p[0] - axis[0], p[1] - axis[1], p[2] - axis[2], p[0] + axis[0], p[1] + axis[1], p[2] + axis[2], 0.35, 0.35, 0.35, 1.5);
    }
    gl.useProgram(this.tubes.made); gl.bindVertexArray(this.tubeArray);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.tubeBuffer); gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(data), gl.DYNAMIC_DRAW);
    gl.uniformMatrix4fv(this.tubes.at("camera"), false, camera); gl.uniform1f(this.tubes.at("radius"), this.radius());
    gl.uniform3fv(this.tubes.at("eye"), this.turn.eye); gl.uniform1f(this.tubes.at("lit"), 1);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, this.tubeCount, data.length / 10);
  }

  radius() {
    const {low, high} = this.scene.box;
    return 0.008 * Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  }

  drawSurfaces(camera) {
    const gl = this.gl, range = this.ranges[this.colouring];
    gl.useProgram(this.surface.made);
    gl.uniformMatrix4fv(this.surface.at("camera"), false, camera);
    gl.uniform3fv(this.surface.at("eye"), this.turn.eye); gl.uniform1f(this.surface.at("lit"), 1);
    if (range) gl.uniform2f(this.surface.at("range"), range[0], (range[1] - range[0]) || 1);
    for (const one of this.surfaces) {
      this.fill(one, this.frame, this.colouring);
      gl.uniform4f(this.surface.at("plain"), ...rgb(one.colour), range ? 0 : 1);
      gl.bindVertexArray(one.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, one.placeBuffer); gl.bufferData(gl.ARRAY_BUFFER, one.places, gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, one.valueBuffer); gl.bufferData(gl.ARRAY_BUFFER, one.values, gl.DYNAMIC_DRAW);
      gl.drawElements(gl.TRIANGLES, one.triangles.length, gl.UNSIGNED_INT, 0);
    }
  }

  tell() {
    this.part("time").textContent = `t = ${this.scene.labels[this.frame]} s`;
    this.part("slider").value = this.frame;
    const range = this.ranges[this.colouring], legend = this.part("legend");
    legend.hidden = !range || !this.surfaces.length;
    if (range) this.part("legend-text").textContent = `${this.colouring}: 0 to ${range[1].toPrecision(3)} ${range[2]}`;
  }

  part(name) { return this.box.querySelector(`[data-part="${name}"]`); }

  controls() {
    const slider = this.part("slider"), last = this.scene.time.length - 1;
    slider.max = last;
    slider.addEventListener("input", () => { this.pause(); this.show(Number(slider.value)); });
    this.part("play").addEventListener("click", () => this.playing ? this.pause() : this.play());
    this.part("back").addEventListener("click", () => { this.pause(); this.show(Math.max(0, this.frame - 1)); });
    this.part("forward").addEventListener("click", () => { this.pause(); this.show(Math.min(last, this.frame + 1)); });
    this.part("view").addEventListener("change", event => this.look(event.target.value));
    this.part("colour").addEventListener("change", event => { this.colouring = event.target.value; this.show(this.frame); });
    this.part("scale").addEventListener("change", event => { this.magnify = Number(event.target.value) || 0; this.show(this.frame); });
    for (const name of ["colour", "scale"]) this.part(name).parentElement.hidden = !this.surfaces.length;
    this.part("shade").addEventListener("click", () => {
      const root = document.documentElement, dark = root.dataset.shade ? root.dataset.shade === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
      root.dataset.shade = dark ? "light" : "dark"; this.show(this.frame);
    });
    new ResizeObserver(() => this.show(this.frame)).observe(this.canvas);
    this.mouse();
  }

  mouse() {
    const held = new Map(); let apart = 0;
    this.canvas.addEventListener("pointerdown", event => { held.set(event.pointerId, event); this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener("pointerup", event => { held.delete(event.pointerId); apart = 0; });
    this.canvas.addEventListener("pointermove", event => {
      const before = held.get(event.pointerId);
      if (!before) return this.name(event);
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      held.set(event.pointerId, event);
      if (held.size === 2) {
        const [a, b] = [...held.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (apart) this.zoom *= now / apart;
        apart = now;
      } else if (event.shiftKey || event.buttons === 2) {
        this.shift[0] += 2 * dx / this.canvas.clientWidth; this.shift[1] -= 2 * dy / this.canvas.clientHeight;
      } else this.drag(dx, dy);
      this.show(this.frame);
    });
    this.canvas.addEventListener("wheel", event => { event.preventDefault(); this.zoom *= Math.exp(-event.deltaY / 600); this.show(this.frame); }, {passive: false});
    this.canvas.addEventListener("contextmenu", event => event.preventDefault());
  }

  drag(dx, dy) {
    const {eye, up} = this.turn, right = unit(cross(up, eye)), a = -dx / 150, b = dy / 150;
    const turned = (v, k, t) => v.map((x, i) => x * Math.cos(t) + cross(k, v)[i] * Math.sin(t) + k[i] * dot(k, v) * (1 - Math.cos(t)));
    const across = turned(right, up, a);
    this.turn = {eye: unit(turned(turned(eye, up, a), across, -b)), up: unit(turned(up, across, -b))};
  }

  look(name) {
    const sides = {x: [[1, 0, 0], [0, 0, 1]], y: [[0, -1, 0], [0, 0, 1]], z: [[0, 0, 1], [0, 1, 0]]};
    const [eye, up] = sides[name] || [this.scene.view.eye, this.scene.view.up];
    this.turn = {eye: unit(eye), up: unit(up)}; this.zoom = 1; this.shift = [0, 0];
    this.show(this.frame);
  }

  // The name of what lies nearest under the pointer.
  name(event) {
    const bounds = this.canvas.getBoundingClientRect(), m = this.camera(), label = this.part("name");
    const x = 2 * (event.clientX - bounds.left) / bounds.width - 1, y = 1 - 2 * (event.clientY - bounds.top) / bounds.height;
    let best = "", least = 0.05;
    const near = (p, name) => {
      const u = m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12], v = m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13];
      const gap = Math.hypot((u - x) * this.scale.aspect, v - y);
      if (gap < least) { least = gap; best = name; }
    };
    this.joints.names.forEach((name, k) => near(this.joints.marks.subarray(3 * (this.joints.names.length * this.frame + k)), name));
    for (const body of this.lines) {
      const first = body.still ? 0 : 3 * body.places * this.frame;
      for (let e = 0; e < body.edges.length; e += 2) for (let t = 0; t <= 1; t += 0.125)
        near([0, 1, 2].map(i => (1 - t) * body.marks[first + 3 * body.edges[e] + i] + t * body.marks[first + 3 * body.edges[e + 1] + i]), body.name);
    }
    for (const one of this.surfaces) for (let n = 0; n < one.count; n++) near(one.places.subarray(3 * n, 3 * n + 3), `${one.name} node ${one.numbers[n]}`);
    label.textContent = best;
    label.style.left = `${event.clientX - bounds.left + 12}px`; label.style.top = `${event.clientY - bounds.top + 12}px`;
  }

  play() {
    this.playing = true; this.part("play").textContent = "pause";
    const time = this.scene.time, last = time.length - 1;
    if (this.frame === last) this.frame = 0;
    let begun = performance.now(), from = this.frame;
    const step = now => {
      if (!this.playing) return;
      const span = (time[last] - time[0]) || 1, speed = this.scene.seconds / Number(this.part("speed").value);
      const t = time[from] + (now - begun) / 1000 * span / speed;
      let frame = this.frame;
      while (frame < last && time[frame + 1] <= t) frame++;
      if (frame !== this.frame) this.show(frame);
      if (frame === last) {
        if (!this.part("loop").checked) return this.pause();
        begun = now; from = 0; this.show(0);
      }
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() { this.playing = false; this.part("play").textContent = "play"; }
}

window.flexmb = {ready: false, frames: 0};
const given = JSON.parse(document.getElementById("figures").textContent);
if (given.scene) {
  window.flexmb.viewer = new Viewer(document.getElementById("motion"), given.scene);
  window.flexmb.frames = given.scene.time.length;
}
window.flexmb.ready = true;
