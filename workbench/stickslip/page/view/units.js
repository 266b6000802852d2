/** Numbers as a person reads them: four digits and a unit of fitting size. */

import { data } from "./dom.js";

/** @type {(value: number, kind: string) => Scale} in which a value [SI] is read best */
export function scaleFor(value, kind) {
  // Sizes [SI] and units, falling, and from how many on one is better read than the next smaller one.
  const scales = data.scales[kind];
  const magnitude = Math.abs(value);
  const found = scales.find(([size, , enough]) => magnitude >= size * enough);
  const home = scales.find(([size]) => size === 1) ?? scales[0];
  const [size, unit] = found ?? (magnitude > 0 ? scales[scales.length - 1] : home);
  return { size, unit };
}

/**
 * A number with so many significant digits, a typeset minus, an exponent only where needed.
 * @type {(value: number, count?: number) => string}
 */
export function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  const readable = magnitude >= 1e-3 && magnitude < Math.max(1e5, 10 ** count);
  const plain = !readable
    ? value.toExponential(count - 1).replace("e+", "e")
    : magnitude >= 10 ** count
      ? value.toFixed(0)
      : value.toPrecision(count);
  return plain.replace(/^-/, "−");
}

/** @type {(value: number, kind: string, scale?: Scale) => string} such as "6.305 mm", or a dash */
export function quantity(value, kind, scale = scaleFor(value, kind)) {
  if (!Number.isFinite(value)) return "–";
  const number = digits(value / scale.size);
  return scale.unit ? `${number}\u00a0${scale.unit}` : number;
}

/** @type {(value: number, kind: string) => string} a quantity [SI] without noughts at its end */
export function brief(value, kind) {
  return quantity(value, kind).replace(/(\.\d*?)0+(?!\d)/, "$1").replace(/\.(?!\d)/, "");
}

/**
 * A quantity [SI] with a fixed number of decimals, for numbers that change under the eye.
 * @type {(value: number, scale: Scale & {decimals: number}) => string}
 */
export function fixed(value, { size, unit, decimals }) {
  const text = (value / size).toFixed(decimals).replace(/^-(?!0\.?0*$)/, "−");
  return `${text.replace(/^-/, "")}\u00a0${unit}`;
}

/** @type {(value: number) => string} a double, with an exponent where zeros would fill it */
export function shortest(value) {
  const plain = String(value);
  const withExponent = value.toExponential().replace("e+", "e");
  return plain.length > 7 && withExponent.length < plain.length ? withExponent : plain;
}
