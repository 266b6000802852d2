/** The command line that repeats a run. */

import { shifted } from "../view/units.js";

/** @import { Setting } from "../model/friction.js" */

/**
 * The command that repeats a run. Python reads its numbers back as the very same doubles.
 *
 * @param {Setting} p
 * @param {Setting} starts start values of the FMU: m, g, c, load are named where they differ
 * @param {number} to end of the run [s]
 * @returns {string} one line for a shell
 */
export function commandLine(p, starts, to) {
  const inMillimetres = shifted(`${p.v}`, 3);
  // Seventeen digits may not survive the rounding of the shifted number; SI always does.
  const v = shifted(`${inMillimetres}`, -3) === p.v ? `${inMillimetres}mm/s` : p.v;
  const others = ["m", "g", "c", "load"].filter((name) => p[name] !== starts[name]);
  return [
    `stickslip simulate --k ${p.k} --v ${v} --mu-s ${p.mu_s} --mu-k ${p.mu_k}`,
    ...others.map((name) => `--${name} ${p[name]}`),
    `--stop-time ${to}`,
  ].join(" ");
}
