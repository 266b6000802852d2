/** The steady cycle under a friction curve, and its slip as a function of the time since break-away. */

import { arcState, courseOf } from "./arc.js";
import { chainOf, contactOf, follow } from "./chain.js";
import { periodOf } from "./cycle.js";
import { numbersOf } from "./friction.js";
import { risingZero } from "./root.js";

/** A turn that repeats the last one to this part repeats it for ever. */
const SAME_TURN = 1e-13;
/** After so many arcs a slip without end repeats its last turn. */
const MOST_FOLLOWED = 3000;

/** @type {(p: Setting, curve: Curve) => {cycle: Cycle, slip: Slip}} its slip may be without end */
export function slipOnCurve(p, curve) {
  const contact = contactOf(p, curve);
  const { v } = p;
  const { rests, spring_drop, peak, peakAt, t_slip, arcs } = chainOf(contact, v);
  const numbers = numbersOf({ ...p, mu_k: curve[0][1] });
  const period = periodOf(spring_drop / v, rests ? t_slip : NaN);
  const playing = played(contact, arcs, v, rests);
  // The spring is longest when the mass first has the speed of the pull.
  /** @type {(tau: number) => [number, number]} */
  const lead = (tau) => {
    const { x_dot, x_ddot } = playing.at(tau);
    return [x_dot - v, x_ddot];
  };
  const longest = peak > v ? risingZero(lead, 0, peakAt, 0.5 * peakAt) : NaN;
  const here = contact.bands.find(({ high }) => v < high)?.oscillator ?? contact.bands[0].oscillator;
  const slow = Math.max(here.slow, 0);
  return {
    cycle: {
      ...numbers,
      ...period,
      exists: rests,
      spring_drop,
      delta_x: v * period.T,
      x_dot_peak: rests ? peak : NaN,
    },
    slip: {
      ...playing,
      overshoot: peak > v ? { tau: longest, growth: playing.at(longest).growth } : null,
      rate: Math.max(...contact.bands.map(({ oscillator }) => rateOf(oscillator))),
      fast: slow,
      slow,
      scale: Math.max((2 * Math.PI) / numbers.w, here.overdamped && slow > 0 ? 3 / slow : 0),
    },
  };
}

/** @type {(oscillator: Oscillator) => number} of the fastest change [rad/s] */
function rateOf({ w, slow, fast }) {
  return Math.max(w, Math.abs(slow), Math.abs(fast));
}

/**
 * What plays the first arcs of a slip, which are all if it rests; those of a slip without end are
 * made when they are asked for.
 * @type {(contact: Contact, arcs: Arc[], v: number, rests: boolean) =>
 *   Required<Pick<Slip, "at" | "pieces" | "settles">>}
 */
function played(contact, arcs, v, rests) {
  let latest = 0;
  /** @type {{start: number, length: number} | null} the turn that is repeated, times [s] */
  let turn = null;

  /** Make another arc, if there is one. */
  function more() {
    const last = arcs[arcs.length - 1];
    if (rests || turn || last.end === Infinity) return false;
    const next = follow(contact, last, courseOf(last, v), v);
    const same = SAME_TURN * (arcs.length < MOST_FOLLOWED ? Math.abs(next.x_ddot) : Infinity);
    for (let n = arcs.length - 1; n >= 0; n--) {
      const { start, x_dot, mode, x_ddot } = arcs[n];
      if (x_dot !== next.x_dot || mode !== next.mode || x_ddot * next.x_ddot < 0) continue;
      if (!(Math.abs(x_ddot - next.x_ddot) <= same)) break;
      turn = { start, length: next.start - start };
      return false;
    }
    next.end = next.start + courseOf(next, v).tau;
    arcs.push(next);
    return true;
  }

  /** @type {(tau: number) => {arc: Arc, shift: number}} the arc at a time, and how much later it is */
  function find(tau) {
    let another = true;
    while (another && tau >= arcs[arcs.length - 1].end) another = more();
    let shift = 0;
    if (turn && tau >= arcs[arcs.length - 1].end) {
      shift = Math.floor((tau - turn.start) / turn.length) * turn.length;
    }
    if (tau - shift < arcs[latest].start) latest = 0;
    while (latest < arcs.length - 1 && tau - shift >= arcs[latest].end) latest += 1;
    return { arc: arcs[latest], shift };
  }

  return {
    at(tau) {
      const { arc, shift } = find(tau);
      const state = arcState(arc, v, tau - shift - arc.start);
      return { ...state, displacement: state.displacement + v * shift, mode: arc.mode };
    },
    *pieces(from, to) {
      for (let begin = from; begin < to; ) {
        const { arc, shift } = find(begin);
        // Of the slip of a cycle the last arc holds on.
        const end = rests && latest === arcs.length - 1 ? to : Math.min(arc.end + shift, to);
        const { fast, slow } = arc.band.oscillator;
        const turns = end < to && find(end).arc.x_dot === 0;
        yield { start: arc.start + shift, end, rate: rateOf(arc.band.oscillator), fast, slow, turns };
        // Rounding must not find the same arc again.
        begin = Math.max(end, begin + 2 ** -51 * begin);
      }
    },
    settles() {
      for (let another = !rests; another; ) another = more();
      return !rests && !turn;
    },
  };
}
