/** From which velocity on a damped slip no longer comes to rest: docs/theory.md (13), (14). */

import { nuOf, numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

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
