/** A round handle on a chart, which a pointer drags. */

import { on } from "./dom.js";
import { px } from "./frame.js";

/** @type {(knob: HTMLElement, x: number, y: number) => void} put a knob at a place [px] */
export function putKnob(knob, x, y) {
  knob.style.transform = `translate(${px(x)}px, ${px(y)}px)`;
}

/**
 * Let a knob be dragged; it does not jump to the pointer that takes it.
 *
 * @param {HTMLElement} knob
 * @param {() => [x: number, y: number]} place where it is [px]
 * @param {(x: number, y: number) => void} move it is wanted there [px]
 * @param {() => void} drop it is let go
 * @returns {() => boolean} whether it is held
 */
export function makeDraggable(knob, place, move, drop) {
  /** @type {[x: number, y: number] | null} from the knob to the pointer [px] */
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
  return () => grip !== null;
}
