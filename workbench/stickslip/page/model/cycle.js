/** The steady cycle in closed form, and as designers write it: docs/theory.md (6) to (13). */

import { numbersOf } from "./friction.js";
import { risingZero } from "./root.js";

/** @import { Setting } from "./friction.js" */

/**
 * The exact steady cycle; what depends on its slip is NaN where there is no cycle.
 *
 * @typedef {object} Cycle
 * @property {number} F_s break-away force [N]
 * @property {number} Delta spring extension from kinetic to static friction [m]
 * @property {number} lambda_ w Delta/v [1]
 * @property {number} zeta damping ratio [1]
 * @property {number} w natural frequency [rad/s]
 * @property {boolean} exists whether a slip from rest comes to rest
 * @property {number} spring_drop relief of the spring in a slip [m]
 * @property {number} delta_x jump of the mass [m]
 * @property {number} t_slip time in slip [s]
 * @property {number} t_stick time in stick [s]
 * @property {number} T period [s]
 * @property {number} f frequency [Hz]
 * @property {number} x_dot_peak largest velocity of the mass [m/s]
 * @property {number} share share of stick in the period [1]
 */

/**
 * The cycle as designers write it.
 *
 * @typedef {object} Simplified
 * @property {number} F_s break-away force [N]
 * @property {number} delta_x jump of the mass [m]
 * @property {number} t_stick time in stick [s]
 * @property {number} t_slip time in slip [s]
 * @property {number} T period [s]
 * @property {number} f frequency [Hz]
 * @property {number} share share of stick in the period [1]
 */

/**
 * A slip of the cycle in plain numbers.
 *
 * @typedef {object} PlainSlip
 * @property {number} duration in units of 1/w
 * @property {number} relief of the spring, in units of v/w
 * @property {number} peak largest velocity of the mass, in units of v
 */

/**
 * The exact steady cycle.
 *
 * @param {Setting} p
 * @returns {Cycle}
 */
export function steadyCycle(p) {
  const { F_s, Delta, lambda_, zeta, w } = numbersOf(p);
  const slip = plainSlip(lambda_, zeta);
  const { duration, relief, peak } = slip ?? { duration: NaN, relief: NaN, peak: NaN };
  const t_slip = duration / w;
  const t_stick = relief / w;
  const T = t_stick + t_slip;
  return {
    F_s,
    Delta,
    lambda_,
    zeta,
    w,
    exists: slip !== null,
    spring_drop: t_stick * p.v,
    delta_x: p.v * T,
    t_slip,
    t_stick,
    T,
    f: 1 / T,
    x_dot_peak: p.v * peak,
    share: t_stick / T,
  };
}

/**
 * The cycle as designers write it, without damping: docs/theory.md (12).
 *
 * @param {Setting} p its v above 0, its c of no influence
 * @returns {Simplified}
 */
export function simplified(p) {
  const { F_s, Delta, w } = numbersOf(p);
  const t_stick = F_s / (p.k * p.v);
  const t_slip = Math.PI / w;
  const T = t_stick + t_slip;
  return { F_s, delta_x: 2 * Delta, t_stick, t_slip, T, f: 1 / T, share: t_stick / T };
}

/**
 * The slip of the cycle, or null where a slip from rest never ends.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @param {number} zeta damping ratio [1]
 * @returns {PlainSlip | null}
 */
function plainSlip(lambda_, zeta) {
  return zeta === 0 ? undampedSlip(lambda_) : dampedSlip(lambda_, zeta);
}

/**
 * Period in units of 1/w, which is the jump in units of v/w.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @param {number} zeta damping ratio [1]
 * @returns {number} NaN without a cycle
 */
export function plainPeriod(lambda_, zeta) {
  const slip = plainSlip(lambda_, zeta);
  return slip ? slip.duration + slip.relief : NaN;
}

/**
 * The period at the limit of the cycle, in units of 1/w: the slip lasts up to the minimum of the velocity, and the
 * spring relief is Delta.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @param {number} zeta damping ratio [1], below 1
 * @returns {number}
 */
export function grazingPeriod(lambda_, zeta) {
  const nu = Math.sqrt((1 - zeta) * (1 + zeta));
  return lambda_ + (2 * Math.PI - Math.atan2(nu * lambda_, 1 - zeta * lambda_)) / nu;
}

/**
 * The slip of the cycle without damping: (7), (8), (11).
 *
 * @param {number} lambda_ w Delta/v [1]
 * @returns {PlainSlip}
 */
function undampedSlip(lambda_) {
  return {
    duration: 2 * (Math.PI - Math.atan(lambda_)),
    relief: 2 * lambda_,
    peak: 1 + Math.hypot(1, lambda_),
  };
}

/**
 * The same with damping, or null where a slip from rest never ends: (13).
 *
 * In these units the velocity deviation from the pull, x_dot/v - 1, starts at -1 and is
 * -D G(delta), delta being the time left to its minimum, where
 *
 *     D = sqrt(1 - 2 zeta lambda + lambda^2) exp(-zeta s_min)
 *     G = exp(zeta delta) (cos(nu delta) - (zeta/nu) sin(nu delta))
 *
 * and G falls from 1 at the minimum to 0 at nu delta = acos zeta. The slip ends at G = 1/D.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @param {number} zeta damping ratio [1], above 0
 * @returns {PlainSlip | null}
 */
function dampedSlip(lambda_, zeta) {
  if (zeta >= 1) return null;
  const nu = Math.sqrt((1 - zeta) * (1 + zeta));
  const angle = Math.atan2(lambda_ * nu, 1 - zeta * lambda_);
  // ln of the amplitude, from the small side of lambda = 1 and from the large.
  const ratio = lambda_ < 1 ? lambda_ : 1 / lambda_;
  const logAmplitude =
    0.5 * Math.log1p(ratio * (ratio - 2 * zeta)) + Math.log(Math.max(lambda_, 1));
  const minimum = (2 * Math.PI - angle) / nu;
  const logD = logAmplitude - zeta * minimum;
  if (!(logD >= 0)) return null;
  const delta = timeBeforeMinimum(logD, zeta, nu);
  const deceleration = (Math.exp(logD + zeta * delta) * Math.sin(nu * delta)) / nu;
  return {
    duration: minimum - delta,
    // From the acceleration of the start to the deceleration of the end.
    relief: lambda_ + deceleration,
    peak: 1 + Math.exp(logAmplitude - (zeta * (Math.PI - angle)) / nu),
  };
}

/**
 * Solve G(delta) = 1/D in sqrt(1 - G), nearly linear in delta as 1 - G begins as its square.
 *
 * @param {number} logD ln D [1], not below 0
 * @param {number} zeta damping ratio [1], above 0 and below 1
 * @param {number} nu sqrt(1 - zeta^2) [1]
 * @returns {number} delta, in units of 1/w
 */
function timeBeforeMinimum(logD, zeta, nu) {
  const target = Math.sqrt(-Math.expm1(-logD));
  if (target === 0) return 0;
  const high = Math.acos(zeta) / nu;
  const undamped = Math.asin(Math.sqrt(-Math.expm1(-2 * logD)));
  /** @type {(delta: number) => [number, number]} */
  const excess = (delta) => {
    const sine = Math.sin(nu * delta);
    const half = Math.sin(0.5 * nu * delta);
    const growth = Math.exp(zeta * delta);
    // 1 - G, its leading ones cancelled by hand.
    const depth =
      2 * half * half +
      growth * (zeta / nu) * sine -
      Math.expm1(zeta * delta) * (1 - 2 * half * half);
    const root = Math.sqrt(Math.max(depth, 0));
    return [root - target, (growth * sine) / (2 * nu * Math.max(root, 1e-300))];
  };
  return risingZero(excess, 0, high, Math.min(undamped, high));
}
