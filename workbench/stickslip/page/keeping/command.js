/** The command line that repeats a run. */

import { scaleFor, shortest } from "../view/units.js";

/**
 * @import { Setting } from "../model/friction.js"
 * @import { Reader } from "../view/spelled.js"
 */

/** The parameters of the command, each with the scales of its units; the first are always named. */
const KINDS = {
  k: "stiffness",
  v: "velocity",
  mu_s: "number",
  mu_k: "number",
  m: "mass",
  g: "number",
  c: "damping",
  load: "force",
};
const ALWAYS = ["k", "v", "mu_s", "mu_k"];

/**
 * The command that repeats a run. Python reads its numbers back as the very same doubles.
 *
 * @param {Setting} p
 * @param {Setting} starts start values of the FMU: the others are named where they differ
 * @param {number} to end of the run [s]; the command ends it up to 1 % later
 * @param {Reader} reader of quantities, as Python reads them
 * @param {boolean} isCurved whether a friction curve, saved as curve.csv, takes the place of mu_k
 * @returns {string} one line for a shell
 */
export function commandLine(p, starts, to, reader, isCurved) {
  const options = Object.keys(KINDS)
    .filter((name) => !(isCurved && name === "mu_k"))
    .filter((name) => ALWAYS.includes(name) || p[name] !== starts[name])
    .map((name) => `--${name.replace("_", "-")} ${asTyped(p[name], KINDS[name], reader)}`);
  const law = isCurved ? "--law stribeck --curve curve.csv " : "";
  return `stickslip simulate ${law}${options.join(" ")} --stop-time ${rounded(to)}`;
}

/** A value in the unit in which it is read best, or in SI where only that gives the same double. */
function asTyped(value, kind, reader) {
  const { size, unit } = scaleFor(value, kind);
  const number = shortest(Number((value / size).toPrecision(15)));
  // The SI unit is left out, and the others are spelled with letters that every keyboard has.
  if (size === 1 || reader.valueOf(number, unit) !== value) return `${value}`;
  return `${number}${unit.replace("µ", "u").replace("·", ".")}`;
}

/** A time rounded up to three digits. */
function rounded(time) {
  const [mantissa, exponent] = time.toExponential(2).split("e");
  const power = Number(exponent);
  const up = (more) => Number(`${Math.round(100 * Number(mantissa)) + more}e${power - 2}`);
  return shortest(up(0) < time ? up(1) : up(0));
}
