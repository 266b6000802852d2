/** Stick-slip as a script marches it: velocity Verlet, events seen at the ends of steps. */

import { numbersOf } from "./friction.js";

/** Steps of slip after which a run is given up. */
const MOST_STEPS = 1e5;

/**
 * The first cycle of a run from rest on a relaxed spring, without damping, in steps of h [s]: read
 * off at the ends of steps [SI], NaN what the run did not come to.
 *
 * The steps are those of stickslip_design.claims.verlet.march, operation by operation. The steps of
 * a stick change nothing, so they are counted at once.
 *
 * @type {(p: Setting, h: number) => Record<"break_away" | "t_slip" | "t_stick" | "T" | "delta_x", number>}
 */
export function march(p, h) {
  const { F_s, F_k } = numbersOf(p);
  const { m, k, v } = p;
  let [x, x_dot, a, s, n] = [0, 0, 0, 0, 0];
  /** @type {[number, number][]} time [s] and position [m] of each break-away */
  const starts = [];
  /** @type {[number, number][]} the same of each end of a slip */
  const ends = [];
  for (let steps = 0; steps < MOST_STEPS && starts.length < 2; steps++) {
    n = s === 0 ? stepOfBreakAway(n + 1, (t) => k * (v * t - x) > F_s, h, x / v + F_s / k / v) : n + 1;
    if (!(n < Number.MAX_SAFE_INTEGER)) break;
    const t = n * h;
    x += (x_dot + 0.5 * h * a) * h;
    const force = k * (v * t - x);
    const next = s === 0 ? 0 : (force - s * F_k) / m;
    x_dot += 0.5 * h * (a + next);
    a = next;
    if (s * x_dot > 0) continue;
    if (s !== 0) {
      ends.push([t, x]);
      [x_dot, a, s] = [0, 0, 0];
    }
    if (Math.abs(force) > F_s) {
      s = Math.sign(force);
      a = (force - s * F_k) / m;
      starts.push([t, x]);
    }
  }
  const none = [NaN, NaN];
  const [first = none, second = none] = starts;
  const [end = none] = ends;
  return {
    break_away: first[0],
    t_slip: end[0] - first[0],
    t_stick: second[0] - end[0],
    T: second[0] - first[0],
    delta_x: end[1] - first[1],
  };
}

/**
 * The first step, `from` the earliest on, at whose end the mass breaks away; at a time [s] it does,
 * and from then on; about when is `near` [s].
 * @type {(from: number, breaks: (t: number) => boolean, h: number, near: number) => number}
 */
function stepOfBreakAway(from, breaks, h, near) {
  let n = Math.max(from, Math.floor(near / h) - 2);
  // A few steps of rounding away at most; more are not to be counted one by one.
  const last = n + 1000;
  while (n > from && breaks((n - 1) * h)) n -= 1;
  while (n < last && !breaks(n * h)) n += 1;
  return n < last ? n : Infinity;
}
