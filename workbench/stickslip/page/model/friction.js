/** Coulomb friction with a static coefficient above the kinetic one: docs/theory.md (1), (2). */

/**
 * A setting, SI.
 *
 * @typedef {object} Setting
 * @property {number} m mass [kg]
 * @property {number} g gravity [m/s^2]
 * @property {number} load normal force on top of the weight m g [N], at least -m g
 * @property {number} k stiffness of the spring [N/m]
 * @property {number} c viscous damping [N s/m]
 * @property {number} mu_s static coefficient [1]
 * @property {number} mu_k kinetic coefficient in use [1], at most mu_s
 * @property {number} v speed of the pulled end [m/s], above 0
 */

/**
 * What follows from a setting alone: docs/theory.md (2).
 *
 * @typedef {object} Numbers
 * @property {number} N normal force [N]
 * @property {number} F_s break-away force [N]
 * @property {number} F_k kinetic friction force [N]
 * @property {number} Delta spring extension from kinetic to static friction [m]
 * @property {number} w natural frequency [rad/s]
 * @property {number} zeta damping ratio [1]
 * @property {number} lambda_ w Delta/v [1]
 */

/** The gap [1] that a kinetic coefficient above the static one is clamped to. */
const CLAMP_GAP = 0.01;

/**
 * The largest kinetic coefficient that a slider offers: a gap below the static one.
 *
 * @param {number} mu_s static coefficient [1]
 * @returns {number} coefficient [1], not below 0
 */
export function kineticStop(mu_s) {
  return Math.max(mu_s - CLAMP_GAP, 0);
}

/**
 * The kinetic coefficient in use: the one given, or the clamp where it exceeds the static one.
 *
 * @param {number} mu_s static coefficient [1]
 * @param {number} mu_k kinetic coefficient that is asked for [1]
 * @returns {number} coefficient [1]
 */
export function kineticInUse(mu_s, mu_k) {
  return mu_k <= mu_s ? mu_k : kineticStop(mu_s);
}

/**
 * The numbers of a setting.
 *
 * @param {Setting} p
 * @returns {Numbers}
 */
export function numbersOf(p) {
  const N = p.m * p.g + p.load;
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
