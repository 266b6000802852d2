/** A control's value as a person types it, or why it is none, and as a slider's position. */

import { shortened } from "../view/spelled.js";
import { shortest } from "../view/units.js";

/** Powers of the position by which scales that begin at 0 rise. */
const POWERS = { linear: 1, square: 2 };

/** @typedef {{low: number, high: number}} Ends of a slider, in the unit that is shown */

/**
 * Read a typed text, a plain number in the unit shown beside the field: the value in SI, rounded
 * once, or what is wrong; inUnit: whether the text names a unit.
 * @type {(text: string, control: Control, reader: Reader, shown: string) =>
 *   {value?: number, objection?: string, inUnit?: boolean}}
 */
export function readTyped(text, control, reader, shown) {
  const typed = text.trim();
  if (typed === "") return { objection: "A number is needed." };
  const { value, wrong, inUnit } = reader.read(typed, control.unit, shown);
  const objection = wrong ? `${wrong}; expected ${control.expected}` : outOfRange(value, control);
  // A typed -0 is a 0.
  if (!objection) return { value: value + 0, inUnit };
  return { objection: `“${shortened(typed)}” ${objection}.`, inUnit };
}

/** @type {(value: number, control: Control) => string | null} why a value [SI] is out of range */
export function outOfRange(value, { least, most, unit }) {
  if (value >= least && value <= most) return null;
  if (least >= 0 && value <= 0) {
    return `is out of range: it must be ${least > 0 ? "above 0" : "0 or more"}`;
  }
  return `is out of range: from ${least} to ${most} ${unit}`.trim();
}

/** @type {(table: Control[], name: string, value: any) => string | null} what is wrong with a value [SI] */
export function objectionIn(table, name, value) {
  const parameter = table.find((each) => each.name === name);
  if (!parameter) return `There is no parameter ${name}.`;
  const objection = outOfRange(Number(value), parameter);
  return objection ? `${name}: ${value} ${objection}.` : null;
}

/** @type {(value: number, scale: Scale) => string} a value [SI] in a unit, as a person reads it */
export function typedText(value, { size }) {
  // Beyond 12 digits stands what rounding left of a division or a difference.
  return shortest(Number((value / size).toPrecision(12)));
}

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
 * The number, in the unit that is shown, that a slider's position means: of few digits.
 * @type {(slider: any, control: Control, ends: Ends) => string}
 */
export function numberAt(slider, { scale }, { low, high }) {
  const share = slider.value / slider.max;
  const number = scale === "log" ? low * (high / low) ** share : high * share ** POWERS[scale];
  // Of a linear one three would tell too few apart; the end itself may have more.
  const digits = scale === "linear" ? 4 : 3;
  return String(share === 1 ? high : Number(number.toPrecision(digits)));
}
