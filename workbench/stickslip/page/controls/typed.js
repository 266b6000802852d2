/** What a person types for a control: a quantity, or the reason why it is none. */

import { shortened } from "../view/spelled.js";
import { shortest } from "../view/units.js";

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

/** @type {(value: number, scale: Scale) => string} a value [SI] in a unit, as a person reads it */
export function typedText(value, { size }) {
  // Beyond 12 digits stands what rounding left of a division or a difference.
  return shortest(Number((value / size).toPrecision(12)));
}
