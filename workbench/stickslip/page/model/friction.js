/** Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (2). */

/** The gap that a kinetic coefficient above the static one is clamped to. */
const CLAMP_GAP = 0.01;

/** The largest kinetic coefficient that a slider offers: a gap below the static one. */
export function kineticStop(mu_s) {
  return Math.max(mu_s - CLAMP_GAP, 0);
}

/** The kinetic coefficient in use: the one given, or the clamp where it exceeds the static one. */
export function kineticInUse(mu_s, mu_k) {
  return mu_k <= mu_s ? mu_k : kineticStop(mu_s);
}

/**
 * What follows from a setting alone: docs/theory.md (2).
 *
 * @param {{m: number, g: number, k: number, c: number, mu_s: number, mu_k: number, v: number}} p
 *   SI; v > 0, mu_k the coefficient in use
 * @returns {{N, F_s, F_k, Delta, w, zeta, lambda_}} normal, break-away and kinetic force [N],
 *   Delta [m], w [rad/s], and the two plain numbers
 */
export function numbersOf(p) {
  const N = p.m * p.g;
  const w = Math.sqrt(p.k / p.m);
  // The difference is formed from the coefficients, where it is exact when they are close.
  const Delta = ((p.mu_s - p.mu_k) * N) / p.k;
  return {
    N,
    F_s: p.mu_s * N,
    F_k: p.mu_k * N,
    Delta,
    w,
    zeta: p.c / (2 * p.m * w),
    lambda_: (w * Delta) / p.v,
  };
}
