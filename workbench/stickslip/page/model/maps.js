/** Curves over speed and stiffness: the jump, the critical velocity, lines of equal jump. */

import { jumpAlong, zeroFrom } from "./along.js";
import { criticalVelocity, limitJump, steadyCycle } from "./cycle.js";
import { numbersOf } from "./friction.js";

/** @typedef {{k: number, v: number}} PlanePoint stiffness [N/m], speed [m/s] */

/** Points of the jump; of the critical velocity, which is steep on one side; of a line of equal jump. */
const POINTS = 40;
const CRITICAL_POINTS = 80;
const LINE_POINTS = 28;
/** At this zeta/nu the critical velocity is 1e-16 of its largest. */
const STEEPEST = 12;

/**
 * The exact jump [m] over the speed [m/s], from `low` to `high` or the critical velocity; none where
 * there is no cycle from `low` on. The v of the setting is of no influence.
 * @type {(p: Setting, low: number, high: number) => {v: number, jump: number}[]}
 */
export function jumpOverSpeed(p, low, high) {
  const v_c = criticalVelocity(p);
  if (!(v_c > low)) return [];
  return spaced(low, Math.min(high, v_c), POINTS).map((v) => {
    const { exists, delta_x } = steadyCycle({ ...p, v });
    // At the very end rounding decides whether there is a cycle.
    return { v, jump: exists ? delta_x : limitJump({ ...p, v }) };
  });
}

/**
 * The critical velocity over the stiffness, from `low` to `high` [N/m]; none without damping, or
 * where zeta is 1 or more throughout. The k and v of the setting are of no influence.
 * @type {(p: Setting, low: number, high: number) => PlanePoint[]}
 */
export function criticalCurve(p, low, high) {
  if (p.c === 0) return [];
  // At zeta = 1; eta = zeta/nu, so that k = soft (1 + 1/eta^2).
  const soft = (p.c * p.c) / (4 * p.m);
  const etaAt = (/** @type {number} */ k) => Math.sqrt(soft / (k - soft));
  if (high <= soft) return [];
  const start = low > soft * (1 + STEEPEST ** -2) ? etaAt(low) : STEEPEST;
  return spaced(start, etaAt(high), CRITICAL_POINTS).map((eta) => {
    const k = soft * (1 + 1 / (eta * eta));
    return { k, v: criticalVelocity({ ...p, k }) };
  });
}

/**
 * A line of equal jump [m] in the plane, from the speed `low` to `high` [m/s] or up to the critical
 * velocity; none where there is no such jump. The jump rises with v and falls with k, so k rises
 * with v along the line. The k and v of the setting are of no influence.
 * @type {(p: Setting, jump: number, low: number, high: number) => PlanePoint[]}
 */
export function equalJump(p, jump, low, high) {
  const force = (p.mu_s - p.mu_k) * numbersOf(p).N;
  const damped = p.c > 0;
  // The jump for a slow pull is force/k at zeta = 1 and larger than that at the critical velocity.
  const soft = (p.c * p.c) / (4 * p.m);
  if (damped && !(jump * soft < force)) return [];
  let softest = Math.max(soft, force / jump) * (1 + 1e-12);
  const end = damped ? endOfLine(p, jump, softest) : { k: Infinity, v: Infinity };
  const last = Math.min(end.v, high);
  if (!(last > low)) return [];
  return spaced(low, last, LINE_POINTS).map((v) => {
    if (v === end.v) return end;
    // A slip takes half a swing at least.
    if (!damped) softest = Math.max(softest, p.m * ((Math.PI * v) / jump) ** 2);
    // To the left of the line the speed may be above the critical one.
    const excess = jumpAlong((log) => ({ ...p, k: Math.exp(log), v }), Infinity, jump);
    softest = Math.exp(zeroFrom(excess, Math.log(softest), damped ? Math.log(end.k) : NaN));
    return { k: softest, v };
  });
}

/**
 * Where a line of equal jump [m] of a damped setting meets the critical velocity; at the stiffness
 * `softest` [N/m] every jump is larger.
 * @type {(p: Setting, jump: number, softest: number) => PlanePoint}
 */
function endOfLine(p, jump, softest) {
  /** @type {Way} */
  const way = (log) => {
    const k = Math.exp(log);
    return { ...p, k, v: criticalVelocity({ ...p, k }) };
  };
  const excess = (/** @type {number} */ log) => Math.log(limitJump(way(log)) / jump);
  const { k, v } = way(zeroFrom(excess, Math.log(softest), NaN));
  return { k, v };
}

/** @type {(a: number, b: number, count: number) => number[]} from a to b in equal ratios */
function spaced(a, b, count) {
  const ratio = b / a;
  return Array.from({ length: count }, (_, n) => (n === count - 1 ? b : a * ratio ** (n / (count - 1))));
}
