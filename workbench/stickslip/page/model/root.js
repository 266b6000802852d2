/**
 * The zero of a rising function between two points that enclose it, by Newton's method kept inside
 * the bracket: a step that would leave it becomes a halving.
 *
 * @param {(x: number) => [number, number]} f value and slope; only the value's sign decides where
 *   the zero lies, so an inexact slope costs steps and not digits
 * @param {number} low here f <= 0
 * @param {number} high here f >= 0
 * @param {number} start first guess inside the bracket
 * @returns {number} the zero, to the last digit but one
 */
export function risingZero(f, low, high, start) {
  let x = start;
  // Halving alone needs about 60 steps to the last bit; Newton 3 to 8.
  for (let step = 0; step < 200; step++) {
    const [value, slope] = f(x);
    if (value > 0) high = x;
    else if (value < 0) low = x;
    else return x;
    const newton = x - value / slope;
    const next = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    const settled = Math.abs(next - x) <= 2 ** -51 * Math.max(Math.abs(next), 1e-300);
    x = next;
    if (settled) break;
  }
  return x;
}
