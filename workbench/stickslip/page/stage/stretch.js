/** The stretch of time that the charts show, and the length of way that the stage shows. */

/** @import { Motion } from "../model/motion.js" */

/** @typedef {ReturnType<typeof makeStretch>} Stretch */

/** Cycles of the whole picture; while a slider moves, it may come to hold these fewest or most. */
const CYCLES = 6;
const FEWEST = 2.5;
const MOST = 15;
/** Decays of a slip without end that are seen, in at most so many of its swings. */
const DECAYS = 4;
const SWINGS_SEEN = 40;
/** Cycles in the longest stretch. */
const MOST_ZOOMED_OUT = 200;
/** The shortest stretch, as a part of a swing. */
const LEAST_ZOOMED_IN = 1e-5;

/**
 * Keep the stretch of time: the whole picture, until a person chooses another.
 *
 * @returns from, to [s], span; way(motion): the length that the stage shows [m]; fit(motion, ghost)
 *   after a new setting; choose(from, to), zoom(factor, at), move(share), reset(), fromStart(),
 *   release(from)
 */
export function makeStretch() {
  /** @type {Motion} */
  let motion = null;
  let from = 0;
  let to = 1;
  /** @type {"cycles" | "start" | "chosen"} */
  let kind = "cycles";
  // Whether the next setting chooses the span, or keeps it as long as it can.
  let free = true;

  /** @type {(span: number) => void} */
  const lay = (span) => {
    from = kind === "start" ? 0 : cyclesBegin(motion);
    to = from + span + (kind === "start" ? Math.min(motion.first, MOST * motion.beat) : 0);
    // A first load-up of many cycles would leave them no room.
    if (kind === "start") to = Math.max(to, motion.first + 0.5 * span);
  };

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
    kind = "chosen";
  }

  function reset() {
    kind = "cycles";
    lay(usual(motion));
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
    /** The length of way that the stage shows: that of the charts, for some cycles at a time. */
    get way() {
      const stride = motion.cycle.exists ? motion.cycle.delta_x : motion.p.v * motion.beat;
      const cycles = (to - from) / motion.beat;
      return stride * Math.min(Math.max(cycles, FEWEST), MOST);
    },
    /**
     * @param {Motion} next
     * @param {Motion | null} ghost that is shown beside it
     */
    fit(next, ghost) {
      const span = to - from;
      motion = next;
      if (kind === "chosen" && to <= latest(from)) return;
      if (kind === "chosen") kind = "cycles";
      const cycles = span / motion.beat;
      if (free) {
        // Of both curves some cycles are seen, unless one is much slower than the other.
        const beats = [motion.beat, ghost?.beat ?? 0].filter((beat) => beat <= 3 * motion.beat);
        lay(Math.max(usual(motion), CYCLES * Math.max(...beats)));
      } else if (kind === "cycles" && cycles >= FEWEST && cycles <= MOST) lay(span);
      else lay(usual(motion));
      free = false;
    },
    /**
     * Let the next setting choose the picture.
     *
     * @param {"cycles" | "start"} [wanted]
     */
    release(wanted = "cycles") {
      kind = wanted;
      free = true;
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
    fromStart() {
      kind = "start";
      lay(usual(motion));
    },
  };
}

/**
 * The span of the whole picture: some cycles, or till a slip without end has settled.
 *
 * @param {Motion} motion
 * @returns {number} [s]
 */
function usual({ cycle, beat, slip }) {
  if (cycle.exists) return CYCLES * beat;
  return Math.min(Math.max(CYCLES * beat, DECAYS / slip.slow), SWINGS_SEEN * beat);
}

/**
 * When the steady cycles begin: at the end of the first slip, or where none ends, at a break-away
 * that leaves the load-up in sight.
 *
 * @param {Motion} motion
 * @returns {number} [s]
 */
export function cyclesBegin({ cycle, first, beat }) {
  return cycle.exists ? first + cycle.t_slip : Math.max(first - beat, 0);
}
