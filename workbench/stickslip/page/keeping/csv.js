/** The curve as a CSV file. */

/** More transitions than this are left out of a file: it would grow without showing more. */
const TRANSITIONS_AT_MOST = 100000;

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
  const few = !motion.cycle.exists || (2 * (to - from)) / motion.cycle.T < TRANSITIONS_AT_MOST;
  const times = new Set([to]);
  for (let i = 0; i < samples; i++) times.add(from + ((to - from) * i) / samples);
  if (few) for (const { t } of motion.events(from, to)) times.add(t);
  return Float64Array.from(times).sort();
}
