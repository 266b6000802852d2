/** How a slider's position and a control's value belong together. */

import { typedText } from "./typed.js";
import { shifted } from "../view/units.js";

/** @import { Control } from "./typed.js" */

/**
 * A slider, which keeps a number that it is given as a text.
 *
 * @typedef {"min" | "max" | "step" | "value"} Kept
 * @typedef {Omit<HTMLInputElement, Kept> & Record<Kept, string | number>} Slider
 */

/**
 * The ends of a slider, in its control's unit.
 *
 * @typedef {{low: number, high: number}} Ends
 */

/** Few enough that each is another number of three digits: the finest is 1 %. */
const STEPS = 300;

/**
 * The ends of a control's slider, in its unit: those of the table, or, for a value beyond them,
 * ends about that value.
 *
 * @param {Control} control
 * @param {number} value in the control's unit
 * @returns {Ends}
 */
export function sliderEnds(control, value) {
  const { low, high, scale } = control;
  if (value >= low && value <= high) return { low, high };
  if (scale !== "log") {
    const rounded = (number) => Number(number.toPrecision(2));
    if (value > high) return { low, high: rounded(1.25 * value) };
    return { low: rounded(0.5 * value), high };
  }
  const decade = Math.floor(Math.log10(value));
  return { low: Number(`1e${decade - 1}`), high: Number(`1e${decade + 2}`) };
}

/**
 * Put a slider where its control's value is.
 *
 * @param {Slider} slider
 * @param {Control} control
 * @param {number} value in use, SI
 * @param {Ends} ends
 */
export function placeSlider(slider, control, value, ends) {
  const shown = shifted(String(value), control.decimals);
  const linear = control.scale === "linear";
  slider.min = linear ? ends.low : 0;
  slider.max = linear ? ends.high : STEPS;
  slider.step = linear ? linearStep(ends) : 1;
  slider.value = linear ? shown : STEPS * shareOf(control, shown, ends);
  slider.setAttribute("aria-valuetext", `${typedText(value, control)} ${control.unit}`.trim());
}

/**
 * The value, SI, that a slider's position means: three digits of the shown unit.
 *
 * @param {HTMLInputElement} slider
 * @param {Control} control
 * @param {Ends} ends
 */
export function valueAt(slider, control, ends) {
  if (control.scale === "linear") {
    // The end itself may lie between two steps.
    const text = atEnd(slider) ? String(ends.high) : slider.value;
    return shifted(text, -control.decimals);
  }
  const share = Number(slider.value) / STEPS;
  const { low, high } = ends;
  const shown = control.scale === "log" ? low * (high / low) ** share : high * share * share;
  return shifted(String(Number(shown.toPrecision(3))), -control.decimals);
}

function shareOf(control, shown, { low, high }) {
  return control.scale === "log"
    ? Math.log(shown / low) / Math.log(high / low)
    : Math.sqrt(shown / high);
}

function linearStep({ high }) {
  return high <= 5 ? 0.001 : 0.01;
}

/** Whether the browser can put a slider no higher. */
function atEnd(slider) {
  const { value } = slider;
  slider.stepUp();
  const highest = slider.value === value;
  slider.value = value;
  return highest;
}
