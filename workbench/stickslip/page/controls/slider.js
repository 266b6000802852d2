/** How a slider's position and a control's value belong together. */

/** Few enough that each is another number of three digits: the finest is 1 %. */
const STEPS = 300;

/** @typedef {{low: number, high: number}} Ends of a slider, in the unit that is shown */

/**
 * The ends of a control's slider in a unit: those of the table, or, for a value [SI] beyond them,
 * ends about that value.
 * @type {(control: Control, value: number, scale: Scale) => Ends}
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
 * Put a slider where its control's value [SI] is.
 * @type {(slider: any, control: Control, value: number, scale: Scale, ends: Ends) => void}
 */
export function placeSlider(slider, control, value, { size }, ends) {
  const shown = value / size;
  const linear = control.scale === "linear";
  slider.min = linear ? ends.low : 0;
  slider.max = linear ? ends.high : STEPS;
  slider.step = !linear ? 1 : ends.high <= 5 ? 0.001 : 0.01;
  slider.value = linear ? shown : STEPS * shareOf(control, shown, ends);
}

/**
 * The number, in the unit that is shown, that a slider's position means: three digits.
 * @type {(slider: HTMLInputElement, control: Control, ends: Ends) => string}
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

/** Whether the browser can put a slider no higher. */
function atEnd(slider) {
  const { value } = slider;
  slider.stepUp();
  const highest = slider.value === value;
  slider.value = value;
  return highest;
}
