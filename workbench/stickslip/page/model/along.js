/** One solver for cures and maps: on a way through the settings, where the cycle ends or halves. */

import { logDepth } from "./critical.js";
import { steadyCycle } from "./cycle.js";
import { numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

/** Logarithms of a factor beyond which nothing is searched. */
const FURTHEST = 700;

/** @type {(p: Setting) => number} the cycle exists where it is 0 or more */
export function marginOf(p) {
  const { lambda_, zeta } = numbersOf(p);
  return zeta < 1 ? logDepth(Math.log(lambda_), zeta) : -Infinity;
}

/** @type {(way: Way, inside: number, outside: number) => number} where a way leaves the cycle */
export function endAlong(way, inside, outside) {
  return zeroBetween((log) => marginOf(way(log)), inside, outside);
}

/**
 * Where a length has a size [m]. It is larger at `from`; without `to` that is looked for, `step` by
 * step, each twice the last.
 * @type {(length: (log: number) => number, size: number, from: number, to: number, step?: number) => number}
 */
export function sizeAlong(length, size, from, to, step = 1) {
  // In ln of both, where they are nearly linear.
  const excess = (/** @type {number} */ log) => Math.log(length(log) / size);
  let end = to;
  if (Number.isNaN(end)) {
    end = from + step;
    while (excess(end) > 0 && Math.abs(end - from) < FURTHEST) end += end - from;
  }
  return zeroBetween(excess, from, end);
}

/** @type {(way: Way, beyond: number) => (log: number) => number} the jump, or `beyond` without cycle */
export function jumpOn(way, beyond) {
  return (log) => {
    const { exists, delta_x } = steadyCycle(way(log));
    return exists ? delta_x : beyond;
  };
}
