/** How a slider's position and a control's value belong together. */

/** @import { Control } from "./typed.js" */

/**
 * A slider, which keeps a number that it is given as a text.
 *
 * @typedef {"min" | "max" | "step" | "value"} Kept
 * @typedef {Omit<HTMLInputElement, Kept> & Record<Kept, string | number>} Slider
 */

/**
 * The ends of a slider, in the unit that is shown.
 *
 * @typedef {{low: number, high: number}} Ends
 */

/** Few enough that each is another number of three digits: the finest is 1 %. */
const STEPS = 300;

/**
 * The ends of a control's slider in a unit: those of the table, or, for a value beyond them, ends
 * about that value.
 *
 * @param {Control} control
 * @param {number} value SI
 * @param {{size: number}} scale of the unit that is shown
 * @returns {Ends}
 */
export function sliderEnds({ low, high, scale }, value, { size }) {
  const shown = (number) => Number((number / size).toPrecision(12));
  const rounded = (number) => Number((number / size).toPrecision(2));
  if (value > high && scale !== "log") return { low: shown(low), high: rounded(1.25 * value) };
  if (!value || (value >= low && value <= high)) return { low: shown(low), high: shown(high) };
  const decade = Math.floor(Math.log10(shown(value)));
  return { low: Number(`1e${decade - 1}`), high: Number(`1e${decade + 2}`) };
}

/**
 * Put a slider where its control's value is.
 *
 * @param {Slider} slider
 * @param {Control} control
 * @param {number} value in use, SI
 * @param {{size: number}} scale of the unit that is shown
 * @param {Ends} ends
 */
export function placeSlider(slider, control, value, { size }, ends) {
  const shown = value / size;
  const linear = control.scale === "linear";
  slider.min = linear ? ends.low : 0;
  slider.max = linear ? ends.high : STEPS;
  slider.step = linear ? linearStep(ends) : 1;
  slider.value = linear ? shown : STEPS * shareOf(control, shown, ends);
}

/**
 * The number, in the unit that is shown, that a slider's position means: three digits.
 *
 * @param {HTMLInputElement} slider
 * @param {Control} control
 * @param {Ends} ends
 * @returns {string}
 */
export function numberAt(slider, control, { low, high }) {
  // The end itself may lie between two steps.
  if (control.scale === "linear") return atEnd(slider) ? String(high) : slider.value;
  const share = Number(slider.value) / STEPS;
  const shown = control.scale === "log" ? low * (high / low) ** share : high * share * share;
  return String(Number(shown.toPrecision(3)));
}

function shareOf(control, shown, { low, high }) {
  if (control.scale !== "log") return Math.sqrt(shown / high);
  // A value of 0 has no place on it, and is shown at the lower end.
  return shown > 0 ? Math.log(shown / low) / Math.log(high / low) : 0;
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
