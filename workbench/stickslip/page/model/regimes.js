/**
 * At which speeds of the pull it sticks, swings or slides evenly under a friction curve, with exact
 * ends: where steady sliding loses its stability, which are points of the curve, and where the slip
 * from break-away just touches standstill.
 */

import { chainOf, contactOf } from "./chain.js";
import { zeroBetween } from "./root.js";

/** Between coarse samples a range can hide where the margin is this small [1]. */
const NEAR = 0.3;
const FINER = 6;

/** @type {(contact: Contact, v: number) => Pick<Regime, "sticks" | "even">} at one speed [m/s] */
function regimeAt(contact, v) {
  const near = contact.bands.filter(({ low, high }) => v >= low && v <= high);
  const even = near.every(({ oscillator }) => oscillator.a >= 0);
  return { sticks: chainOf(contact, v).margin <= 0, even };
}

/**
 * The answers from one speed to another [m/s], by rising speed and without gaps; `step` is the part
 * of the speed between two samples.
 * @type {(p: Setting, curve: Curve, low: number, high: number, step: number) => Regime[]}
 */
export function regimesOf(p, curve, low, high, step) {
  const contact = contactOf(p, curve);
  const knots = contact.bands
    .filter(({ oscillator }, n) => n && oscillator.a >= 0 !== contact.bands[n - 1].oscillator.a >= 0)
    .map((band) => band.low);
  const ends = [...stickEnds(contact, low, high, step), ...knots]
    .filter((v) => v > low && v < high)
    .sort((a, b) => a - b);
  /** @type {Regime[]} */
  const regimes = [];
  [low, ...ends].forEach((from, n) => {
    const to = ends[n] ?? high;
    const last = regimes[regimes.length - 1];
    const { sticks, even } = regimeAt(contact, Math.sqrt(from) * Math.sqrt(to));
    if (last?.sticks === sticks && last.even === even) last.high = to;
    else regimes.push({ low: from, high: to, sticks, even });
  });
  return regimes;
}

/**
 * The speeds [m/s] at which a slip from break-away begins or ceases to come to rest.
 * @type {(contact: Contact, low: number, high: number, step: number) => number[]}
 */
function stickEnds(contact, low, high, step) {
  const count = Math.ceil(Math.log(high / low) / step);
  /** @type {(n: number) => [v: number, margin: number]} */
  const sample = (n) => {
    const v = low * (high / low) ** (n / count);
    return [v, chainOf(contact, v).margin];
  };
  /** @type {number[]} */
  const found = [];
  /** @type {(a: [number, number], b: [number, number]) => void} */
  const between = (a, b) => {
    if (a[1] > 0 === b[1] > 0) return;
    found.push(zeroBetween((v) => chainOf(contact, v).margin, a[0], b[0], a[1], b[1]));
  };
  let [before, here] = [sample(0), sample(0)];
  for (let n = 1; n <= count; n++) {
    const next = sample(n);
    const turns = Math.abs(here[1]) < Math.min(NEAR, Math.abs(before[1]), Math.abs(next[1]));
    // What touches 0 between two samples shows as a least margin.
    if (turns && before[1] > 0 === here[1] > 0 && here[1] > 0 === next[1] > 0) {
      let last = before;
      for (let part = 1 - FINER; part <= FINER; part++) {
        const finer = sample(n - 1 + part / FINER);
        between(last, finer);
        last = finer;
      }
    } else between(here, next);
    [before, here] = [here, next];
  }
  return found;
}
