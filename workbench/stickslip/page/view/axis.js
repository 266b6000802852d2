/** An axis: what it spans, in which unit, and where its marks stand. */

import { scaleFor } from "./units.js";

/**
 * An axis.
 *
 * @typedef {object} Axis
 * @property {number} low lower end [SI]
 * @property {number} high upper end [SI]
 * @property {number} size of its unit [SI]
 * @property {string} title quantity and unit
 */

/** What is spanned is at least this part of its size: less is rounding and no motion. */
const FINEST = 1e-9;
const MOST_MARKS = 50;

/**
 * An axis that spans some values, with room beside them.
 *
 * @param {number[]} values SI, one at least
 * @param {string} kind of quantity, for its unit
 * @param {string} name of the quantity
 * @param {number} below part of the range that is left free below the values
 * @param {number} above the same above them
 * @returns {Axis}
 */
export function axisOf(values, kind, name, below, above = below) {
  const least = Math.min(...values);
  const most = Math.max(...values);
  const largest = Math.max(Math.abs(least), Math.abs(most));
  const { size, unit } = scaleFor(largest, kind);
  const middle = 0.5 * (least + most);
  const range = Math.max(most - least, FINEST * largest) || size;
  return {
    low: middle - (0.5 + below) * range,
    high: middle + (0.5 + above) * range,
    size,
    title: `${name} in ${unit}`,
  };
}

/**
 * Round values within an axis and their texts, about `count` of them.
 *
 * @param {Axis} axis
 * @param {number} count
 * @returns {{value: number, text: string}[]} values [SI]
 */
export function ticks({ low, high, size }, count) {
  const bottom = low / size;
  const top = high / size;
  const rough = (top - bottom) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const steps = [0.5, 1, 2, 5, 10].map((each) => each * power);
  const index = steps.findIndex((each) => each >= rough * 0.9999);
  // A single mark is no scale.
  const marks = multiples(steps[index], bottom, top);
  const isScale = marks.values.length > 1;
  const { step, values } = isScale ? marks : multiples(steps[index - 1], bottom, top);
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const most = Math.max(-bottom, top);
  const plain = most > 1e-4 && most < 1e6;
  return values.map((value) => {
    const exponential = value === 0 ? "0" : Number(value.toPrecision(12)).toExponential();
    const text = plain ? value.toFixed(decimals) : exponential.replace("e+", "e");
    return { value: value * size, text: text.replace(/^-/, "−") };
  });
}

/** The multiples of a step from bottom to top. */
function multiples(step, bottom, top) {
  const values = [];
  const first = Math.ceil(bottom / step - 1e-9);
  for (let n = first; values.length < MOST_MARKS && n * step <= top + 1e-9 * step; n++) {
    values.push(n * step);
  }
  return { step, values };
}
