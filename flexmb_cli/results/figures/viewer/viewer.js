// The report's viewer: bodies as tubes, as finite-element surfaces and by their shapes.
// Displacements and stresses of surfaces are superposed from modes here: u = sum of shape times amplitude.

const DEFORMATION = "deformation", ENERGY = "strain energy of the element", COMPONENTS = ["xx", "yy", "zz", "xy", "yz", "zx"];
const RATIOS = [0.5, 0.7, 1, 1.4, 2], SLOW = 13, QUICK = 5, MOST_PIXELS = 4e6;

function bytes(text) { return Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer; }
function floats(text) { return new Float32Array(bytes(text)); }
function integers(text) { return new Uint32Array(bytes(text)); }
function rgb(text) { return [1, 3, 5].map(k => parseInt(text.slice(k, k + 2), 16) / 255); }
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
// The digits of a value of a unit that tell it.
const told = (value, unit) => `${value ? value.toPrecision(3) : 0} ${unit}`.trim();
// A number in at most four digits, as a field has room for it: 1.02e8.
function brief(value) {
  const short = Number(value.toPrecision(4)), size = Math.abs(short);
  return size && (size >= 1e5 || size < 1e-3) ? short.toExponential().replace("e+", "e") : String(short);
}
const unit = a => scaled(a, 1 / (Math.hypot(...a) || 1));

const NONE = 0xffffffff;  // of the elements that are not reported

function vonMises(xx, yy, zz, xy, yz, zx) {
  const direct = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2;
  return Math.sqrt(direct / 2 + 3 * (xy * xy + yz * yz + zx * zx));
}

// The principal value number k, 1 the largest, of a tensor, by the invariants of its deviator.
function principal(k, xx, yy, zz, xy, yz, zx) {
  const mean = (xx + yy + zz) / 3, x = xx - mean, y = yy - mean, z = zz - mean;
  const radius = vonMises(xx, yy, zz, xy, yz, zx) / 1.5, third = x * y * z + 2 * xy * yz * zx - x * yz * yz - y * zx * zx - z * xy * xy;
  const angle = Math.acos(Math.min(1, Math.max(-1, radius ? 4 * third / radius ** 3 : 1))) / 3;
  return mean + radius * Math.cos(angle + [0, 0, 4, 2][k] * Math.PI / 3);
}

// The function of a stress that a colouring shows, null where it shows none; material: E and nu, or null.
// Strains follow by Hooke's law, xy yz zx are halves of angles.
function measured(colouring, material) {
  if (colouring === "von Mises stress") return vonMises;
  const words = colouring.split(" "), which = words.pop(), quantity = words.pop();
  if (quantity !== "stress" && (quantity !== "strain" || !material)) return null;
  const c = COMPONENTS.indexOf(which), k = Number(which);
  const value = words[0] === "principal" ? (xx, yy, zz, xy, yz, zx) => principal(k, xx, yy, zz, xy, yz, zx)
    : (xx, yy, zz, xy, yz, zx) => c === 0 ? xx : c === 1 ? yy : c === 2 ? zz : c === 3 ? xy : c === 4 ? yz : zx;
  if (quantity === "stress") return value;
  const [young, poisson] = material, trace = c < 3 ? poisson / young : 0;
  return (xx, yy, zz, xy, yz, zx) => (1 + poisson) / young * value(xx, yy, zz, xy, yz, zx) - trace * (xx + yy + zz);
}

class Viewer {
  constructor(box, scene) {
    this.box = box; this.scene = scene; this.frame = 0; this.playing = false;
    this.canvas = box.querySelector("canvas"); this.raster = new Raster(this.canvas);
    this.surfaces = scene.surfaces.map(one => this.prepareSurface(one));
    this.contoured = this.surfaces.filter(one => one.modes);
    this.lines = scene.bodies.map(one => ({...one, marks: floats(one.marks), edges: integers(one.edges), palette: palette([rgb(one.colour)])}));
    this.traces = scene.traces.map(one => this.prepareTrace(one));
    this.joints = {marks: floats(scene.joints.marks), names: scene.joints.names, palette: palette([[0.42, 0.42, 0.42]])};
    // What the numbers in the raster stand for, from 1.
    this.names = [...this.lines, ...this.surfaces].map(one => one.name).concat(this.joints.names);
    this.contours = palette(Array.from({length: STEPS}, (_, k) => viridis(CONTOURS_BEGIN + (1 - CONTOURS_BEGIN) * k / (STEPS - 1))));
    this.turn = {eye: unit(scene.view.eye), up: unit(scene.view.up)};
    this.zoom = 1; this.shift = [0, 0];
    this.ratio = 2; this.cost = 8;
    this.ranges = scene.ranges;  // those of all report rows, so that colours mean the same throughout
    this.chosen = {};  // those that are wanted in their place
    const {colours, ends, scale} = scene.look;
    this.magnify = scale; this.colouring = colours;
    if (ends && this.ranges[colours]) this.chosen[colours] = ends;
    this.controls();
    // Where the first frame has no stress the page opens, and prints, at the one that has most; motion begins at the first.
    this.opened = scene.rest > 0;
    this.show(scene.rest);
  }

  prepareSurface(one) {
    const made = {...one, triangles: integers(one.triangles), edges: integers(one.edges), palette: palette([rgb(one.colour)])};
    for (const key of ["nodes", "shape", "stress", "amplitude", "origin", "turn"]) made[key] = floats(one[key]);
    made.count = made.nodes.length / 3;
    made.displaced = new Float32Array(3 * made.count); made.screen = new Float32Array(3 * made.count);
    made.values = new Float32Array(made.count);
    if (one.elements.length) this.prepareEnergies(made);
    return made;
  }

  // Triangles of elements whose energy is known, and the others.
  prepareEnergies(one) {
    const shown = integers(one.shown), parts = [[], []], columns = [];
    shown.forEach((column, t) => {
      parts[column === NONE ? 1 : 0].push(...one.triangles.subarray(3 * t, 3 * t + 3));
      if (column !== NONE) columns.push(column);
    });
    one.energy = new Uint16Array(bytes(one.energy)); one.columns = columns;
    one.known = new Uint32Array(parts[0]); one.unknown = new Uint32Array(parts[1]);
    one.flat = new Float32Array(columns.length);
  }

  prepareTrace(one) {
    const marks = floats(one.marks), count = marks.length / 3, index = new Uint32Array(2 * Math.max(0, count - 1));
    for (let k = 0; k < count - 1; k++) { index[2 * k] = k; index[2 * k + 1] = k + 1; }
    return {...one, marks, index, screen: new Float32Array(marks.length), packed: packed(rgb(one.colour))};
  }

  // Displacements of a frame, body axes, and the values that are coloured.
  fill(one, frame, colouring) {
    const N = one.modes, u = one.displaced, {shape, stress, values, count} = one;
    if (!N) return;
    const eta = one.amplitude.subarray(frame * N, (frame + 1) * N);
    for (let r = 0, at = 0; r < 3 * count; r++) {
      let sum = 0;
      for (let k = 0; k < N; k++) sum += shape[at++] * eta[k];
      u[r] = sum;
    }
    if (colouring === DEFORMATION)
      for (let n = 0; n < count; n++) values[n] = Math.hypot(u[3 * n], u[3 * n + 1], u[3 * n + 2]);
    const measure = measured(colouring, one.material);
    if (measure && stress.length)
      for (let n = 0, at = 0; n < count; n++) {
        let xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
        for (let k = 0; k < N; k++, at++) {
          const part = eta[k];
          xx += stress[at] * part; yy += stress[at + N] * part; zz += stress[at + 2 * N] * part;
          xy += stress[at + 3 * N] * part; yz += stress[at + 4 * N] * part; zx += stress[at + 5 * N] * part;
        }
        at += 5 * N;
        values[n] = measure(xx, yy, zz, xy, yz, zx);
      }
  }

  // Axes of the picture and pixels a metre.
  camera() {
    const {low, high} = this.scene.box, {eye, up: wanted} = this.turn, right = unit(cross(wanted, eye)), up = cross(eye, right);
    const size = Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]) || 1, middle = low.map((x, k) => (x + high[k]) / 2);
    let wide = 0, tall = 0;
    for (let k = 0; k < 8; k++) {
      const c = [0, 1, 2].map(i => ((k >> i) & 1 ? high[i] : low[i]) - middle[i]);
      wide = Math.max(wide, Math.abs(dot(c, right))); tall = Math.max(tall, Math.abs(dot(c, up)));
    }
    const {width, height} = this.raster, half = 1.12 * Math.max(tall, wide * height / width, 0.02 * size) / this.zoom;
    const scale = height / 2 / half, x = (1 + this.shift[0]) * width / 2, y = (1 - this.shift[1]) * height / 2;
    const rows = [scaled(right, scale), scaled(up, -scale), scaled(eye, scale)];
    const offset = [x - dot(rows[0], middle), y - dot(rows[1], middle), -dot(rows[2], middle)];
    return {rows, offset, radius: 0.008 * size * scale};
  }

  // The place in the picture of a mark.
  placed(camera, marks, k) {
    const p = [marks[3 * k], marks[3 * k + 1], marks[3 * k + 2]];
    return [0, 1, 2].map(i => dot(camera.rows[i], p) + camera.offset[i]);
  }

  show(frame) {
    this.frame = frame;
    const begun = performance.now(), {clientWidth, clientHeight} = this.canvas;
    // At rest there is time for more pixels than are shown, which smooths the edges.
    const most = Math.sqrt(MOST_PIXELS / Math.max(1, clientWidth * clientHeight)), ratio = Math.min(most, this.playing ? this.ratio : 2);
    const ground = getComputedStyle(document.documentElement).getPropertyValue("--canvas").trim();
    this.raster.begin(Math.max(1, Math.round(clientWidth * ratio)), Math.max(1, Math.round(clientHeight * ratio)), rgb(ground));
    this.shown = ratio;
    const camera = this.camera();
    this.drawSurfaces(camera); this.drawTubes(camera);
    this.raster.end();
    this.tell();
    if (this.playing) this.adapt(performance.now() - begun);
  }

  // Fewer pixels where frames take long, more where there is time.
  adapt(spent) {
    this.cost += 0.2 * (spent - this.cost);
    const at = RATIOS.indexOf(this.ratio), next = this.cost > SLOW ? at - 1 : this.cost < QUICK ? at + 1 : at;
    if (next === at || next < 0 || next >= RATIOS.length || RATIOS[next] > Math.max(1, window.devicePixelRatio)) return;
    this.ratio = RATIOS[next]; this.cost = (SLOW + QUICK) / 2;
  }

  drawTubes(camera) {
    const {raster, frame} = this;
    this.lines.forEach((body, k) => {
      const first = body.still ? 0 : body.places * frame, radius = camera.radius * (body.still ? 0.6 : 1);
      for (let e = 0; e < body.edges.length; e += 2)
        raster.tube(this.placed(camera, body.marks, first + body.edges[e]), this.placed(camera, body.marks, first + body.edges[e + 1]), radius, body.palette, k + 1);
    });
    const {marks, names} = this.joints, before = this.lines.length + this.surfaces.length;
    names.forEach((_, k) => {
      const p = this.placed(camera, marks, names.length * frame + k);
      p[2] += camera.radius;
      raster.tube(p, p, 1.5 * camera.radius, this.joints.palette, before + k + 1);
    });
    for (const trace of this.part("traces").checked ? this.traces : []) {
      this.project(camera, trace.marks, trace.screen);
      raster.lines(trace.screen, trace.index, trace.packed, 0, Math.max(1, Math.round(1.5 * this.shown)));
    }
  }

  project(camera, marks, screen) {
    const [[a, b, c], [d, e, f], [g, h, i]] = camera.rows, [x0, y0, z0] = camera.offset;
    for (let k = 0; k < marks.length; k += 3) {
      const x = marks[k], y = marks[k + 1], z = marks[k + 2];
      screen[k] = a * x + b * y + c * z + x0; screen[k + 1] = d * x + e * y + f * z + y0; screen[k + 2] = g * x + h * y + i * z + z0;
    }
  }

  // Places in the picture of all nodes: rotation, scale and view in one matrix.
  carry(camera, one) {
    const A = one.turn.subarray(9 * this.frame, 9 * this.frame + 9), o = one.origin.subarray(3 * this.frame, 3 * this.frame + 3);
    const rows = camera.rows.map(row => [0, 1, 2].map(j => row[0] * A[j] + row[1] * A[3 + j] + row[2] * A[6 + j]));
    const offset = camera.rows.map((row, i) => dot(row, o) + camera.offset[i]);
    if (one.modes && this.magnify) {
      const {nodes, displaced, screen} = one, magnify = this.magnify;
      for (let k = 0; k < screen.length; k++) screen[k] = nodes[k] + magnify * displaced[k];
      this.project({rows, offset}, screen, screen);
    } else this.project({rows, offset}, one.nodes, one.screen);
  }

  drawSurfaces(camera) {
    this.surfaces.forEach((one, k) => {
      const range = this.rangeOf(one), owner = this.lines.length + k + 1;
      this.fill(one, this.frame, this.colouring);
      this.carry(camera, one);
      if (range && this.colouring === ENERGY) this.drawEnergies(one, owner, range);
      else {
        if (range) for (let n = 0, scale = range.high > range.low ? (STEPS - 1e-3) / (range.high - range.low) : 0; n < one.count; n++) one.values[n] = (one.values[n] - range.low) * scale;
        // Triangles of STL files may face either way; those of elements face outwards.
        this.raster.triangles(one.screen, one.triangles, range ? this.contours : one.palette, range ? one.values : null, one.modes > 0, owner);
      }
      if (one.edges.length && this.part("mesh").checked) this.raster.lines(one.screen, one.edges, 0, 1, 1);
    });
  }

  drawEnergies(one, owner, range) {
    const scale = range.high > range.low ? (STEPS - 1e-3) / (range.high - range.low) : 0;
    one.columns.forEach((column, t) => { one.flat[t] = (this.energyOf(one, column) - range.low) * scale; });
    this.raster.triangles(one.screen, one.known, this.contours, one.flat, true, owner, true);
    this.raster.triangles(one.screen, one.unknown, one.palette, null, true, owner);
  }

  // The energy of one of the reported elements, which is stored as its square root.
  energyOf(one, column) { return this.ranges[ENERGY].high * (one.energy[this.frame * one.elements.length + column] / 65535) ** 2; }

  // Smallest and largest value of what a surface is coloured by; nothing where it has none.
  rangeOf(one) {
    const stressed = this.colouring === DEFORMATION || one.stress.length > 0;
    const without = !one.modes || (this.colouring === ENERGY ? !one.elements.length : !stressed || (this.colouring.includes("strain") && !one.material));
    return without ? undefined : this.wanted();
  }

  // The range of the colours: that of all rows, or the one that is wanted in its place.
  wanted() {
    const range = this.ranges[this.colouring], [low, high] = this.chosen[this.colouring] || [];
    return range && low !== undefined ? {...range, low, high} : range;
  }

  tell() {
    this.part("time").textContent = `t = ${this.scene.labels[this.frame]} s`;
    this.part("slider").value = this.frame;
    const range = this.wanted(), whole = this.ranges[this.colouring], span = (ends, unit) => `${told(ends.low, "")} to ${told(ends.high, unit)}`;
    this.part("legend").hidden = range === undefined || !this.contoured.length;
    this.part("legend-text").textContent = range === undefined ? "" : `${this.colouring}, ${span(range, range.unit)}${this.chosen[this.colouring] ? ` (of ${span(whole, "")})` : ""}${this.magnify === 1 ? "" : `; deformation × ${this.magnify}`}`;
  }

  part(name) { return this.box.querySelector(`[data-part="${name}"]`); }

  controls() {
    const slider = this.part("slider"), last = this.scene.time.length - 1, again = () => this.show(this.frame);
    slider.max = last;
    for (const name of [...Object.keys(this.ranges), "body"]) this.part("colour").add(new Option(name));
    const stepped = (name, event, frame) => this.part(name).addEventListener(event, () => { this.opened = false; this.pause(); this.show(Math.min(last, Math.max(0, frame()))); });
    stepped("slider", "input", () => Number(slider.value));
    stepped("back", "click", () => this.frame - 1);
    stepped("forward", "click", () => this.frame + 1);
    this.part("play").addEventListener("click", () => { if (this.playing) { this.pause(); again(); } else this.play(); });
    this.part("view").addEventListener("change", event => this.look(event.target.value));
    this.part("colour").value = this.colouring; this.part("scale").value = this.magnify; this.part("scale").max = this.scene.look.largest;
    this.offerRange();
    this.part("colour").addEventListener("change", event => { this.colouring = event.target.value; this.offerRange(); again(); });
    this.part("scale").addEventListener("change", () => { this.scale(); again(); });
    for (const name of ["low", "high"]) this.part(name).addEventListener("change", () => { this.choose(); again(); });
    for (const name of ["mesh", "traces"]) this.part(name).addEventListener("change", again);
    for (const name of ["colour", "low", "scale", "mesh"]) this.part(name).parentElement.hidden = !this.contoured.length;
    this.part("traces").parentElement.hidden = !this.traces.length;
    this.part("shade").addEventListener("click", () => {
      const root = document.documentElement, dark = root.dataset.shade ? root.dataset.shade === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
      root.dataset.shade = dark ? "light" : "dark"; again();
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
    new ResizeObserver(again).observe(this.canvas);
    this.mouse();
  }

  // Deformations so many times as large; what is no such number is told, and the scale stays.
  scale() {
    const field = this.part("scale"), wanted = field.valueAsNumber, {largest} = this.scene.look;
    if (wanted >= 0 && wanted <= largest) this.magnify = wanted;
    this.warn(wanted === this.magnify ? "" : `The scale of the deformation is a number from 0 to ${largest}; it stays ${this.magnify}.`);
    field.value = this.magnify;
  }

  // The values of the first and the last colour, in fields that show those of all rows where they are empty.
  offerRange() {
    const whole = this.ranges[this.colouring], chosen = this.chosen[this.colouring] || ["", ""];
    ["low", "high"].forEach((name, k) => {
      const field = this.part(name);
      field.value = chosen[k] === "" ? "" : brief(chosen[k]); field.placeholder = whole ? told(whole[name], "") : "";
    });
    this.part("low").parentElement.hidden = !whole || !this.contoured.length;
    this.warn("");
  }

  choose() {
    const whole = this.ranges[this.colouring], fields = [this.part("low"), this.part("high")];
    const bad = fields.some(field => field.validity.badInput), empty = fields.every(field => field.value === "");
    // A field that still has its brief number keeps the whole one.
    const before = this.chosen[this.colouring], kept = (field, k) => before && field.value === brief(before[k]) ? before[k] : field.valueAsNumber;
    const [low, high] = fields.map((field, k) => field.value === "" ? [whole.low, whole.high][k] : kept(field, k));
    if (bad || (!empty && !(low < high))) {
      this.offerRange();
      return this.warn("The first number of the range must be smaller than the second; the range stays.");
    }
    if (empty) delete this.chosen[this.colouring]; else this.chosen[this.colouring] = [low, high];
    fields.forEach((field, k) => { if (field.value !== "") field.value = brief([low, high][k]); });
    this.warn("");
  }

  warn(words) { this.part("warning").textContent = words; }

  mouse() {
    const held = new Map(); let apart = 0;
    const released = event => { held.delete(event.pointerId); apart = 0; };
    this.canvas.addEventListener("pointerdown", event => { held.set(event.pointerId, event); this.canvas.setPointerCapture(event.pointerId); this.name(event); });
    this.canvas.addEventListener("pointerup", released); this.canvas.addEventListener("pointercancel", released);
    this.canvas.addEventListener("pointerleave", () => { this.part("name").textContent = ""; });
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

  // The name of what is drawn under the pointer; of a finite-element body its nearest node, too.
  name(event) {
    const bounds = this.canvas.getBoundingClientRect(), label = this.part("name"), {raster} = this;
    const x = (event.clientX - bounds.left) * raster.width / bounds.width, y = (event.clientY - bounds.top) * raster.height / bounds.height;
    const owner = raster.ownerAt(x, y, 4 * this.shown);
    label.textContent = owner ? this.names[owner - 1] + this.nodeAt(owner - 1 - this.lines.length, x, y) : "";
    label.style.left = `${Math.min(event.clientX - bounds.left + 12, bounds.width - label.offsetWidth - 4)}px`;
    label.style.top = `${event.clientY - bounds.top + 12}px`;
  }

  nodeAt(surface, x, y) {
    const one = this.surfaces[surface], element = one && this.elementAt(one, x, y);
    if (element) return element;
    let found = -1, least = Infinity, height = -Infinity;
    for (let n = 0; one && n < one.numbers.length; n++) {
      const gap = (one.screen[3 * n] - x) ** 2 + (one.screen[3 * n + 1] - y) ** 2, z = one.screen[3 * n + 2];
      if (gap < least - 1 || (gap < least + 1 && z > height)) { least = gap; height = z; found = n; }
    }
    return found < 0 ? "" : ` node ${one.numbers[found]}${this.valueAt(one, found)}`;
  }

  // Number and energy of the element that is seen at a place, where elements are coloured by energies.
  elementAt(one, x, y) {
    const range = this.colouring === ENERGY && this.rangeOf(one), {screen, known} = one;
    let found = -1, height = -Infinity;
    for (let t = 0; range && t < known.length; t += 3) {
      const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [0, 1, 2].map(k => screen.subarray(3 * known[t + k], 3 * known[t + k] + 3));
      const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      const v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area, w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
      const z = az + v * (bz - az) + w * (cz - az);
      if (area < 0 && v >= 0 && w >= 0 && v + w <= 1 && z > height) { height = z; found = one.columns[t / 3]; }
    }
    return found < 0 ? "" : ` element ${one.elements[found]}: ${told(this.energyOf(one, found), range.unit)}`;
  }

  // The value of what is coloured at a node.
  valueAt(one, n) {
    const range = this.rangeOf(one);
    if (!range || this.colouring === ENERGY) return "";
    return `: ${told(range.low + one.values[n] * (range.high - range.low) / (STEPS - 1e-3), range.unit)}`;
  }

  play() {
    this.playing = true; this.part("play").textContent = "pause";
    this.ratio = RATIOS.includes(this.ratio) && this.ratio <= 1 ? this.ratio : 1;
    const time = this.scene.time, last = time.length - 1;
    if (this.frame === last || this.opened) this.frame = 0;
    this.opened = false;
    let begun = performance.now(), from = this.frame;
    this.part("speed").onchange = () => { begun = performance.now(); from = this.frame; };
    const step = now => {
      if (!this.playing) return;
      const span = (time[last] - time[0]) || 1, speed = this.scene.seconds / Number(this.part("speed").value);
      const t = time[from] + (now - begun) / 1000 * span / speed;
      let frame = this.frame;
      while (frame < last && time[frame + 1] <= t) frame++;
      if (frame !== this.frame) this.show(frame);
      if (frame === last) {
        if (!this.part("loop").checked) { this.pause(); return this.show(last); }
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
