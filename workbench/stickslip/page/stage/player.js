/** The cursor's time: it plays, is scrubbed, or follows the pointer. */

import { byId, on, setText } from "../view/dom.js";

/** How long the view takes to play, where no speed is chosen [s]. */
const VIEW = 10;
const SCRUB_STEPS = 1000;
/** After a pause of the browser the motion goes on where it was [s]. */
const LONGEST_BREAK = 0.1;

/**
 * Bring play, scrub and speed to life: show(t) is called with the time of the cursor [s], and tell(t)
 * gives its numbers in words, for who cannot see them.
 *
 * @param {Stretch} stretch
 * @returns refresh(): after another stretch or setting; point(t): follow the pointer, or null: let go;
 *   play(); rewind()
 */
export function makePlayer(stretch, show, tell) {
  const button = byId("play");
  const scrub = byId("scrub");
  const speed = byId("speed");
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
    if (!playing) scrub.setAttribute("aria-valuetext", tell(now()));
    show(now());
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
    refresh,
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
