/** An axis: what it spans, in which unit, and where its marks stand. */

import { scaleFor } from "./units.js";

/** What is spanned is at least this part of its size: less is rounding and no motion. */
const FINEST = 1e-9;
const MOST_MARKS = 50;

/**
 * An axis that spans some values [SI], one at least, with parts of the range left free beside them.
 * @type {(values: number[], kind: string, name: string, below: number, above?: number) => Axis}
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

/** @type {(low: number, high: number, kind: string, name: string) => Axis} a logarithmic one [SI] */
export function logAxis(low, high, kind, name) {
  const { size, unit } = scaleFor(Math.sqrt(low) * Math.sqrt(high), kind);
  return { low, high, size, title: `${name} in ${unit}`, log: true };
}

/** @type {(low: number, high: number) => {low: number, high: number}} whole decades about a range */
export function decades(low, high) {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  return { low: Number(`1e${first}`), high: Number(`1e${last}`) };
}

/** @type {(axis: Axis, value: number) => number} 0 at the lower end, 1 at the upper */
export function shareAlong({ low, high, log }, value) {
  return log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** @type {(axis: Axis, share: number) => number} the value [SI] at a share of an axis */
export function valueAlong({ low, high, log }, share) {
  return log ? low * (high / low) ** share : low + share * (high - low);
}

/**
 * Round values [SI] within an axis and their texts, about `count` of them.
 * @type {(axis: Axis, count: number) => {value: number, text: string}[]}
 */
export function ticks(axis, count) {
  if (axis.log) return logTicks(axis, count);
  const { low, high, size } = axis;
  const bottom = low / size;
  const top = high / size;
  const coarse = roundStep((top - bottom) / count);
  // A single mark is no scale.
  const step = multiples(coarse, bottom, top).length > 1 ? coarse : roundStep(0.4 * coarse);
  const values = multiples(step, bottom, top);
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const most = Math.max(-bottom, top);
  const plain = most > 1e-4 && most < 1e6;
  return values.map((value) => {
    const exponential = value === 0 ? "0" : Number(value.toPrecision(12)).toExponential();
    const text = plain ? value.toFixed(decimals) : exponential.replace("e+", "e");
    return { value: value * size, text: text.replace(/^-/, "−") };
  });
}

/** Marks at powers of ten, some left out where they are dense; with 2 and 5 where they are few. */
function logTicks({ low, high, size }, count) {
  const first = Math.ceil(Math.log10(low / size) - 1e-9);
  const last = Math.floor(Math.log10(high / size) + 1e-9);
  const step = Math.max(Math.ceil((last - first + 1) / count), 1);
  const few = last - first < 2;
  const marks = [];
  for (let n = first - (few ? 1 : 0); n <= last; n += few ? 1 : step) {
    for (const digit of few ? [1, 2, 5] : [1]) {
      const text = `${digit}e${n}`;
      const value = Number(text) * size;
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      marks.push({ value, text: (Math.abs(n) < 4 ? `${Number(text)}` : text).replace("-", "−") });
    }
  }
  return marks;
}

/** The multiples of a step from bottom to top. */
function multiples(step, bottom, top) {
  const values = [];
  const first = Math.ceil(bottom / step - 1e-9);
  for (let n = first; values.length < MOST_MARKS && n * step <= top + 1e-9 * step; n++) {
    values.push(n * step);
  }
  return values;
}

/** @type {(least: number) => number} the least of 1, 2, 5, 10, ... that is not below a number */
export function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= least * 0.9999);
}
