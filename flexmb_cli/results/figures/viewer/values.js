// Values of the report's pages: arrays from text, numbers as texts, stresses and strains of a tensor.

const DEFORMATION = "deformation", ENERGY = "strain energy of the element", COMPONENTS = ["xx", "yy", "zz", "xy", "yz", "zx"];

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
