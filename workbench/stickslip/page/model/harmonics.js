/**
 * The velocity of the mass over one period as a Fourier series, in closed form: docs/theory.md (3)
 * integrated over the slip; in stick the velocity is 0. Time is counted from a break-away.
 */

/** @typedef {[re: number, im: number]} Complex */

/** @type {(motion: Motion, count: number) => Harmonics} of a motion that has a cycle */
export function harmonicsOfMotion({ p, slip, cycle: { t_slip, T } }, count) {
  const terms = [{ start: 0, length: t_slip, factor: [p.v, 0], decay: 0, turn: 0 }];
  for (const { start, end, w, a, b, overdamped } of slip.pieces(0, t_slip)) {
    // Ahead of the pull by rho, which is exp(-a t) (rho cos(b t) + swing sin(b t)), or cosh and sinh.
    const { x_dot, x_ddot } = slip.at(start);
    const rho = x_dot - p.v;
    // At critical damping, where b is 0: a hair beside it.
    const rate = Math.max(b, 1e-8 * w);
    const swing = (x_ddot + a * rho) / rate;
    for (const side of [0.5, -0.5]) {
      const [decay, turn] = overdamped ? [a - 2 * side * rate, 0] : [a, 2 * side * rate];
      const factor = overdamped ? [0.5 * rho + side * swing, 0] : [0.5 * rho, -side * swing];
      terms.push({ start, length: end - start, factor, decay, turn });
    }
  }
  const [cosines, sines] = [[p.v], [0]];
  for (let n = 1; n <= count; n++) {
    const W = (2 * Math.PI * n) / T;
    let [re, im] = [0, 0];
    for (const { start, length, factor, decay, turn } of terms) {
      const mean = meanOfExp(-decay * length, (turn - W) * length);
      const [x, y] = times(times(factor, mean), [Math.cos(W * start), -Math.sin(W * start)]);
      re += length * x;
      im += length * y;
    }
    cosines.push((2 / T) * re);
    sines.push((-2 / T) * im);
  }
  return { cosines, sines };
}

/** @type {(one: number[], other: number[]) => Complex} */
function times([a, b], [c, d]) {
  return [a * c - b * d, a * d + b * c];
}

/** @type {(re: number, im: number) => Complex} the mean of exp(z u) for u from 0 to 1: no pole */
function meanOfExp(re, im) {
  const size = re * re + im * im;
  if (size < 1e-32) return [1, 0];
  // exp z - 1 without the difference of two numbers near 1.
  const half = Math.sin(0.5 * im);
  const x = Math.expm1(re) * Math.cos(im) - 2 * half * half;
  const y = Math.exp(re) * Math.sin(im);
  return [(x * re + y * im) / size, (y * re - x * im) / size];
}
