/** Friction, of two constants or by a curve, and what follows from a setting alone: docs/theory.md (1), (2). */

import { oscillatorOf } from "./arc.js";

/** The gap [1] that a kinetic coefficient above the static one is clamped to. */
const CLAMP_GAP = 0.01;
/** Points of a curve at least and at most. */
export const CURVE_POINTS = { least: 2, most: 12 };

/** @type {(mu_s: number) => number} the largest mu_k that a slider offers: a gap below mu_s, from 0 */
export function kineticStop(mu_s) {
  return Math.max(mu_s - CLAMP_GAP, 0);
}

/** @type {(mu_s: number, mu_k: number) => number} mu_k in use: clamped where it exceeds mu_s */
export function kineticInUse(mu_s, mu_k) {
  return mu_k <= mu_s ? mu_k : kineticStop(mu_s);
}

/** @type {(p: Setting) => Numbers} */
export function numbersOf(p) {
  const N = p.m * p.g + p.load;
  const w = Math.sqrt(p.k / p.m);
  // The difference is formed from the coefficients, where it is exact when they are close.
  const Delta = ((p.mu_s - p.mu_k) * N) / p.k;
  const plain = { zeta: p.c / (2 * p.m * w), lambda_: (w * Delta) / p.v };
  return { N, F_s: p.mu_s * N, F_k: p.mu_k * N, Delta, w, ...plain };
}

/** @type {(zeta: number) => number} nu = sqrt(1 - zeta^2) of a damping ratio up to 1 */
export function nuOf(zeta) {
  return Math.sqrt((1 - zeta) * (1 + zeta));
}

/** @type {(curve: Curve, u: number) => number} the coefficient [1] at a speed u [m/s] from 0 on */
export function coefficientAt(curve, u) {
  const at = curve.findIndex(([high]) => u < high);
  if (at < 0) return curve[curve.length - 1][1];
  const [[low, mu], [high, next]] = curve.slice(at - 1);
  return mu + ((next - mu) * (u - low)) / (high - low);
}

/** @type {(curve: Curve) => boolean} whether it is a constant, which is Coulomb's friction */
export function isFlat(curve) {
  return curve.every(([, mu]) => mu === curve[0][1]);
}

/** @type {(p: Setting, curve: Curve) => Band[]} by rising speed; neighbours on a line are one */
export function bandsOf(p, curve) {
  const { N, w } = numbersOf(p);
  /** @type {Band[]} */
  const bands = [];
  curve.forEach(([low, mu], at) => {
    const [high, next] = curve[at + 1] ?? [Infinity, mu];
    const fall = high < Infinity ? (mu - next) / (high - low) : 0;
    const last = bands[bands.length - 1];
    if (last?.fall === fall) last.high = high;
    else bands.push({ low, high, fall, oscillator: oscillatorOf(w, (p.c - N * fall) / (2 * p.m)) });
  });
  return bands;
}

/** @type {(curve: Curve, mu_s: number) => string | null} what is wrong with a curve, or null */
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
