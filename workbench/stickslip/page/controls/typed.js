/** What a person types for a control: a number of the shown unit, or the reason why it is none. */

import { shifted } from "../view/units.js";

/**
 * A row of the page's controls, as controls.toml explains it.
 *
 * @typedef {object} Control
 * @property {string} name of the parameter
 * @property {string} unit in which it is shown
 * @property {number} decimals the shown number is the SI one times ten to this power
 * @property {string} scale how the slider spans its ends: "linear", "log" or "square"
 * @property {number} low lower end of the slider, in the shown unit
 * @property {number} high upper end of the slider, in the shown unit
 * @property {number} least what may be typed at least, in the shown unit
 * @property {number} most what may be typed at most, in the shown unit
 * @property {number} start start value of the FMU [SI]
 */

const NUMBER = /^[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d+)?$/i;

/**
 * Read a typed text.
 *
 * @param {string} text as typed
 * @param {Control} control
 * @returns {{value?: number, objection?: string}} the value in SI, rounded once, or what is wrong
 */
export function readTyped(text, control) {
  const typed = text.trim().replace(/^−/, "-");
  const unit = control.unit ? ` ${control.unit}` : "";
  if (typed === "") return { objection: "A number is needed." };
  if (/^[+-]?\d+,\d+$/.test(typed)) return { objection: "Write the decimals after a point." };
  if (!NUMBER.test(typed)) {
    const hint = /^[+-]?\.?\d/.test(typed) ? " Type it alone, without unit or blanks." : "";
    return { objection: `“${shortened(typed)}” is no number.${hint}` };
  }
  const shown = Number(typed);
  if (!Number.isFinite(shown)) {
    return { objection: `${shortened(typed)} is larger than can be computed with.` };
  }
  if (shown < 0 || (shown === 0 && control.least > 0)) {
    const range = control.least > 0 ? "above 0" : "0 or more";
    return { objection: `${shortened(typed)}${unit} is out of range: it must be ${range}.` };
  }
  if (shown < control.least || shown > control.most) {
    const range = `from ${control.least} to ${control.most}${unit}`;
    return { objection: `${shortened(typed)}${unit} is out of range: ${range}.` };
  }
  // A typed -0 is a 0.
  return { value: shifted(typed, -control.decimals) + 0 };
}

/**
 * The text of an SI value in the control's unit, with all its digits.
 *
 * @param {number} value SI
 * @param {Control} control
 */
export function typedText(value, control) {
  return shortest(shifted(String(value), control.decimals));
}

/**
 * The text of a double, with an exponent where zeros would fill it.
 *
 * @param {number} value
 */
export function shortest(value) {
  const plain = String(value);
  const withExponent = value.toExponential().replace("e+", "e");
  return plain.length > 7 && withExponent.length < plain.length ? withExponent : plain;
}

function shortened(text) {
  return text.length > 14 ? `${text.slice(0, 12)}…` : text;
}
