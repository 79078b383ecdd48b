// The report's viewer: a scene with its controls, the mouse and the motion.

const CORNER = 52, AXIS = 30;  // of the axes of the ground: distance from the corner and length, px
const RATIOS = [0.5, 0.7, 1, 1.4, 2], SLOW = 13, QUICK = 5, MOST_PIXELS = 4e6;

class Viewer extends Scene {
  constructor(box, scene) {
    super(box.querySelector("canvas"), scene);
    this.box = box; this.playing = false; this.ratio = 2; this.cost = 8;
    this.controls();
    // Where the first frame has no stress the page opens, and prints, at the one that has most; motion begins at the first.
    this.opened = scene.rest > 0;
    this.show(scene.rest);
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
    if (this.part("labels").checked) this.drawNames(camera, getComputedStyle(document.documentElement).getPropertyValue("--ink").trim());
    this.raster.end(this.texts, 13 * ratio);
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

  tell() {
    this.part("time").textContent = `t = ${this.scene.labels[this.frame]} s`;
    this.part("slider").value = this.frame;
    const range = this.wanted(), whole = this.ranges[this.colouring], span = (ends, unit) => `${told(ends.low * whole.factor, "")} to ${told(ends.high * whole.factor, unit)}`;
    this.part("legend").hidden = range === undefined || !this.contoured.length;
    this.part("legend-text").textContent = range === undefined ? "" : `${this.colouring}, ${span(range, whole.unit)}${this.chosen[this.colouring] ? ` (of ${span(whole, "")})` : ""}${this.magnify === 1 ? "" : `; deformation × ${this.magnify}`}`;
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
    for (const name of ["mesh", "traces", "labels"]) this.part(name).addEventListener("change", again);
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
      field.value = chosen[k] === "" ? "" : brief(chosen[k] * whole.factor); field.placeholder = whole ? told(whole[name] * whole.factor, "") : "";
    });
    this.part("low").parentElement.hidden = !whole || !this.contoured.length;
    this.warn("");
  }

  choose() {
    const whole = this.ranges[this.colouring], fields = [this.part("low"), this.part("high")];
    const bad = fields.some(field => field.validity.badInput), empty = fields.every(field => field.value === "");
    // A field that still has its brief number keeps the whole one.
    const before = this.chosen[this.colouring], kept = (field, k) => before && field.value === brief(before[k] * whole.factor) ? before[k] : field.valueAsNumber / whole.factor;
    const [low, high] = fields.map((field, k) => field.value === "" ? [whole.low, whole.high][k] : kept(field, k));
    if (bad || (!empty && !(low < high))) {
      this.offerRange();
      return this.warn("The first number of the range must be smaller than the second; the range stays.");
    }
    if (empty) delete this.chosen[this.colouring]; else this.chosen[this.colouring] = [low, high];
    fields.forEach((field, k) => { if (field.value !== "") field.value = brief([low, high][k] * whole.factor); });
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
    return found < 0 ? "" : ` element ${one.elements[found]}: ${told(this.energyOf(one, found) * this.ranges[ENERGY].factor, this.ranges[ENERGY].unit)}`;
  }

  // The value of what is coloured at a node.
  valueAt(one, n) {
    const range = this.rangeOf(one);
    if (!range || this.colouring === ENERGY) return "";
    return `: ${told((range.low + one.values[n] * (range.high - range.low) / (STEPS - 1e-3)) * this.ranges[this.colouring].factor, this.ranges[this.colouring].unit)}`;
  }

  play() {
    this.playing = true; this.part("play").textContent = "pause"; this.part("play").classList.add("playing");
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

  pause() { this.playing = false; this.part("play").textContent = "play"; this.part("play").classList.remove("playing"); }
}

window.flexmb = {ready: false, frames: 0};
const given = JSON.parse(document.getElementById("figures").textContent);
if (given.scene) {
  window.flexmb.viewer = new Viewer(document.getElementById("motion"), given.scene);
  window.flexmb.frames = given.scene.time.length;
}
window.flexmb.ready = true;
