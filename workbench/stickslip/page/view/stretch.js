/** The stretch of time that the charts show. */

const USUAL = 10;
const FEWEST = 2;
const MOST = 40;
const MOST_ZOOMED_OUT = 200;
const LEAST_ZOOMED_IN = 1e-5;

/**
 * Keep the stretch of time: the whole picture, until a person chooses another.
 *
 * @returns {object} from, to [s], span, whole (whether it is the picture's own choice);
 *   fit(motion) after a new setting; choose(from, to), zoom(factor, at), move(share), reset(),
 *   release()
 */
export function makeStretch() {
  let motion = null;
  let from = 0;
  let to = USUAL;
  let whole = true;

  /** A cycle, or where there is none a swing or a decay of the slip. */
  const period = () => beat(motion);

  function reset() {
    whole = true;
    ({ from, to } = wholePicture(motion));
  }

  function choose(start, end) {
    const longest = motion.first + MOST_ZOOMED_OUT * period();
    const shortest = Math.max(LEAST_ZOOMED_IN * motion.slip.scale, 1e-9 * end);
    const span = Math.min(Math.max(end - start, shortest), longest);
    // What is too short or too long is set right about its middle.
    const middle = 0.5 * (start + end);
    from = Math.max(middle - 0.5 * span, 0);
    to = from + span;
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
    get whole() {
      return whole;
    },
    fit(next) {
      motion = next;
      if (whole || to - from > motion.first + MOST_ZOOMED_OUT * period()) reset();
    },
    /** Let the next setting choose the whole picture. */
    release() {
      whole = true;
    },
    choose,
    zoom(factor, at = 0.5 * (from + to)) {
      choose(at - (at - from) * factor, at + (to - at) * factor);
    },
    move(share) {
      const step = Math.max(share * (to - from), -from);
      choose(from + step, to + step);
    },
    reset,
  };
}

function beat({ cycle, slip }) {
  return cycle.exists ? cycle.T : slip.scale;
}

/** Ten seconds, or where a cycle is much shorter or longer, the first load-up and some cycles. */
function wholePicture(motion) {
  const { first } = motion;
  const period = beat(motion);
  const cycles = (USUAL - first) / period;
  if (cycles >= FEWEST && cycles <= MOST) return { from: 0, to: USUAL };
  const count = cycles > MOST ? 12 : 4;
  const from = first > 6 * period ? first - period : 0;
  return { from, to: first + count * period };
}
