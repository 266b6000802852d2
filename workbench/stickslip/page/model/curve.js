/** A measured friction curve: straight lines between points of speed and coefficient. */

import { oscillatorOf } from "./slip.js";

/**
 * @import { Setting } from "./friction.js"
 * @import { Oscillator } from "./slip.js"
 */

/**
 * Points (u, mu) of rising speed [m/s], the first at 0; between them the coefficient of friction in
 * slip is a straight line, beyond the last it is constant.
 *
 * @typedef {[u: number, mu: number][]} Curve
 */

/**
 * Speeds on one line of a curve: slip is linear there, damped by the line's slope too.
 *
 * @typedef {object} Band
 * @property {number} low lower end [m/s]
 * @property {number} high upper end [m/s], infinite for the last
 * @property {number} fall -dmu/du [s/m]
 * @property {Oscillator} oscillator
 */

/** Points of a curve at least and at most. */
export const CURVE_POINTS = { least: 2, most: 12 };

/**
 * The coefficient at a speed.
 *
 * @param {Curve} curve
 * @param {number} u speed [m/s], not below 0
 * @returns {number} [1]
 */
export function coefficientAt(curve, u) {
  for (let i = 1; i < curve.length; i++) {
    const [low, mu] = curve[i - 1];
    const [high, next] = curve[i];
    if (u < high) return mu + ((next - mu) * (u - low)) / (high - low);
  }
  return curve[curve.length - 1][1];
}

/**
 * Whether a curve is a constant, which is Coulomb's friction.
 *
 * @param {Curve} curve
 * @returns {boolean}
 */
export function isFlat(curve) {
  return curve.every(([, mu]) => mu === curve[0][1]);
}

/**
 * The bands of a curve; neighbours on one line are one band.
 *
 * @param {Setting} p
 * @param {Curve} curve
 * @returns {Band[]} by rising speed
 */
export function bandsOf({ m, g, load, k, c }, curve) {
  const N = m * g + load;
  /** @type {Band[]} */
  const bands = [];
  curve.forEach(([low, mu], at) => {
    const [high, next] = curve[at + 1] ?? [Infinity, mu];
    const fall = high < Infinity ? (mu - next) / (high - low) : 0;
    const last = bands[bands.length - 1];
    if (last?.fall === fall) last.high = high;
    else {
      const oscillator = oscillatorOf(Math.sqrt(k / m), (c - N * fall) / (2 * m));
      bands.push({ low, high, fall, oscillator });
    }
  });
  return bands;
}

/**
 * What is wrong with a curve, or null.
 *
 * @param {Curve} curve
 * @param {number} mu_s break-away coefficient [1]
 * @returns {string | null}
 */
export function curveFlaw(curve, mu_s) {
  const { least, most } = CURVE_POINTS;
  if (curve.length < least || curve.length > most) {
    return `The curve has ${curve.length} points; it must have ${least} to ${most}.`;
  }
  for (const [at, [u, mu]] of curve.entries()) {
    const before = at ? curve[at - 1][0] : 0;
    const rises = at ? u > before && u < Infinity : u === 0;
    const wanted = at ? "above" : "at";
    if (!rises) return `u${at + 1} = ${u} m/s: it must be ${wanted} ${before} m/s.`;
    if (!(mu >= 0 && mu < Infinity)) return `mu${at + 1} = ${mu}: it must be 0 or more.`;
  }
  const mu_1 = curve[0][1];
  return mu_1 > mu_s ? `mu1 = ${mu_1} of the curve must be at most μs = ${mu_s}.` : null;
}
