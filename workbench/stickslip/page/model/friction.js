/** Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (2). */

/** The gap [1] that a kinetic coefficient above the static one is clamped to. */
const CLAMP_GAP = 0.01;

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
