/** How a slider's position and a control's value belong together. */

/** Powers of the position by which scales that begin at 0 rise. */
const POWERS = { linear: 1, square: 2 };

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
 * Put a slider where a number is, in the unit that is shown.
 * @type {(slider: any, control: Control, number: number, ends: Ends) => void}
 */
export function placeSlider(slider, { scale }, number, { low, high }) {
  // A 0 has no place on a logarithmic one, and is shown at the lower end.
  const along = number > 0 ? Math.log(number / low) / Math.log(high / low) : 0;
  const share = scale === "log" ? along : (number / high || 0) ** (1 / POWERS[scale]);
  slider.value = slider.max * share;
}

/**
 * The number, in the unit that is shown, that a slider's position means: three digits.
 * @type {(slider: any, control: Control, ends: Ends) => string}
 */
export function numberAt(slider, { scale }, { low, high }) {
  const share = slider.value / slider.max;
  const number = scale === "log" ? low * (high / low) ** share : high * share ** POWERS[scale];
  // The end itself may have more.
  return String(share === 1 ? high : Number(number.toPrecision(3)));
}
