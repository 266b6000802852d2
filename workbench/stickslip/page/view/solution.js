/** A setting solved: all that the page shows of it. */

import { isFlat } from "../model/friction.js";
import { criticalVelocity, firstOrderCriticalVelocity, simplified } from "../model/cycle.js";
import { motionOf } from "../model/motion.js";

/** Cycles in the first load-up beyond which the time of one is lost in the time of all. */
const MOST_CYCLES = 1e9;

/** @type {(p: Setting, curve?: Curve | null) => Solution} a curve takes the place of mu_k */
export function solve(p, curve = null) {
  const isBent = curve && !isFlat(curve);
  const solution = {
    motion: motionOf(p, curve),
    simple: simplified(p),
    v_c: isBent ? NaN : criticalVelocity(curve ? { ...p, mu_k: curve[0][1] } : p),
    v_c_simple: firstOrderCriticalVelocity(p),
    constant: null,
  };
  solution.constant = curve ? solve(p) : solution;
  return solution;
}

/** @type {(solution: Solution) => string | null} why a solution cannot be shown, or null */
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
