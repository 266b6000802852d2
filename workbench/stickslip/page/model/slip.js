/** The steady cycle of a setting, and its slip as a function of the time since break-away. */

import { arcState, courseOf } from "./arc.js";
import { chainOf, contactOf, follow } from "./chain.js";
import { cycleOf, steadyCycle } from "./cycle.js";
import { zeroBetween } from "./root.js";

/** A turn that repeats the last one to this part repeats it for ever. */
const SAME_TURN = 1e-13;
/** After so many arcs a slip without end repeats its last turn. */
const MOST_FOLLOWED = 3000;

/**
 * Of a setting whose mu_k is that of the curve's first point; the slip may be without end. A curve of
 * one point is constant friction, whose cycle has a closed form.
 * @type {(p: Setting, curve: Curve) => {cycle: Cycle, slip: Slip}}
 */
export function slipOf(p, curve) {
  const contact = contactOf(p, curve);
  const { v } = p;
  const { rests, spring_drop, peak, peakAt, t_slip, arcs } = chainOf(contact, v);
  const isConstant = curve.length === 1;
  const playing = played(contact, isConstant ? arcs.slice(0, 1) : arcs, v, isConstant || rests);
  // The spring is longest when the mass first has the speed of the pull.
  const longest = peak > v ? zeroBetween((tau) => playing.at(tau).x_dot - v, 0, peakAt) : NaN;
  const here = contact.bands.find(({ high }) => v < high)?.oscillator ?? contact.bands[0].oscillator;
  const slow = Math.max(here.slow, 0);
  return {
    cycle: isConstant ? steadyCycle(p) : cycleOf(p, spring_drop / v, t_slip, rests ? peak : NaN),
    slip: {
      ...playing,
      overshoot: peak > v ? { tau: longest, growth: playing.at(longest).growth } : null,
      rate: Math.max(...contact.bands.map(({ oscillator }) => rateOf(oscillator))),
      slow,
      // A swing, or where the slow decay outlasts it, three times that.
      scale: Math.max((2 * Math.PI) / contact.w, here.overdamped && slow > 0 ? 3 / slow : 0),
    },
  };
}

/** @type {(oscillator: Oscillator) => number} of the fastest change [rad/s] */
function rateOf({ w, slow, fast }) {
  return Math.max(w, Math.abs(slow), Math.abs(fast));
}

/**
 * What plays the first arcs of a slip; where they are not the whole of it, further ones are made
 * when they are asked for, and else the last one holds on.
 * @type {(contact: Contact, arcs: Arc[], v: number, isWhole: boolean) =>
 *   Pick<Slip, "at" | "pieces" | "settles">}
 */
function played(contact, arcs, v, isWhole) {
  let latest = 0;
  /** @type {{start: number, length: number} | null} the turn that is repeated, times [s] */
  let turn = null;

  /** Make another arc, if there is one. */
  function more() {
    const last = arcs[arcs.length - 1];
    if (isWhole || turn || last.end === Infinity) return false;
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
        const holds = isWhole && latest === arcs.length - 1;
        const end = holds ? to : Math.min(arc.end + shift, to);
        const turns = end < to && find(end).arc.x_dot === 0;
        const { oscillator } = arc.band;
        yield { ...oscillator, start: arc.start + shift, end, rate: rateOf(oscillator), turns };
        // Rounding must not find the same arc again.
        begin = Math.max(end, begin + 2 ** -51 * begin);
      }
    },
    settles() {
      while (more());
      return !turn;
    },
  };
}
