/** The steady cycle and its critical velocity, exact and as designers write it: docs/theory.md (6) to (14). */

import { nuOf, numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

/** In units of 1/w, v/w and v. @typedef {{duration: number, relief: number, peak: number}} PlainSlip */
/** @type {PlainSlip} */
const NO_SLIP = { duration: NaN, relief: NaN, peak: NaN };

/** @type {(t_stick: number, t_slip: number) => Period} */
function periodOf(t_stick, t_slip) {
  const T = t_stick + t_slip;
  return { t_stick, t_slip, T, f: 1 / T, share: t_stick / T };
}

/** @type {(p: Setting, t_stick: number, t_slip: number, x_dot_peak: number) => Cycle} */
export function cycleOf(p, t_stick, t_slip, x_dot_peak) {
  const period = periodOf(t_stick, t_slip);
  const ofSlip = { spring_drop: t_stick * p.v, delta_x: p.v * period.T, x_dot_peak };
  return { ...numbersOf(p), ...period, ...ofSlip, exists: !Number.isNaN(t_slip) };
}

/** @type {(p: Setting) => Cycle} the exact steady cycle */
export function steadyCycle(p) {
  const { lambda_, zeta, w } = numbersOf(p);
  const { duration, relief, peak } = plainSlip(lambda_, zeta);
  return cycleOf(p, relief / w, duration / w, p.v * peak);
}

/** @type {(p: Setting) => Simplified} as designers write it, without damping: docs/theory.md (12) */
export function simplified(p) {
  const { F_s, Delta, w } = numbersOf(p);
  return { F_s, delta_x: 2 * Delta, ...periodOf(F_s / (p.k * p.v), Math.PI / w) };
}

/**
 * The jump [m] of a setting at the limit of the cycle: the slip lasts up to the minimum of the
 * velocity, and the spring relief is Delta.
 * @type {(p: Setting) => number}
 */
export function limitJump(p) {
  const { lambda_, zeta, w } = numbersOf(p);
  const nu = nuOf(zeta);
  const angle = 2 * Math.PI - Math.atan2(nu * lambda_, 1 - zeta * lambda_);
  return (p.v / w) * (lambda_ + angle / nu);
}

/** @type {(p: Setting) => number} the jump [m] of a slow pull; 2 Delta without damping */
export function slowJump(p) {
  const { Delta, zeta } = numbersOf(p);
  return Delta * (1 + Math.exp((-Math.PI * zeta) / nuOf(zeta)));
}

/**
 * The slip of the cycle, (7), (8), (11); with damping (13), where a slip from rest may never end.
 *
 * In these units the velocity deviation from the pull, x_dot/v - 1, starts at -1 and is
 * -D G(delta), delta being the time left to its minimum, where
 *
 *     D = sqrt(1 - 2 zeta lambda + lambda^2) exp(-zeta s_min)
 *     G = exp(zeta delta) (cos(nu delta) - (zeta/nu) sin(nu delta))
 *
 * and G falls from 1 at the minimum to 0 at nu delta = acos zeta. The slip ends at G = 1/D.
 *
 * @type {(lambda_: number, zeta: number) => PlainSlip}
 */
function plainSlip(lambda_, zeta) {
  if (zeta === 0) {
    const duration = 2 * (Math.PI - Math.atan(lambda_));
    return { duration, relief: 2 * lambda_, peak: 1 + Math.hypot(1, lambda_) };
  }
  if (!(zeta < 1)) return NO_SLIP;
  const nu = nuOf(zeta);
  const angle = Math.atan2(lambda_ * nu, 1 - zeta * lambda_);
  // ln of the amplitude, from the small side of lambda = 1 and from the large.
  const ratio = lambda_ < 1 ? lambda_ : 1 / lambda_;
  const logAmplitude =
    0.5 * Math.log1p(ratio * (ratio - 2 * zeta)) + Math.log(Math.max(lambda_, 1));
  const minimum = (2 * Math.PI - angle) / nu;
  const logD = logAmplitude - zeta * minimum;
  if (!(logD >= 0)) return NO_SLIP;
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
 * @type {(logD: number, zeta: number, nu: number) => number} delta, in units of 1/w
 */
function timeBeforeMinimum(logD, zeta, nu) {
  const target = Math.sqrt(-Math.expm1(-logD));
  const excess = (/** @type {number} */ delta) => {
    const sine = Math.sin(nu * delta);
    const half = Math.sin(0.5 * nu * delta);
    const growth = Math.exp(zeta * delta);
    // 1 - G, its leading ones cancelled by hand.
    const depth =
      2 * half * half +
      growth * (zeta / nu) * sine -
      Math.expm1(zeta * delta) * (1 - 2 * half * half);
    return Math.sqrt(Math.max(depth, 0)) - target;
  };
  return zeroBetween(excess, 0, Math.acos(zeta) / nu);
}

/**
 * The critical velocity v_c [m/s], whatever v is: infinite without damping, where there is none; 0
 * where damping leaves no cycle at any speed.
 * @type {(p: Setting) => number}
 */
export function criticalVelocity(p) {
  if (p.c === 0) return Infinity;
  const { w, Delta, zeta } = numbersOf(p);
  return zeta < 1 ? w * Delta * Math.exp(-logCriticalLambda(zeta)) : 0;
}

/** @type {(p: Setting) => number} the handbooks' v_c [m/s], first order; NaN without damping */
export function firstOrderCriticalVelocity(p) {
  const { Delta, zeta } = numbersOf(p);
  return p.c === 0 ? NaN : (p.k * Delta) / Math.sqrt(4 * Math.PI * zeta * p.k * p.m);
}

/**
 * ln lambda_c, the unknown in which the equation is nearly linear at both ends; 0 < zeta < 1.
 * @type {(zeta: number) => number}
 */
export function logCriticalLambda(zeta) {
  const nu = nuOf(zeta);
  // Light damping gives lambda_c = sqrt(4 pi zeta), heavy exp((zeta/nu)(pi + acos zeta)). The root
  // is above the first and below the sum of both; a unit to each side makes them a bracket.
  const light = 0.5 * Math.log(4 * Math.PI * zeta);
  const heavy = (zeta / nu) * (Math.PI + Math.acos(zeta));
  const low = light - 1;
  const high = Math.max(light, heavy) + Math.LN2 + 1;
  return zeroBetween((log) => logDepth(log, zeta), low, high);
}

/**
 * ln of the deepest velocity deviation over v at ln lambda: a slip from rest ends where it is 0 or
 * more.
 * @type {(log: number, zeta: number) => number}
 */
export function logDepth(log, zeta) {
  const nu = nuOf(zeta);
  // Below lambda = 1 the logarithm is of 1 + lambda (lambda - 2 zeta), above of lambda times that.
  const e = Math.exp(-Math.abs(log));
  const inner = e * (e - 2 * zeta);
  const small = log < 0;
  const angle = small ? Math.atan2(e * nu, 1 - zeta * e) : Math.atan2(nu, e - zeta);
  const growth = 0.5 * Math.log1p(inner) + (small ? 0 : log);
  return growth - (zeta / nu) * (2 * Math.PI - angle);
}
