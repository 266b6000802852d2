/** One solver for cures, maps and the bar: zeros along a way through the settings. */

import { logDepth, steadyCycle } from "./cycle.js";
import { numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

/** Logarithms of a factor beyond which nothing is searched. */
const FURTHEST = 700;
/** Between samples two zeros can hide where the function is this small; there it is cut finer. */
const NEAR = 0.3;
const FINER = 6;

/** @type {(p: Setting) => number} the cycle exists where it is 0 or more */
export function marginOf(p) {
  const { lambda_, zeta } = numbersOf(p);
  return zeta < 1 ? logDepth(Math.log(lambda_), zeta) : -Infinity;
}

/** @type {(way: Way, beyond: number, size: number) => (log: number) => number} ln of jump over size [m] */
export function jumpAlong(way, beyond, size) {
  return (log) => {
    const { exists, delta_x } = steadyCycle(way(log));
    return Math.log((exists ? delta_x : beyond) / size);
  };
}

/**
 * The zero of a function that is above 0 at `from`; without `to` that is looked for, `step` by step,
 * each twice the last.
 * @type {(f: (log: number) => number, from: number, to: number, step?: number) => number}
 */
export function zeroFrom(f, from, to, step = 1) {
  let end = to;
  if (Number.isNaN(end)) {
    end = from + step;
    while (f(end) > 0 && Math.abs(end - from) < FURTHEST) end += end - from;
  }
  return zeroBetween(f, from, end);
}

/** @type {(f: (log: number) => number, from: number, to: number, step: number) => number[]} all, in order */
export function zerosAlong(f, from, to, step) {
  const count = Math.ceil(Math.abs(to - from) / step);
  /** @type {(n: number) => [log: number, value: number]} */
  const sample = (n) => {
    const log = from + ((to - from) * n) / count;
    return [log, f(log)];
  };
  /** @type {number[]} */
  const found = [];
  let [before, here] = [sample(0), sample(0)];
  for (let n = 1; n <= count; n++) {
    const next = sample(n);
    const [a, b, c] = [before, here, next].map(([, value]) => Math.abs(value));
    const isAlike = before[1] > 0 === here[1] > 0 && here[1] > 0 === next[1] > 0;
    // What touches 0 between two samples shows as a least value.
    const parts = isAlike && b < Math.min(NEAR, a, c) ? FINER : 1;
    let last = parts > 1 ? before : here;
    for (let part = parts > 1 ? 1 - parts : 1; part <= parts; part++) {
      const finer = part === parts ? next : sample(n - 1 + part / parts);
      if (last[1] > 0 !== finer[1] > 0) {
        found.push(zeroBetween(f, last[0], finer[0], last[1], finer[1]));
      }
      last = finer;
    }
    [before, here] = [here, next];
  }
  return found;
}
