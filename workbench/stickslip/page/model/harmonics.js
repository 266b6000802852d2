/**
 * The velocity of the mass over one period as a Fourier series, in closed form: docs/theory.md (3)
 * integrated over the slip; in stick the velocity is 0.
 */

import { steadyCycle } from "./cycle.js";

/**
 * @import { Setting } from "./friction.js"
 * @import { Motion } from "./motion.js"
 */

/**
 * A Fourier series: the sum of cosines[n] cos(n W t) + sines[n] sin(n W t), W = 2 pi/T.
 *
 * @typedef {object} Harmonics
 * @property {number[]} cosines [m/s], the first the mean
 * @property {number[]} sines [m/s], the first 0
 */

/**
 * The velocity of the mass in the steady cycle, time counted from a break-away.
 *
 * @param {Setting} p one that has a cycle
 * @param {number} count harmonics
 * @returns {Harmonics}
 */
export function harmonicsOf(p, count) {
  const { w, zeta, lambda_, t_slip, T } = steadyCycle(p);
  const a = zeta * w;
  const b = w * Math.sqrt((1 - zeta) * (1 + zeta));
  // In slip x_dot = v + Re(C exp((ib - a) t)), C = -v - i s.
  const s = (p.v * (lambda_ * w - a)) / b;
  const cosines = [p.v];
  const sines = [0];
  const part = t_slip / T;
  for (let n = 1; n <= count; n++) {
    const turn = (2 * Math.PI * n) / T;
    const pull = meanOfExp(0, -turn * t_slip);
    const ahead = meanOfExp(-a * t_slip, (b - turn) * t_slip);
    const behind = meanOfExp(-a * t_slip, -(b + turn) * t_slip);
    // Both halves of the real part, C times one mean and its conjugate times the other.
    const re = -p.v * (ahead[0] + behind[0]) + s * (ahead[1] - behind[1]);
    const im = -p.v * (ahead[1] + behind[1]) - s * (ahead[0] - behind[0]);
    cosines.push(part * (2 * p.v * pull[0] + re));
    sines.push(-part * (2 * p.v * pull[1] + im));
  }
  return { cosines, sines };
}

/**
 * The same of any motion that has a cycle: under a friction curve arc by arc.
 *
 * In an arc rho = x_dot - v obeys rho'' + 2 a rho' + w^2 rho = 0. Times exp(-i W t) and integrated by
 * parts, its integral is what rho' + (2 a + i W) rho has lost, over w^2 - W^2 + 2 i a W.
 *
 * @param {Motion} motion
 * @param {number} count harmonics
 * @returns {Harmonics}
 */
export function harmonicsOfMotion({ p, slip, cycle }, count) {
  if (!slip.pieces) return harmonicsOf(p, count);
  const { t_slip, T, w } = cycle;
  // The states at the ends of the arcs: of each its own, as the acceleration may jump in between.
  const arcs = Array.from(slip.pieces(0, t_slip), ({ start, end, fast, slow }) => {
    const [from, to] = [start, Math.max(end * (1 - 2 ** -52), start)].map((tau) => {
      const { x_dot, x_ddot } = slip.at(tau);
      return { tau, rho: x_dot - p.v, rate: x_ddot };
    });
    return { from, to, a: 0.5 * (fast + slow) };
  });
  const cosines = [p.v];
  const sines = [0];
  for (let n = 1; n <= count; n++) {
    const W = (2 * Math.PI * n) / T;
    const pull = meanOfExp(0, -W * t_slip);
    let [re, im] = [p.v * t_slip * pull[0], p.v * t_slip * pull[1]];
    for (const { from, to, a } of arcs) {
      const [x, y] = [w * w - W * W, 2 * a * W];
      // At resonance without damping it has a pole that the numerator cancels: a hair beside it.
      const size = Math.max(x * x + y * y, 1e-18 * w ** 4);
      for (const [sign, { tau, rho, rate }] of /** @type {const} */ ([[1, from], [-1, to]])) {
        const [c, s] = [Math.cos(W * tau), -Math.sin(W * tau)];
        const [top, side] = [rate + 2 * a * rho, W * rho];
        const [u, v] = [top * c - side * s, top * s + side * c];
        re += (sign * (u * x + v * y)) / size;
        im += (sign * (v * x - u * y)) / size;
      }
    }
    cosines.push((2 / T) * re);
    sines.push((-2 / T) * im);
  }
  return { cosines, sines };
}

/**
 * The mean of exp(z u) for u from 0 to 1, (exp z - 1)/z: it has no pole, so none at resonance.
 *
 * @param {number} re of z [1]
 * @param {number} im of z [1]
 * @returns {[number, number]} its real and its imaginary part [1]
 */
function meanOfExp(re, im) {
  const size = re * re + im * im;
  if (size < 1e-32) return [1, 0];
  // exp z - 1 without the difference of two numbers near 1.
  const half = Math.sin(0.5 * im);
  const x = Math.expm1(re) * Math.cos(im) - 2 * half * half;
  const y = Math.exp(re) * Math.sin(im);
  return [(x * re + y * im) / size, (y * re - x * im) / size];
}
