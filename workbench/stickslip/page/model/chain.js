/**
 * A slip under a friction curve: from break-away over the lines of the curve, and back where the
 * spring reverses it, until the mass rests; or without end. docs/theory.md (4), (5).
 *
 * In the plane of speed and acceleration the slip is a curve that cannot cross itself. It begins at
 * standstill with the least force that begins one, so if its speed turns before it has fallen to 0
 * it spirals inwards and never rests; and a slip back that ends beyond F_s spirals outwards and
 * never rests either. So the first turns decide.
 */

import { arcState, courseOf } from "./arc.js";
import { bandsOf, numbersOf } from "./friction.js";

/** Rounding of a difference of forces, in parts of them. */
const FORCE_SLACK = 2 ** -49;
/** A shorter stick is none, in units of 1/w. */
const LEAST_STICK = 1e-12;
const MOST_ARCS = 1000;

/** @type {(p: Setting, curve: Curve) => Contact} whatever v is */
export function contactOf(p, curve) {
  const numbers = numbersOf({ ...p, mu_k: curve[0][1] });
  return { ...p, ...numbers, bands: bandsOf(p, curve), first: numbers.w ** 2 * numbers.Delta };
}

/** @type {(contact: Contact, v: number) => Chain} the slip at a speed of the pull above 0 [m/s] */
export function chainOf(contact, v) {
  const never = { t_slip: NaN, spring_drop: NaN, peak: NaN, peakAt: NaN };
  /** @type {Chain} */
  const chain = { ...never, arcs: [], rests: false, margin: 1 };
  const rest = { displacement: 0, growth: 0, x_dot: 0, x_ddot: contact.first };
  let arc = arcAt(contact, 0, 1, 0, rest);
  while (chain.arcs.length < MOST_ARCS) {
    const course = courseOf(arc, v);
    arc.end = arc.start + course.tau;
    chain.arcs.push(arc);
    if (course.highestAt >= 0 && Number.isNaN(chain.peak)) {
      [chain.peak, chain.peakAt] = [course.highest, arc.start + course.highestAt];
    }
    const isForward = arc.mode > 0;
    const turns = isForward && course.lowest > 0;
    if (turns) chain.margin = course.lowest / v;
    if (turns || course.tau === Infinity) return chain;
    const next = follow(contact, arc, course, v);
    if (next.x_dot === 0) {
      const excess = Math.abs(contact.F_s + contact.k * next.growth) / contact.F_s - 1;
      chain.margin = isForward ? -depthOf(arc, v) : excess;
      if (!(excess > FORCE_SLACK)) {
        chain.rests = -next.growth * contact.w > LEAST_STICK * v;
        if (chain.rests) [chain.t_slip, chain.spring_drop] = [next.start, -next.growth];
        else chain.margin = 1;
        return chain;
      }
      if (!isForward) return chain;
    }
    arc = next;
  }
  return chain;
}

/**
 * What follows an arc that has an end; from standstill a slip the way that the spring pulls.
 * @type {(contact: Contact, arc: Arc, course: Course, v: number) => Arc}
 */
export function follow(contact, arc, { tau, rising }, v) {
  const { band, index, mode } = arc;
  const state = arcState(arc, v, tau);
  const start = arc.start + tau;
  const outward = rising === mode > 0;
  if (!outward && index === 0) {
    const force = contact.F_s + contact.k * state.growth;
    const isFree = Math.abs(force) > contact.F_s * (1 + FORCE_SLACK);
    const s = isFree && force < 0 ? -1 : 1;
    const x_ddot = isFree ? (force - s * contact.F_k) / contact.m : contact.first;
    return arcAt(contact, 0, s, start, { ...state, x_dot: 0, x_ddot });
  }
  const x_dot = mode * (outward ? band.high : band.low);
  // Rounding must not turn it; where the acceleration is 0 its rate decides.
  const x_ddot = (rising ? Math.max(state.x_ddot, 0) : Math.min(state.x_ddot, 0)) + 0;
  const crosses = x_ddot !== 0 || v > x_dot === rising;
  const step = crosses ? (outward ? 1 : -1) : 0;
  return arcAt(contact, index + step, mode, start, { ...state, x_dot, x_ddot });
}

/**
 * How far below 0 the speed of an arc would go on its line, over that of the pull [1], at most 1.
 * @type {(arc: Arc, v: number) => number}
 */
function depthOf(arc, v) {
  const { lowest } = courseOf({ ...arc, band: { ...arc.band, low: -Infinity } }, v);
  return lowest < 0 ? Math.min(-lowest / v, 1) : 1;
}

/**
 * The arc on the band `index` that begins with a state, at a time [s].
 * @type {(contact: Contact, index: number, mode: number, start: number, state: SlipState) => Arc}
 */
function arcAt({ bands }, index, mode, start, state) {
  return { band: bands[index], index, start, end: Infinity, ...state, mode };
}
