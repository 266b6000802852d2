/** A setting solved: all that the page shows of it. */

import { criticalVelocity, firstOrderCriticalVelocity } from "../model/critical.js";
import { simplified } from "../model/cycle.js";
import { motionOf } from "../model/motion.js";

/**
 * @import { Simplified } from "../model/cycle.js"
 * @import { Setting } from "../model/friction.js"
 * @import { Motion } from "../model/motion.js"
 */

/**
 * A setting solved.
 *
 * @typedef {object} Solution
 * @property {Motion} motion
 * @property {Simplified} simple the cycle as designers write it
 * @property {number} v_c critical velocity [m/s]
 * @property {number} v_c_simple the same to first order [m/s]
 */

/** Cycles in the first load-up beyond which the time of one is lost in the time of all. */
const MOST_CYCLES = 1e9;

/**
 * Solve a setting.
 *
 * @param {Setting} p
 * @returns {Solution}
 */
export function solve(p) {
  return {
    motion: motionOf(p),
    simple: simplified(p),
    v_c: criticalVelocity(p),
    v_c_simple: firstOrderCriticalVelocity(p),
  };
}

/**
 * Why a solution cannot be shown, or null.
 *
 * @param {Solution} solution
 * @returns {string | null}
 */
export function flawOf({ motion: { cycle, numbers, first, beat, slip }, simple }) {
  const needed = [...Object.values(numbers), ...Object.values(simple), first, beat, slip.rate];
  const cyclic = cycle.exists ? [cycle.f, cycle.delta_x, cycle.x_dot_peak] : [];
  if (![...needed, ...cyclic].every(Number.isFinite) || !(numbers.w > 0)) {
    return "These values together leave the numbers that can be computed with.";
  }
  if (first > MOST_CYCLES * beat) {
    return "With these values the first load-up takes longer than 1e9 cycles.";
  }
  return null;
}
