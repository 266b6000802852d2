/** One slip from rest, as a function of the time since break-away: docs/theory.md (3). */

import { numbersOf } from "./friction.js";

/** @import { Setting } from "./friction.js" */

/**
 * The oscillator m y'' + c y' + k y = 0.
 *
 * @typedef {object} Oscillator
 * @property {number} w natural frequency [rad/s]
 * @property {number} a rate of decay zeta w [1/s]; below 0 where it grows
 * @property {number} b sqrt(|w^2 - a^2|) [rad/s]
 * @property {number} fast the faster rate of decay [1/s]; a, if it is not overdamped
 * @property {number} slow the slower rate of decay [1/s]; a, if it is not overdamped
 * @property {boolean} overdamped whether zeta is 1 or more
 */

/**
 * The state of the slip at a time after its break-away.
 *
 * @typedef {object} SlipState
 * @property {number} displacement of the mass [m]
 * @property {number} x_dot velocity of the mass [m/s]
 * @property {number} x_ddot acceleration of the mass [m/s^2]
 * @property {number} growth of the spring's extension [m]
 * @property {number} [mode] direction of slip, forward if none is given: 1, or -1 backward
 */

/**
 * The slip that starts from rest at break-away and is followed without end.
 *
 * @typedef {object} Slip
 * @property {(tau: number) => SlipState} at the state, tau [s] after the break-away
 * @property {{tau: number, growth: number} | null} overshoot when [s] the spring is longest and
 *   how much it has grown by then [m]; null where it has no maximum
 * @property {number} rate of the fastest change [rad/s]
 * @property {number} fast the faster rate of decay [1/s]
 * @property {number} slow the slower rate of decay [1/s]
 * @property {number} scale duration of a swing, or three times that of the slower decay [s]
 * @property {(from: number, to: number) => Iterable<Piece>} [pieces] the arcs of a slip on a friction
 *   curve that touch a stretch of time since break-away [s]
 * @property {() => boolean} [settles] whether it ends in steady sliding; under a friction curve only
 */

/**
 * A stretch of slip with rates of its own.
 *
 * @typedef {object} Piece
 * @property {number} start time since break-away [s]
 * @property {number} end the same
 * @property {number} rate of the fastest change [rad/s]
 * @property {number} fast the faster rate of decay [1/s]
 * @property {number} slow the slower rate of decay [1/s]; below 0 where it grows
 * @property {boolean} turns whether the direction of slip changes at its end
 */

/**
 * The responses of an oscillator to a unit impulse: docs/theory.md (3).
 *
 * @param {Oscillator} oscillator
 * @param {number} tau time since the impulse [s]
 * @returns {{K: number, slope: number, G: number, H: number}} K: the impulse response [s], with
 *   its slope [1]; G: w^2 times the integral of K [1]; H: the integral of G [s]
 */
export function responses({ w, a, b, fast, slow, overdamped }, tau) {
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
  // Each rate's lag is its own closed form; so far apart rates cost no digits.
  const H = tau + Math.expm1(-slow * tau) / slow - slow * integralOfK(fast, slow, tau, K);
  return { K, slope, G, H };
}

/**
 * The integral of K for two decaying rates: (1/slow)((1 - e^{-fast tau})/fast - K).
 *
 * @param {number} fast the faster rate of decay [1/s]
 * @param {number} slow the slower rate of decay [1/s]
 * @param {number} tau time since the impulse [s]
 * @param {number} K impulse response at tau [s]
 * @returns {number} [s^2]
 */
function integralOfK(fast, slow, tau, K) {
  return (-Math.expm1(-fast * tau) / fast - K) / slow;
}

/**
 * An oscillator by its natural frequency and its rate of decay.
 *
 * @param {number} w [rad/s]
 * @param {number} a [1/s]; below 0 it grows
 * @returns {Oscillator}
 */
export function oscillatorOf(w, a) {
  const overdamped = !(Math.abs(a) < w);
  const b = Math.sqrt(Math.abs((w - a) * (w + a)));
  const steep = a < 0 ? a - b : a + b;
  const rates = overdamped ? [steep, (w * w) / steep] : [a, a];
  const [fast, slow] = a < 0 ? rates.reverse() : rates;
  return { w, a, b, fast, slow, overdamped };
}

/**
 * Make the slip of a setting.
 *
 * @param {Setting} p
 * @returns {Slip}
 */
export function slipFromRest(p) {
  const { Delta, w, zeta, lambda_ } = numbersOf(p);
  const oscillator = oscillatorOf(w, zeta * w);
  const { fast, slow, overdamped } = oscillator;
  // Distance of the spring from where it would come to rest.
  const swing = Delta - (p.c * p.v) / p.k;
  /** @type {(tau: number) => SlipState} */
  const at = (tau) => {
    const { K, slope, G, H } = responses(oscillator, tau);
    return {
      displacement: p.v * H + Delta * G,
      x_dot: p.v * G + w * w * Delta * K,
      x_ddot: w * w * (Delta * slope + p.v * K),
      growth: p.v * K - swing * G,
    };
  };
  const longest = timeOfPull(lambda_, zeta) / w;
  const overshoot = Number.isFinite(longest)
    ? { tau: longest, growth: at(longest).growth }
    : null;
  const rate = Math.max(w, fast);
  // A swing, or where the slow decay outlasts it, three times that.
  const scale = Math.max((2 * Math.PI) / w, overdamped ? 3 / slow : 0);
  return { at, overshoot, rate, fast, slow, scale };
}

/**
 * When the mass first has the speed of the pulled end.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @param {number} zeta damping ratio [1]
 * @returns {number} time since break-away in units of 1/w, infinite if never
 */
function timeOfPull(lambda_, zeta) {
  const nu = Math.sqrt(Math.abs((1 - zeta) * (1 + zeta)));
  if (zeta < 1) return Math.atan2(nu, lambda_ - zeta) / nu;
  const lead = lambda_ - zeta;
  if (!(lead > nu)) return Infinity;
  return nu > 0 ? Math.atanh(nu / lead) / nu : 1 / lead;
}
