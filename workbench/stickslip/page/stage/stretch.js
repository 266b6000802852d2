/** The stretch of time that the charts show, and the length of way that the stage shows. */

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
 * Keep the stretch of time [s]: the whole picture, until a person chooses another.
 * @param {() => void} changed called when one is chosen
 */
export function makeStretch(changed) {
  /** @type {Motion} */
  let motion = null;
  /** @type {"cycles" | "start" | "chosen"} */
  let kind = "cycles";
  // Whether the next setting chooses the span, or keeps it as long as it can.
  let free = true;

  /** @type {(span: number) => void} */
  const lay = (span) => {
    const isStart = kind === "start";
    stretch.from = isStart ? 0 : cyclesBegin(motion);
    stretch.to = stretch.from + span + (isStart ? Math.min(motion.first, MOST * motion.beat) : 0);
    // A first load-up of many cycles would leave them no room.
    if (isStart) stretch.to = Math.max(stretch.to, motion.first + 0.5 * span);
  };

  /** @type {(start: number) => number} the latest end [s]: cycles count, the load-up does not */
  const latest = (start) => Math.max(start, motion.first) + MOST_ZOOMED_OUT * motion.beat;

  /** @type {(wanted: "cycles" | "start") => void} */
  function showWhole(wanted) {
    kind = wanted;
    lay(usual(motion));
    changed();
  }

  const stretch = {
    from: 0,
    to: 1,
    span: () => stretch.to - stretch.from,
    /** The length of way [m] that the stage shows: that of the charts, for some cycles at a time. */
    way() {
      const stride = motion.cycle.exists ? motion.cycle.delta_x : motion.p.v * motion.beat;
      return stride * Math.min(Math.max(stretch.span() / motion.beat, FEWEST), MOST);
    },
    /** @type {(next: Motion, ghost: Motion | null) => void} another setting, and its ghost beside it */
    fit(next, ghost) {
      const span = stretch.span();
      motion = next;
      if (kind === "chosen" && stretch.to <= latest(stretch.from)) return;
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
    /** The next setting chooses the picture. */
    release(wanted = /** @type {"cycles" | "start"} */ ("cycles")) {
      kind = wanted;
      free = true;
    },
    /** @type {(...ends: number[]) => void} start and end [s] */
    choose(start, end) {
      const shortest = Math.max(LEAST_ZOOMED_IN * motion.slip.scale, 1e-9 * end);
      const span = Math.max(end - start, shortest);
      // What is too short is set right about its middle.
      stretch.from = Math.max(0.5 * (start + end) - 0.5 * span, 0);
      stretch.to = Math.min(stretch.from + span, latest(stretch.from));
      kind = "chosen";
      changed();
    },
    /** @type {(factor: number, at?: number) => void} grow about what stays in place [s] */
    zoom(factor, at = 0.5 * (stretch.from + stretch.to)) {
      stretch.choose(at - (at - stretch.from) * factor, at + (stretch.to - at) * factor);
    },
    /** @param {number} share of the stretch [1] */
    move(share) {
      const step = Math.max(share * stretch.span(), -stretch.from);
      stretch.choose(stretch.from + step, stretch.to + step);
    },
    reset: () => showWhole("cycles"),
    fromStart: () => showWhole("start"),
  };
  return stretch;
}

/**
 * The span of the whole picture [s]: some cycles, or till a slip without end has settled.
 * @type {(motion: Motion) => number}
 */
function usual({ cycle, beat, slip }) {
  if (cycle.exists) return CYCLES * beat;
  return Math.min(Math.max(CYCLES * beat, DECAYS / slip.slow), SWINGS_SEEN * beat);
}

/**
 * When [s] the steady cycles begin: at the end of the first slip, or where none ends, at a
 * break-away that leaves the load-up in sight.
 * @type {(motion: Motion) => number}
 */
export function cyclesBegin({ cycle, first, beat }) {
  return cycle.exists ? first + cycle.t_slip : Math.max(first - beat, 0);
}
