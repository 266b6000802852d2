/** What a person types for a control: a quantity, or the reason why it is none. */

import { shortened } from "../view/spelled.js";
import { shortest } from "../view/units.js";

/** @import { Reader } from "../view/spelled.js" */

/**
 * A row of the page's controls, as controls.toml explains it.
 *
 * @typedef {object} Control
 * @property {string} name of the parameter, or N for the normal force
 * @property {string} unit SI
 * @property {string} expected what may be typed, in words
 * @property {string} kind key of the scales of its units
 * @property {string} scale how the slider spans its ends: "linear", "log" or "square"
 * @property {number} low lower end of the slider [SI]
 * @property {number} high upper end of the slider [SI]
 * @property {number} least what is taken at least [SI]
 * @property {number} most what is taken at most [SI]
 * @property {number} [start] start value of the FMU [SI]
 */

/**
 * Read a typed text.
 *
 * @param {string} text as typed
 * @param {Control} control
 * @param {Reader} reader
 * @param {string} shown the unit beside the field, which a plain number is in
 * @returns {{value?: number, objection?: string, inUnit?: boolean}} the value in SI, rounded once,
 *   or what is wrong; whether the text names a unit
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

/**
 * Why a value is out of a control's range, or null.
 *
 * @param {number} value SI
 * @param {Control} control
 */
export function outOfRange(value, { least, most, unit }) {
  if (value >= least && value <= most) return null;
  if (least >= 0 && value <= 0) {
    return `is out of range: it must be ${least > 0 ? "above 0" : "0 or more"}`;
  }
  return `is out of range: from ${least} to ${most} ${unit}`.trim();
}

/**
 * The number of an SI value in a unit, as a person reads it.
 *
 * @param {number} value SI
 * @param {{size: number}} scale of the unit
 */
export function typedText(value, { size }) {
  // Beyond 12 digits stands what rounding left of a division or a difference.
  return shortest(Number((value / size).toPrecision(12)));
}
