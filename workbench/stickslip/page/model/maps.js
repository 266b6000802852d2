/** Curves over speed and stiffness: the jump, the critical velocity, lines of equal jump. */

import { criticalVelocity, logCriticalLambda } from "./critical.js";
import { grazingPeriod, plainPeriod } from "./cycle.js";
import { numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

/** @import { Setting } from "./friction.js" */

/**
 * A point of the k-v plane.
 *
 * @typedef {{k: number, v: number}} PlanePoint stiffness [N/m], speed [m/s]
 */

/** Points of a curve: enough for straight lines between them. */
const POINTS = 40;
/** The same of the critical velocity, which falls off steeply on one side. */
const CRITICAL_POINTS = 80;
/** At this zeta/nu the critical velocity is 1e-16 of its largest. */
const STEEPEST = 12;
/** The same of a line of equal jump, which is nearly straight. */
const LINE_POINTS = 28;

/**
 * The exact jump over the speed, up to the critical velocity.
 *
 * @param {Setting} p its v is of no influence
 * @param {number} low the lowest speed [m/s]
 * @param {number} high the highest speed [m/s]
 * @returns {{v: number, jump: number}[]} speeds [m/s] and jumps [m], rising; none where there is no
 *   cycle from `low` on
 */
export function jumpOverSpeed(p, low, high) {
  const { Delta, w, zeta } = numbersOf(p);
  const v_c = criticalVelocity(p);
  if (!(v_c > low)) return [];
  return spaced(low, Math.min(high, v_c), POINTS).map((v) => {
    const lambda_ = (w * Delta) / v;
    const period = plainPeriod(lambda_, zeta);
    // At the very end rounding decides whether there is a cycle.
    return { v, jump: (v / w) * (Number.isNaN(period) ? grazingPeriod(lambda_, zeta) : period) };
  });
}

/**
 * What the jump comes down to for a slow pull.
 *
 * @param {Setting} p its v is of no influence
 * @returns {number} [m]; 2 Delta without damping
 */
export function slowJump(p) {
  const { Delta, zeta } = numbersOf(p);
  return Delta * (1 + Math.exp((-Math.PI * zeta) / Math.sqrt((1 - zeta) * (1 + zeta))));
}

/**
 * The critical velocity over the stiffness.
 *
 * @param {Setting} p its k and v are of no influence
 * @param {number} low the lowest stiffness [N/m]
 * @param {number} high the highest stiffness [N/m]
 * @returns {PlanePoint[]} k rising; none without damping, or where zeta is 1 or more throughout
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
 * A line of equal jump in the k-v plane.
 *
 * The jump rises with v and falls with k, so k rises with v along the line, up to the critical
 * velocity.
 *
 * @param {Setting} p its k and v are of no influence
 * @param {number} jump [m]
 * @param {number} low a speed [m/s]
 * @param {number} high a higher one [m/s]
 * @returns {PlanePoint[]} v rising, through both speeds or up to the end of the line; none where
 *   there is no such jump between the speeds
 */
export function equalJump(p, jump, low, high) {
  const force = (p.mu_s - p.mu_k) * (p.m * p.g + p.load);
  if (p.c === 0) {
    if (force === 0) {
      return [low, high].map((v) => ({ k: p.m * ((2 * Math.PI * v) / jump) ** 2, v }));
    }
    // With lambda given both follow: jump = (v/w) period, lambda = force/(v sqrt(k m)).
    const scale = Math.sqrt((jump * force) / p.m);
    const [slow, fast] = [scale / low, scale / high];
    // As the period is 2 pi to 2 pi + 2 lambda, these reach beyond both speeds.
    const [first, last] = [Math.min(slow, slow ** 2 / 6), Math.min(fast, fast ** 2) / 7];
    return spaced(first, last, 2 * LINE_POINTS).map((lambda_) => {
      const v = scale / Math.sqrt(lambda_ * plainPeriod(lambda_, 0));
      return { k: (force / (v * lambda_)) ** 2 / p.m, v };
    });
  }
  if (!(force > 0)) return [];
  // The jump for a slow pull is force/k at zeta = 1 and larger than that at the critical velocity.
  const soft = (p.c * p.c) / (4 * p.m);
  if (jump * soft >= force) return [];
  const softest = Math.max(soft, force / jump) * (1 + 1e-12);
  const end = endOfLine(p, jump, softest);
  const last = Math.min(end.v, high);
  if (!(last > low)) return [];
  let k = softest;
  return spaced(low, last, LINE_POINTS).map((v) => {
    if (v === end.v) return end;
    /** @type {(log: number) => number} */
    const excess = (log) => {
      const { Delta, w, zeta } = numbersOf({ ...p, k: Math.exp(log) });
      const period = zeta < 1 ? plainPeriod((w * Delta) / v, zeta) : NaN;
      // To the left of the line the speed may be above the critical one.
      return Number.isNaN(period) ? 1 : Math.log(((v / w) * period) / jump);
    };
    k = Math.exp(zeroBetween(excess, Math.log(k), Math.log(end.k)));
    return { k, v };
  });
}

/**
 * Where a line of equal jump meets the critical velocity.
 *
 * @param {Setting} p damped
 * @param {number} jump [m]
 * @param {number} softest a stiffness at which every jump is larger [N/m]
 * @returns {PlanePoint}
 */
function endOfLine(p, jump, softest) {
  /** @type {(log: number) => number} */
  const excess = (log) => {
    const { Delta, w, zeta } = numbersOf({ ...p, k: Math.exp(log) });
    const logLambda = logCriticalLambda(zeta);
    const v = w * Delta * Math.exp(-logLambda);
    return Math.log(((v / w) * grazingPeriod(Math.exp(logLambda), zeta)) / jump);
  };
  const low = Math.log(softest);
  let high = low + 1;
  while (excess(high) > 0) high += 1;
  const k = Math.exp(zeroBetween(excess, low, high));
  return { k, v: criticalVelocity({ ...p, k }) };
}

/** @type {(a: number, b: number, count: number) => number[]} from a to b in equal ratios */
function spaced(a, b, count) {
  const ratio = b / a;
  return Array.from({ length: count }, (_, n) => (n === count - 1 ? b : a * ratio ** (n / (count - 1))));
}
