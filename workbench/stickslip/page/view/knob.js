/** A round handle on a chart, which a pointer drags and the arrow keys move. */

import { on, put } from "./dom.js";
import { px } from "./frame.js";

const ARROWS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * Bring a knob to life; it does not jump to the pointer that takes it. place(): where it is [px];
 * move(x, y): it is wanted there [px]; step(right, up): so many steps of an arrow key, with Shift
 * `more`; keys: what other keys do; drop(): it is let go.
 *
 * @returns isHeld(); put(x, y, now, ends, words): at a place [px], with its value, least and most,
 *   and words for who cannot see it
 */
export function makeKnob(knob, { place, move, step, more, keys, drop }) {
  /** @type {number[] | null} from the knob to the pointer [px] */
  let grip = null;
  on(knob, "pointerdown", ({ clientX, clientY, pointerId }) => {
    const [x, y] = place();
    grip = [clientX - x, clientY - y];
    knob.setPointerCapture(pointerId);
  });
  on(knob, "pointermove", ({ clientX, clientY }) => {
    if (grip) move(clientX - grip[0], clientY - grip[1]);
  });
  on(knob, "lostpointercapture", () => {
    grip = null;
    drop();
  });
  on(knob, "keydown", (event) => {
    const [right, up] = ARROWS[event.key] ?? [];
    const count = event.shiftKey ? more : 1;
    const act = right === undefined ? keys[event.key] : () => step(right * count, up * count);
    if (!act) return;
    event.preventDefault();
    act();
  });
  return {
    isHeld: () => grip !== null,
    /** @type {(x: number, y: number, now: number, ends: number[], words: string) => void} */
    put(x, y, now, [least, most], words) {
      knob.style.transform = `translate(${px(x)}px, ${px(y)}px)`;
      const range = { "aria-valuenow": now, "aria-valuemin": least, "aria-valuemax": most };
      put(knob, { ...range, "aria-valuetext": words });
    },
  };
}
