/** Numbers as a person reads them: four digits and a unit of fitting size. */

/** @type {Record<string, [size: number, unit: string][]>} sizes [SI] and units, falling */
const SCALES = {
  length: [
    [1e3, "km"],
    [1, "m"],
    [1e-3, "mm"],
    [1e-6, "µm"],
    [1e-9, "nm"],
  ],
  velocity: [
    [1, "m/s"],
    [1e-3, "mm/s"],
    [1e-6, "µm/s"],
    [1e-9, "nm/s"],
    [1e-3 / 31557600, "mm/year"],
  ],
  mass: [
    [1e3, "t"],
    [1, "kg"],
    [1e-3, "g"],
    [1e-6, "mg"],
  ],
  stiffness: [
    [1e12, "TN/m"],
    [1e9, "kN/µm"],
    [1e6, "N/µm"],
    [1e3, "kN/m"],
    [1, "N/m"],
    [1e-3, "mN/m"],
  ],
  damping: [
    [1e12, "TN·s/m"],
    [1e9, "GN·s/m"],
    [1e6, "MN·s/m"],
    [1e3, "kN·s/m"],
    [1, "N·s/m"],
    [1e-3, "mN·s/m"],
  ],
  force: [
    [1e12, "TN"],
    [1e9, "GN"],
    [1e6, "MN"],
    [1e3, "kN"],
    [1, "N"],
    [1e-3, "mN"],
    [1e-6, "µN"],
  ],
  time: [
    [31557600, "years"],
    [86400, "days"],
    [3600, "h"],
    [60, "min"],
    [1, "s"],
    [1e-3, "ms"],
    [1e-6, "µs"],
    [1e-9, "ns"],
  ],
  frequency: [
    [1e6, "MHz"],
    [1e3, "kHz"],
    [1, "Hz"],
    [1e-3, "mHz"],
    [1e-6, "µHz"],
    [1e-9, "nHz"],
  ],
  share: [[0.01, "%"]],
  number: [[1, ""]],
};

/** Units that begin to be better read than the next smaller one at more than one of them. */
/** @type {Record<string, number>} */
const ENOUGH = { min: 2, h: 2, days: 2, years: 2, "nm/s": 10, "kN/m": 10 };

/**
 * The unit in which a value is read best.
 *
 * @param {number} value SI
 * @param {string} kind a key of the scales, such as "length"
 * @returns {{size: number, unit: string}} the unit and its size in SI
 */
export function scaleFor(value, kind) {
  const scales = SCALES[kind];
  const magnitude = Math.abs(value);
  const found = scales.find(([size, unit]) => magnitude >= size * (ENOUGH[unit] ?? 0.9999));
  const home = scales.find(([size]) => size === 1) ?? scales[0];
  const [size, unit] = found ?? (magnitude > 0 ? scales[scales.length - 1] : home);
  return { size, unit };
}

/**
 * A number with this many significant digits, a typeset minus, an exponent only where needed.
 *
 * @param {number} value
 * @param {number} [count]
 */
export function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  const readable = magnitude >= 1e-3 && magnitude < Math.max(1e5, 10 ** count);
  const plain = !readable
    ? value.toExponential(count - 1).replace("e+", "e")
    : magnitude >= 10 ** count
      ? value.toFixed(0)
      : value.toPrecision(count);
  return plain.replace(/^-/, "−");
}

/**
 * A quantity as text, such as "6.305 mm"; a dash where it is no number.
 *
 * @param {number} value SI
 * @param {string} kind a key of the scales
 * @param {{size: number, unit: string}} [scale] a unit to keep to
 */
export function quantity(value, kind, scale = scaleFor(value, kind)) {
  if (!Number.isFinite(value)) return "–";
  const number = digits(value / scale.size);
  return scale.unit ? `${number}\u00a0${scale.unit}` : number;
}

/**
 * A quantity with a fixed number of decimals, for numbers that change under the eye.
 *
 * @param {number} value SI
 * @param {{size: number, unit: string, decimals: number}} scale
 */
export function fixed(value, { size, unit, decimals }) {
  const text = (value / size).toFixed(decimals).replace(/^-(?!0\.?0*$)/, "−");
  return `${text.replace(/^-/, "")}\u00a0${unit}`;
}

/**
 * The text of a double, with an exponent where zeros would fill it.
 *
 * @param {number} value
 */
export function shortest(value) {
  const plain = String(value);
  const withExponent = value.toExponential().replace("e+", "e");
  return plain.length > 7 && withExponent.length < plain.length ? withExponent : plain;
}
