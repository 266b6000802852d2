/**
 * The velocity of the mass over one period as a Fourier series, in closed form: docs/theory.md (3)
 * integrated over the slip; in stick the velocity is 0. Time is counted from a break-away.
 */

import { nuOf } from "./friction.js";

/** @type {(motion: Motion, count: number) => Harmonics} of a motion that has a cycle */
export function harmonicsOfMotion(motion, count) {
  const { v } = motion.p;
  const { t_slip, T } = motion.cycle;
  const integral = motion.slip.pieces ? overArcs(motion) : overSwing(motion);
  const cosines = [v];
  const sines = [0];
  for (let n = 1; n <= count; n++) {
    const W = (2 * Math.PI * n) / T;
    const pull = meanOfExp(0, -W * t_slip);
    const [re, im] = integral(W);
    cosines.push((2 / T) * (v * t_slip * pull[0] + re));
    sines.push((-2 / T) * (v * t_slip * pull[1] + im));
  }
  return { cosines, sines };
}

/**
 * The integral of rho exp(-i W t) over the slip [m], rho = x_dot - v, under constant friction.
 * @type {(motion: Motion) => (W: number) => [re: number, im: number]}
 */
function overSwing({ p, cycle }) {
  const { w, zeta, lambda_, t_slip } = cycle;
  const a = zeta * w;
  const b = w * nuOf(zeta);
  // In slip rho = Re(C exp((ib - a) t)), C = -v - i s.
  const s = (p.v * (lambda_ * w - a)) / b;
  return (W) => {
    const ahead = meanOfExp(-a * t_slip, (b - W) * t_slip);
    const behind = meanOfExp(-a * t_slip, -(b + W) * t_slip);
    // Both halves of the real part, C times one mean and its conjugate times the other.
    const re = -p.v * (ahead[0] + behind[0]) + s * (ahead[1] - behind[1]);
    const im = -p.v * (ahead[1] + behind[1]) - s * (ahead[0] - behind[0]);
    return [0.5 * t_slip * re, 0.5 * t_slip * im];
  };
}

/**
 * The same under a friction curve, arc by arc, in which rho'' + 2 a rho' + w^2 rho = 0. Times
 * exp(-i W t) and integrated by parts, it is what rho' + (2 a + i W) rho has lost, over
 * w^2 - W^2 + 2 i a W.
 * @type {(motion: Motion) => (W: number) => [re: number, im: number]}
 */
function overArcs({ p, slip, cycle: { t_slip, w } }) {
  // The states at the ends of the arcs: of each its own, as the acceleration may jump in between.
  const ends = Array.from(slip.pieces?.(0, t_slip) ?? [], ({ start, end, fast, slow }) =>
    [start, Math.max(end * (1 - 2 ** -52), start)].map((tau, n) => {
      const { x_dot, x_ddot } = slip.at(tau);
      return { tau, rho: x_dot - p.v, rate: x_ddot, a: 0.5 * (fast + slow), sign: n ? -1 : 1 };
    }),
  ).flat();
  return (W) => {
    let [re, im] = [0, 0];
    for (const { tau, rho, rate, a, sign } of ends) {
      const [x, y] = [w * w - W * W, 2 * a * W];
      // At resonance without damping it has a pole that the numerator cancels: a hair beside it.
      const size = Math.max(x * x + y * y, 1e-18 * w ** 4);
      const [c, s] = [Math.cos(W * tau), -Math.sin(W * tau)];
      const [top, side] = [rate + 2 * a * rho, W * rho];
      const [u, v] = [top * c - side * s, top * s + side * c];
      re += (sign * (u * x + v * y)) / size;
      im += (sign * (v * x - u * y)) / size;
    }
    return [re, im];
  };
}

/**
 * The mean of exp(z u) for u from 0 to 1, (exp z - 1)/z: it has no pole, so none at resonance.
 * @type {(re: number, im: number) => [re: number, im: number]}
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
