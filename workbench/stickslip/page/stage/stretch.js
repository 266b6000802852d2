/** The stretch of time that the charts show. */

/** @import { Motion } from "../model/motion.js" */

/** @typedef {ReturnType<typeof makeStretch>} Stretch */

/** The whole picture is this long, if the cycles in it are not fewer or more than these [s]. */
const USUAL = 10;
const FEWEST = 2;
const MOST = 40;
/** Cycles in the longest stretch. */
const MOST_ZOOMED_OUT = 200;
/** The shortest stretch, as a part of a swing. */
const LEAST_ZOOMED_IN = 1e-5;

/**
 * Keep the stretch of time: the whole picture, until a person chooses another.
 *
 * @returns from, to [s], span; fit(motion) after a new setting; choose(from, to),
 *   zoom(factor, at), move(share), reset(), release()
 */
export function makeStretch() {
  /** @type {Motion} */
  let motion = null;
  let from = 0;
  let to = USUAL;
  let whole = true;

  function reset() {
    whole = true;
    ({ from, to } = wholePicture(motion));
  }

  /**
   * The latest end of a stretch that begins at a time: cycles count, the load-up does not.
   *
   * @type {(start: number) => number} [s]
   */
  const latest = (start) => Math.max(start, motion.first) + MOST_ZOOMED_OUT * motion.beat;

  /** @type {(...ends: number[]) => void} start and end [s] */
  function choose(start, end) {
    const shortest = Math.max(LEAST_ZOOMED_IN * motion.slip.scale, 1e-9 * end);
    const span = Math.max(end - start, shortest);
    // What is too short is set right about its middle.
    from = Math.max(0.5 * (start + end) - 0.5 * span, 0);
    to = Math.min(from + span, latest(from));
    whole = false;
  }

  return {
    get from() {
      return from;
    },
    get to() {
      return to;
    },
    get span() {
      return to - from;
    },
    /** @param {Motion} next */
    fit(next) {
      motion = next;
      if (whole || to > latest(from)) reset();
    },
    /** Let the next setting choose the whole picture. */
    release() {
      whole = true;
    },
    choose,
    /**
     * @param {number} factor by which the stretch grows [1]
     * @param {number} [at] what stays in place [s]
     */
    zoom(factor, at = 0.5 * (from + to)) {
      choose(at - (at - from) * factor, at + (to - at) * factor);
    },
    /** @param {number} share of the stretch [1] */
    move(share) {
      const step = Math.max(share * (to - from), -from);
      choose(from + step, to + step);
    },
    reset,
  };
}

/**
 * Ten seconds, or where a cycle is much shorter or longer, the first load-up and some cycles.
 *
 * @param {Motion} motion
 * @returns {{from: number, to: number}} [s]
 */
function wholePicture(motion) {
  const { first, beat } = motion;
  const cycles = (USUAL - first) / beat;
  if (cycles >= FEWEST && cycles <= MOST) return { from: 0, to: USUAL };
  const count = cycles > MOST ? 12 : 4;
  // A load-up of many cycles would leave them no room.
  const from = first > 6 * beat ? first - beat : 0;
  return { from, to: first + count * beat };
}
