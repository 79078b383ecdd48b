// What a report draws of a run: bodies as tubes, as finite-element surfaces and by their shapes.
// Displacements and stresses of surfaces are superposed from modes here: u = sum of shape times amplitude.

class Scene {
  constructor(canvas, scene) {
    this.scene = scene; this.frame = 0;
    this.canvas = canvas; this.raster = new Raster(canvas);
    this.surfaces = scene.surfaces.map(one => this.prepareSurface(one));
    this.contoured = this.surfaces.filter(one => one.modes);
    this.lines = scene.bodies.map(one => ({...one, marks: floats(one.marks), edges: integers(one.edges), palette: palette([rgb(one.colour)])}));
    this.traces = scene.traces.map(one => this.prepareTrace(one));
    this.joints = {marks: floats(scene.joints.marks), names: scene.joints.names, palette: palette([rgb(scene.joints.colour)])};
    // What the numbers in the raster stand for, from 1.
    this.names = [...this.lines, ...this.surfaces].map(one => one.name).concat(this.joints.names);
    this.contours = palette(Array.from({length: STEPS}, (_, k) => viridis(CONTOURS_BEGIN + (1 - CONTOURS_BEGIN) * k / (STEPS - 1))));
    this.turn = {eye: unit(scene.view.eye), up: unit(scene.view.up)};
    this.zoom = 1; this.shift = [0, 0];
    this.ranges = scene.ranges;  // those of all report rows, so that colours mean the same throughout
    this.chosen = {};  // those that are wanted in their place
    const {colours, ends, scale} = scene.look;
    this.magnify = scale; this.colouring = colours;
    if (ends && this.ranges[colours]) this.chosen[colours] = ends;
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
    this.drawSigns(camera);
    for (const trace of this.part("traces").checked ? this.traces : []) {
      this.project(camera, trace.marks, trace.screen);
      raster.lines(trace.screen, trace.index, trace.packed, 0, Math.max(1, Math.round(1.5 * this.shown)));
    }
  }

  // The symbol of the ground at joints that rest, and its axes in the lower right corner.
  drawSigns(camera) {
    const {raster, frame, joints, scene, shown} = this, grey = palette([rgb(scene.ground.colour)]);
    for (const k of scene.ground.joints) {
      const [x, y, z] = this.placed(camera, joints.marks, joints.names.length * frame + k), r = camera.radius;
      for (const [a, b, c, d] of scene.ground.lines) raster.tube([x + a * r, y + b * r, z - 2 * r], [x + c * r, y + d * r, z - 2 * r], 0.3 * r, grey, 0);
    }
    const {eye, up: wanted} = this.turn, right = unit(cross(wanted, eye)), up = cross(eye, right), o = [raster.width - CORNER * shown, raster.height - CORNER * shown, 1e6];
    this.texts = [..."xyz"].map((text, k) => {
      const end = [o[0] + AXIS * shown * right[k], o[1] - AXIS * shown * up[k], o[2] + AXIS * shown * eye[k]];
      raster.tube(o, end, 1.8 * shown, grey, 0);
      return {text, colour: scene.ground.colour, x: o[0] + 1.35 * (end[0] - o[0]), y: o[1] + 1.35 * (end[1] - o[1])};
    });
  }

  // Names of bodies and joints in the picture.
  drawNames(camera, ink) {
    const {lines, surfaces, joints, frame, texts} = this, named = (text, [x, y]) => texts.push({text, colour: ink, x, y: y - 12 * this.shown});
    for (const body of lines) {
      const first = body.still ? 0 : body.places * frame, ends = [...body.edges].slice(0, 2).map(k => this.placed(camera, body.marks, first + k));
      if (ends.length) named(body.name, [0, 1].map(i => (ends[0][i] + ends[1][i]) / 2));
    }
    for (const {name, screen, count} of surfaces) named(name, [0, 1].map(i => { let sum = 0; for (let n = 0; n < count; n++) sum += screen[3 * n + i]; return sum / count; }));
    joints.names.forEach((name, k) => named(name, this.placed(camera, joints.marks, joints.names.length * frame + k)));
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
}
