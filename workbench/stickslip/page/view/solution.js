/** A setting solved: all that the page shows of it. */

import { criticalVelocity, firstOrderCriticalVelocity } from "../model/critical.js";
import { isFlat } from "../model/curve.js";
import { simplified } from "../model/cycle.js";
import { motionOf } from "../model/motion.js";

/**
 * @import { Curve } from "../model/curve.js"
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
 * @property {number} v_c critical velocity [m/s], NaN under a friction curve that is not flat
 * @property {number} v_c_simple the same to first order [m/s]
 * @property {Solution} constant the same with constant friction
 */

/** Cycles in the first load-up beyond which the time of one is lost in the time of all. */
const MOST_CYCLES = 1e9;

/**
 * Solve a setting.
 *
 * @param {Setting} p
 * @param {Curve | null} [curve] friction curve, in place of mu_k
 * @returns {Solution}
 */
export function solve(p, curve = null) {
  const isFlatOne = curve && isFlat(curve);
  const used = isFlatOne ? { ...p, mu_k: curve[0][1] } : p;
  /** @type {Solution} */
  const solution = {
    motion: motionOf(p, curve),
    simple: simplified(p),
    v_c: curve && !isFlatOne ? NaN : criticalVelocity(used),
    v_c_simple: firstOrderCriticalVelocity(p),
    constant: null,
  };
  solution.constant = curve ? solve(p) : solution;
  return solution;
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
