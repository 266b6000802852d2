/** A run as texts: the command line that repeats it, and its curve as a CSV file. */

import { data } from "../view/dom.js";
import { scaleFor, shortest } from "../view/units.js";

/** Options that are named even where they are as the FMU starts. */
const ALWAYS = ["k", "v", "mu_s", "mu_k"];

/**
 * The command that repeats a run up to a time [s], or up to 1 % later: one line for a shell, whose
 * numbers Python reads back as the very same doubles. What is as the FMU starts is left out; in the
 * place of mu_k may be a friction curve, saved as curve.csv.
 * @type {(p: Setting, to: number, reader: Reader, isCurved: boolean) => string}
 */
export function commandLine(p, to, reader, isCurved) {
  const options = data.controls
    .filter(({ name, start }) => start !== undefined && !(isCurved && name === "mu_k"))
    .filter(({ name, start }) => ALWAYS.includes(name) || p[name] !== start)
    .map(({ name, kind }) => `--${name.replace("_", "-")} ${asTyped(p[name], kind, reader)}`);
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

/**
 * The motion from one time to another [s] as a CSV file in the format of `stickslip simulate
 * --output-file`, in SI, every number with all its digits: even steps, the transitions in between.
 * @type {(motion: Motion, from: number, to: number, samples?: number) => string}
 */
export function csvText(motion, from, to, samples = 2000) {
  const rows = ['"time","x","x_dot","x_pull","z","F","F_friction","F_s","sticking","mode"'];
  const { F_s } = motion.numbers;
  for (const t of timesOf(motion, from, to, samples)) {
    const { mode, x, x_dot, x_pull, z, F, F_friction } = motion.at(t);
    rows.push([t, x, x_dot, x_pull, z, F, F_friction, F_s, mode === 0 ? 1 : 0, mode].join(","));
  }
  return `${rows.join("\n")}\n`;
}

/** Even times and those of the transitions, rising, each once. */
function timesOf(motion, from, to, samples) {
  const times = new Set([to]);
  for (let i = 0; i < samples; i++) times.add(from + ((to - from) * i) / samples);
  for (const { t } of motion.events(from, to)) times.add(t);
  return Float64Array.from(times).sort();
}
