/** The cursor: its time, which plays, is scrubbed or follows the pointer, and the numbers there. */

import { byId, on, setText } from "../view/dom.js";
import { fixed, scaleFor } from "../view/units.js";

/** How long the view takes to play, where no speed is chosen [s]. */
const VIEW = 10;
const SCRUB_STEPS = 1000;
/** After a pause of the browser the motion goes on where it was [s]. */
const LONGEST_BREAK = 0.1;

/**
 * Bring play, scrub and speed to life; what is to be marked shows a state by mark(state).
 *
 * @param {Stretch} stretch
 * @param {{mark: (state: State) => void}[]} marked
 * @returns show(motion): after another stretch or setting; point(t): follow the pointer, or null: let
 *   go; play(); rewind()
 */
export function makePlayer(stretch, marked) {
  const button = byId("play");
  const scrub = byId("scrub");
  const speed = byId("speed");
  const [atTime, ofX, ofF, ofZ] = ["now", "x-now", "F-now", "z-now"].map(byId);
  /** @type {Motion} */
  let motion = null;
  /** @type {Partial<Record<"t" | "x" | "x_dot" | "z" | "F", Scale & {decimals: number}>>} */
  let scales = {};
  // Where cursor and pointer are in what is seen, from 0 to 1: both stay there when that changes.
  let share = 0;
  /** @type {number | null} */
  let pointed = null;
  let playing = false;
  let last = 0;
  let frame = 0;

  const now = () => stretch.from + (pointed ?? share) * stretch.span();

  function refresh() {
    scrub.value = Math.round(share * SCRUB_STEPS);
    const state = motion.at(now());
    for (const drawing of marked) drawing.mark(state);
    const word = state.mode === 0 ? "sticks" : "slips";
    const [t, x, x_dot, z, F] = Object.keys(scales).map((name) => fixed(state[name], scales[name]));
    const pull = fixed(state.x_pull, scales.x);
    setText(atTime, `${t}, ${word}`);
    setText(ofX, `x ${x}, pulled end ${pull}`);
    setText(ofF, `F ${F}`);
    setText(ofZ, `ẋ ${x_dot}, z ${z}`);
    if (playing) return;
    // For who cannot see it.
    const told = `mass at ${x}, pulled end at ${pull}, spring force ${F}, velocity ${x_dot}`;
    scrub.setAttribute("aria-valuetext", `${t}: ${word}, ${told}`);
  }

  function step(stamp) {
    if (!playing) return;
    // The stamp of a frame may lie before the moment at which it was asked for.
    const passed = Math.min(Math.max(stamp - last, 0) / 1000, LONGEST_BREAK);
    last = stamp;
    if (pointed === null) {
      const rate = speed.value === "view" ? 1 / VIEW : Number(speed.value) / stretch.span();
      share = (share + rate * passed) % 1;
      refresh();
    }
    frame = requestAnimationFrame(step);
  }

  function setPlaying(wanted) {
    if (playing === wanted) return;
    playing = wanted;
    setText(button, playing ? "Pause" : "Play");
    // The time alone is enough while it runs.
    scrub.removeAttribute("aria-valuetext");
    if (!playing) refresh();
    last = performance.now();
    // Stopped and started within one frame, it still runs once.
    cancelAnimationFrame(frame);
    if (playing) frame = requestAnimationFrame(step);
  }

  on(button, "click", () => setPlaying(!playing));
  on(scrub, "input", () => {
    const chosen = Number(scrub.value) / SCRUB_STEPS;
    setPlaying(false);
    share = chosen;
    refresh();
  });

  return {
    show(next) {
      motion = next;
      const { cycle, numbers, slip, p, z_s } = motion;
      const { to } = stretch;
      // Without friction the spring is as long as its swing.
      const longest = Math.max(z_s + (slip.overshoot?.growth ?? 0), p.v / numbers.w);
      // While the cursor moves, units and decimals stand still.
      scales = {
        t: rangeOf(to, "time", stretch.span()),
        x: rangeOf(p.v * to, "length", p.v * stretch.span()),
        x_dot: rangeOf(cycle.exists ? cycle.x_dot_peak : p.v, "velocity"),
        z: rangeOf(longest, "length"),
        F: rangeOf(p.k * longest, "force"),
      };
      refresh();
    },
    point(t) {
      pointed = t === null ? null : (t - stretch.from) / stretch.span();
      if (!playing) share = pointed ?? share;
      refresh();
    },
    play: () => setPlaying(true),
    rewind() {
      share = 0;
      refresh();
    },
  };
}

/** A unit for values up to `largest`, and decimals for differences of a thousandth of `range` [SI]. */
function rangeOf(largest, kind, range = largest) {
  const scale = scaleFor(largest, kind);
  const decimals = Math.ceil(3 - Math.log10(range / scale.size));
  return { ...scale, decimals: Math.min(Math.max(decimals, 0), 15) };
}
