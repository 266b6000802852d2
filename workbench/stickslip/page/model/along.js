/** One solver for cures and maps: on a way through the settings, where the cycle ends or halves. */

import { logDepth } from "./critical.js";
import { plainPeriod } from "./cycle.js";
import { zeroBetween } from "./root.js";

/** Logarithms of a factor beyond which nothing is searched. */
const FURTHEST = 700;

/** @type {(lambda_: number, zeta: number) => number} the cycle exists where it is 0 or more */
export function plainDepth(lambda_, zeta) {
  return zeta < 1 ? logDepth(Math.log(lambda_), zeta)[0] : -Infinity;
}

/** @type {(way: Way, inside: number, outside: number) => number} where a way leaves the cycle */
export function endAlong(way, inside, outside) {
  return zeroBetween(
    (log) => {
      const [lambda_, zeta] = way(log);
      return plainDepth(lambda_, zeta);
    },
    inside,
    outside,
  );
}

/**
 * Where the jump on a way has a size [m]. It is larger at `from`; without `to` that is looked for,
 * `step` by step, each twice the last. Where there is no cycle the jump counts as `beyond` [m].
 * @type {(way: Way, size: number, beyond: number, from: number, to: number, step?: number) => number}
 */
export function jumpAlong(way, size, beyond, from, to, step = 1) {
  // In ln of both, where they are nearly linear.
  const excess = (/** @type {number} */ log) => {
    const [lambda_, zeta, unit] = way(log);
    const jump = unit * plainPeriod(lambda_, zeta);
    return Math.log((Number.isNaN(jump) ? beyond : jump) / size);
  };
  let end = to;
  if (Number.isNaN(end)) {
    end = from + step;
    while (excess(end) > 0 && Math.abs(end - from) < FURTHEST) end += end - from;
  }
  return zeroBetween(excess, from, end);
}
