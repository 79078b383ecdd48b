"use strict";
// Triangles, tubes and lines with a depth buffer, drawn into the pixels of a canvas by plain arrays: no graphics
// card and no WebGL are needed, and the picture is the same in every browser.
// Places are in pixels from the upper left corner; depth grows towards the viewer.

const LEVELS = 32, STEPS = 256, DARKEST = 0.5, NOTHING = -1e30;

class Raster {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", {alpha: false, willReadFrequently: true});
    this.width = this.height = 0;
  }

  // Begin a picture of so many pixels; nothing is allocated while the size stays.
  begin(width, height, ground) {
    if (width !== this.width || height !== this.height) {
      this.canvas.width = this.width = width; this.canvas.height = this.height = height;
      this.image = this.context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.depth = new Float32Array(width * height); this.owner = new Uint16Array(width * height);
    }
    this.pixels.fill(packed(ground)); this.depth.fill(NOTHING); this.owner.fill(0);
  }

  // Show the picture, with texts in their places, `size` pixels high.
  end(texts, size) {
    this.context.putImageData(this.image, 0, 0);
    Object.assign(this.context, {font: `${size}px system-ui, sans-serif`, textAlign: "center", textBaseline: "middle"});
    for (const {text, colour, x, y} of texts) { this.context.fillStyle = colour; this.context.fillText(text, x, y); }
  }

  // The number of what is drawn at a place, 0 for nothing; looked for within so many pixels.
  ownerAt(x, y, reach) {
    let found = 0, least = reach * reach + 1;
    for (let v = Math.max(0, Math.floor(y - reach)); v <= Math.min(this.height - 1, y + reach); v++)
      for (let u = Math.max(0, Math.floor(x - reach)); u <= Math.min(this.width - 1, x + reach); u++) {
        const gap = (u - x) ** 2 + (v - y) ** 2, owner = this.owner[v * this.width + u];
        if (owner && gap < least) { least = gap; found = owner; }
      }
    return found;
  }

  // Triangles of places (n, 3); values (n) from 0 to 255 choose the colour of a palette of STEPS, null: it has one;
  // they are those of places, or of triangles when these are flat.
  // Those of closed surfaces are left out where they show their inner side.
  triangles(places, index, palette, values, closed, owner, flat = false) {
    const {width, height, pixels, depth, owner: owners} = this, steps = values ? STEPS : 1, count = index.length;
    for (let k = 0; k < count; k += 3) {
      const i = index[k], j = index[k + 1], l = index[k + 2];
      const ax = places[3 * i], ay = places[3 * i + 1], az = places[3 * i + 2];
      const bx = places[3 * j], by = places[3 * j + 1], cx = places[3 * l], cy = places[3 * l + 1];
      const ux = bx - ax, uy = by - ay, vx = cx - ax, vy = cy - ay;
      // Rows go down, so that what is anticlockwise to the viewer is clockwise in pixels.
      const area = ux * vy - uy * vx;
      if (!(closed ? area < 0 : area !== 0)) continue;
      const least = ay < by ? (ay < cy ? ay : cy) : (by < cy ? by : cy), most = ay > by ? (ay > cy ? ay : cy) : (by > cy ? by : cy);
      let low = Math.ceil(least - 0.5), high = Math.ceil(most - 0.5) - 1;
      if (low < 0) low = 0;
      if (high >= height) high = height - 1;
      if (low > high) continue;
      const uz = places[3 * j + 2] - az, vz = places[3 * l + 2] - az;
      const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz;
      const zx = -nx / area, zy = -ny / area, light = Math.abs(area) / Math.sqrt(nx * nx + ny * ny + area * area);
      const base = ((LEVELS - 1) * (DARKEST + (1 - DARKEST) * light) | 0) * steps;
      let ta = 0, tx = 0, ty = 0;
      if (flat) ta = values[k / 3];
      else if (values) {
        ta = values[i];
        const tu = values[j] - ta, tv = values[l] - ta;
        tx = (tu * vy - tv * uy) / area; ty = (tv * ux - tu * vx) / area;
      }
      // Sides from the upper corner (x0, y0) over the middle one to the lower one.
      let x0 = ax, y0 = ay, x1 = bx, y1 = by, x2 = cx, y2 = cy, swap;
      if (y1 < y0) { swap = x0; x0 = x1; x1 = swap; swap = y0; y0 = y1; y1 = swap; }
      if (y2 < y1) { swap = x1; x1 = x2; x2 = swap; swap = y1; y1 = y2; y2 = swap; }
      if (y1 < y0) { swap = x0; x0 = x1; x1 = swap; swap = y0; y0 = y1; y1 = swap; }
      const m02 = (x2 - x0) / (y2 - y0), m01 = y1 > y0 ? (x1 - x0) / (y1 - y0) : 0, m12 = y2 > y1 ? (x2 - x1) / (y2 - y1) : 0;
      for (let row = low; row <= high; row++) {
        const y = row + 0.5, s = x0 + (y - y0) * m02, t = y < y1 ? x0 + (y - y0) * m01 : x1 + (y - y1) * m12;
        let first = Math.ceil((s < t ? s : t) - 0.5), last = Math.ceil((s < t ? t : s) - 0.5);
        if (first < 0) first = 0;
        if (last > width) last = width;
        let z = az + zx * (first + 0.5 - ax) + zy * (y - ay), value = ta + tx * (first + 0.5 - ax) + ty * (y - ay);
        for (let at = row * width + first, end = row * width + last; at < end; at++) {
          if (z > depth[at]) {
            depth[at] = z; owners[at] = owner;
            // Values may be far outside of the range.
            pixels[at] = palette[base + (value >= steps ? steps - 1 : value > 0 ? value | 0 : 0)];
          }
          z += zx; value += tx;
        }
      }
    }
  }

  // A tube with round ends; both ends at one place: a sphere.
  tube(p, q, radius, palette, owner) {
    const {width, height, pixels, depth, owner: owners} = this;
    const dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2], square = dx * dx + dy * dy, length = Math.sqrt(square);
    const low = Math.max(0, Math.floor(Math.min(p[1], q[1]) - radius)), high = Math.min(height - 1, Math.ceil(Math.max(p[1], q[1]) + radius));
    const left = Math.min(p[0], q[0]) - radius, right = Math.max(p[0], q[0]) + radius;
    for (let row = low; row <= high; row++) {
      const y = row + 0.5 - p[1];
      let first = left, last = right;
      if (Math.abs(dy) > 1e-9) {
        const middle = p[0] + y * dx / dy, half = radius * length / Math.abs(dy);
        // The round ends reach as far as the radius beyond the sides.
        first = Math.max(left, middle - half - radius); last = Math.min(right, middle + half + radius);
      }
      for (let column = Math.max(0, Math.floor(first)); column <= Math.min(width - 1, Math.ceil(last)); column++) {
        const x = column + 0.5 - p[0], along = square > 0 ? Math.min(1, Math.max(0, (x * dx + y * dy) / square)) : 0;
        const gap = (x - along * dx) ** 2 + (y - along * dy) ** 2, rest = radius * radius - gap;
        if (rest <= 0) continue;
        const above = Math.sqrt(rest), z = p[2] + along * dz + above, at = row * width + column;
        if (z <= depth[at]) continue;
        depth[at] = z; owners[at] = owner;
        pixels[at] = palette[(LEVELS - 1) * (DARKEST + (1 - DARKEST) * above / radius) | 0];
      }
    }
  }

  // Lines between pairs of places; without a colour what they cross is darkened.
  lines(places, index, colour, lift, wide) {
    const {width, height, pixels, depth} = this, half = (wide - 1) / 2;
    for (let k = 0; k < index.length; k += 2) {
      const p = 3 * index[k], q = 3 * index[k + 1];
      const dx = places[q] - places[p], dy = places[q + 1] - places[p + 1], dz = places[q + 2] - places[p + 2];
      const count = Math.min(1e5, Math.ceil(Math.max(Math.abs(dx), Math.abs(dy)))) || 1, across = Math.abs(dx) < Math.abs(dy);
      let x = places[p], y = places[p + 1], z = places[p + 2] + lift;
      for (let n = 0; n < count; n++, x += dx / count, y += dy / count, z += dz / count)
        for (let w = 0; w < wide; w++) {
          const u = Math.floor(across ? x + w - half : x), v = Math.floor(across ? y : y + w - half);
          if (u < 0 || v < 0 || u >= width || v >= height) continue;
          const at = v * width + u;
          if (z < depth[at]) continue;
          pixels[at] = colour || (0xff000000 | ((pixels[at] >>> 1) & 0x7f7f7f));
        }
    }
  }
}

function packed(rgb) { return (0xff000000 | Math.round(255 * rgb[2]) << 16 | Math.round(255 * rgb[1]) << 8 | Math.round(255 * rgb[0])) >>> 0; }

// Colours at every level of light, those of the steps of a level side by side.
function palette(colours) {
  const found = new Uint32Array(LEVELS * colours.length);
  for (let level = 0; level < LEVELS; level++)
    colours.forEach((rgb, k) => { found[level * colours.length + k] = packed(rgb.map(part => part * (level + 1) / LEVELS)); });
  return found;
}

// Contours begin here in viridis: what is below is as dark as the page itself.
const CONTOURS_BEGIN = 0.2;

// Viridis (van der Walt and Smith, 2015) as a polynomial.
function viridis(t) {
  const terms = [[-5.4354, 4.6459, 26.3124], [4.7763, -13.7452, -65.3530], [6.2284, 14.1800, 56.6906],
    [-4.6342, -5.7991, -19.3324], [-0.3309, 0.2148, 0.0951], [0.1051, 1.4046, 1.3846], [0.2777, 0.0054, 0.3341]];
  return [0, 1, 2].map(k => Math.min(1, Math.max(0, terms.reduce((sum, term) => sum * t + term[k], 0))));
}
