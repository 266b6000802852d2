/**
 * At which speeds of the pull it sticks, swings or slides evenly under a friction curve, with exact
 * ends: where steady sliding loses its stability, which are points of the curve, and where the slip
 * from break-away just touches standstill.
 */

import { zerosAlong } from "./along.js";
import { chainOf, contactOf } from "./chain.js";


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
  const margin = (/** @type {number} */ log) => chainOf(contact, Math.exp(log)).margin;
  const stickEnds = zerosAlong(margin, Math.log(low), Math.log(high), step).map(Math.exp);
  const ends = [...stickEnds, ...knots]
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
