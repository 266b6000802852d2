/** An arc of slip on one line of a friction curve, and where it leaves it: docs/theory.md (3), (5). */

import { zeroBetween } from "./root.js";

/** A swing that has grown by exp(600) has left every line. */
const MOST_GROWTH = 600;

/** @type {(arc: Arc, v: number, tau: number) => SlipState} the state tau [s] after its start */
export function arcState({ band, displacement, growth, x_dot, x_ddot }, v, tau) {
  const { w, a } = band.oscillator;
  const { K, slope, G, H } = responses(band.oscillator, tau);
  const ahead = v - x_dot;
  const w2 = w * w;
  return {
    displacement: displacement + x_dot * tau + ahead * H + (x_ddot / w2) * G,
    x_dot: x_dot + ahead * G + x_ddot * K,
    x_ddot: x_ddot * slope + ahead * w2 * K,
    growth: growth + ahead * K - (x_ddot / w2 - (2 * a * ahead) / w2) * G,
  };
}

/**
 * Follow the speed of an arc from extreme to extreme, each in closed form, until it passes an end of
 * its line. Touching the end from inside does not pass it.
 * @type {(arc: Arc, v: number) => Course}
 */
export function courseOf(arc, v) {
  const { band, mode, x_dot, x_ddot } = arc;
  const { w, a, b, fast, slow, overdamped } = band.oscillator;
  const [low, high] = mode > 0 ? [band.low, band.high] : [-band.high, -band.low];
  /** @type {Course} */
  const course = { tau: Infinity, rising: true, highest: NaN, highestAt: NaN, lowest: NaN };
  // Where the acceleration is 0 its rate decides.
  let rising = (x_ddot || v - x_dot) > 0;
  if (x_ddot === 0 && v === x_dot) return course;
  const half = overdamped ? Infinity : Math.PI / b;
  let extreme = overdamped
    ? turningTime(x_ddot, w * w * (v - x_dot), fast, slow)
    : Math.atan2(x_ddot, (a * x_ddot - w * w * (v - x_dot)) / b) / b;
  if (extreme <= 0) extreme += half;
  const decays = a >= 0;
  let begin = 0;
  for (let n = 0; ; n++) {
    const limit = rising ? high : low;
    const turns = extreme < Infinity && (decays || -a * extreme < MOST_GROWTH);
    const end = turns ? extreme : tailEnd(arc, v, begin, limit, rising);
    if (end === Infinity) return course;
    const speed = arcState(arc, v, end).x_dot;
    if (!turns || (rising ? speed > high : speed < low)) {
      const excess = (/** @type {number} */ tau) => arcState(arc, v, tau).x_dot - limit;
      return { ...course, rising, tau: zeroBetween(excess, begin, end) };
    }
    if (rising && !n) [course.highest, course.highestAt] = [speed, end];
    if (!rising && n < 2) course.lowest = speed;
    // A swing that does not grow has been largest; one that grows leaves its line soon.
    if (decays && n > 0 && !overdamped) return course;
    begin = end;
    extreme += half;
    rising = !rising;
  }
}

/**
 * The time [s] of the only extreme of a speed that does not swing, infinite where there is none:
 * docs/theory.md (5). The `lead` is w^2 times the speed that the pull is ahead [m/s^3].
 * @type {(x_ddot: number, lead: number, fast: number, slow: number) => number}
 */
function turningTime(x_ddot, lead, fast, slow) {
  const apart = fast - slow;
  const ratio = x_ddot / (x_ddot * slow - lead);
  const time = apart > 0 ? Math.log1p(ratio * apart) / apart : ratio;
  return time > 0 ? time : Infinity;
}

/**
 * A time [s] by which a speed without extreme from `begin` on has passed a limit, infinite for never.
 * @type {(arc: Arc, v: number, begin: number, limit: number, rising: boolean) => number}
 */
function tailEnd(arc, v, begin, limit, rising) {
  const { oscillator } = arc.band;
  const settles = oscillator.a >= 0 && (rising ? v <= limit : v >= limit);
  if (settles || Math.abs(limit) === Infinity) return Infinity;
  const rate = Math.max(Math.abs(oscillator.slow), Math.abs(oscillator.fast));
  for (let step = 1 / rate; step < Infinity; step *= 2) {
    const speed = arcState(arc, v, begin + step).x_dot;
    if (rising ? speed > limit : speed < limit) return begin + step;
  }
  return Infinity;
}

/**
 * The responses of an oscillator to a unit impulse, tau [s] after it: K, the impulse response [s],
 * and its slope [1]; G, w^2 times the integral of K [1]; H, the integral of G [s].
 * @type {(oscillator: Oscillator, tau: number) => {K: number, slope: number, G: number, H: number}}
 */
function responses({ w, a, b, fast, slow, overdamped }, tau) {
  if (!overdamped) {
    const half = 0.5 * b * tau;
    const sine = Math.sin(half);
    const decay = Math.exp(-a * tau);
    const K = (2 * decay * sine * Math.cos(half)) / b;
    // 1 - cos from the half angle: G is small near a whole turn, where a slip may graze standstill.
    const fallen = 2 * decay * sine * sine;
    const G = fallen - Math.expm1(-a * tau) - a * K;
    return { K, slope: decay - fallen - a * K, G, H: tau - K - ((2 * a) / (w * w)) * G };
  }
  const apart = fast - slow;
  const rise = apart > 0 ? -Math.expm1(-apart * tau) / apart : tau;
  const K = Math.exp(-slow * tau) * rise;
  const slope = Math.exp(-fast * tau) - slow * K;
  const G = -Math.expm1(-slow * tau) - slow * K;
  // The integral of K. Each rate's lag is its own closed form; so far apart rates cost no digits.
  const area = (-Math.expm1(-fast * tau) / fast - K) / slow;
  return { K, slope, G, H: tau + Math.expm1(-slow * tau) / slow - slow * area };
}

/**
 * An oscillator by its natural frequency w [rad/s] and its rate of decay a [1/s], below 0 growing.
 * @type {(w: number, a: number) => Oscillator}
 */
export function oscillatorOf(w, a) {
  const overdamped = !(Math.abs(a) < w);
  const b = Math.sqrt(Math.abs((w - a) * (w + a)));
  const steep = a < 0 ? a - b : a + b;
  const rates = overdamped ? [steep, (w * w) / steep] : [a, a];
  const [fast, slow] = a < 0 ? rates.reverse() : rates;
  return { w, a, b, fast, slow, overdamped };
}
