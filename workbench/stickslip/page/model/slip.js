/** One slip from rest, as a function of the time since break-away: docs/theory.md (3). */

import { numbersOf } from "./friction.js";

/**
 * The responses of m y'' + c y' + k y = 0 at the time tau [s]: K to a unit impulse with its slope,
 * G = w^2 times its integral, H the integral of G.
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
  // Each rate's lag is its own closed form; so far apart rates cost no digits.
  const H = tau + Math.expm1(-slow * tau) / slow - slow * integralOfK(fast, slow, tau, K);
  return { K, slope, G, H };
}

/** The integral of K for two decaying rates: (1/slow)((1 - e^{-fast tau})/fast - K). */
function integralOfK(fast, slow, tau, K) {
  return (-Math.expm1(-fast * tau) / fast - K) / slow;
}

/**
 * Make the slip that starts from rest at break-away and is followed without end.
 *
 * @param {object} p a setting, SI
 * @returns {object}
 *   at(tau): displacement of the mass [m], x_dot [m/s], x_ddot [m/s^2], growth of the spring [m];
 *   overshoot: tau [s] and growth [m] where the spring is longest, null where it has no maximum;
 *   rate [rad/s] of the fastest change; fast, slow [1/s]: its two rates of decay; scale [s]: that
 *   of a swing, or of the slower decay
 */
export function slipFromRest(p) {
  const { Delta, w, zeta, lambda_ } = numbersOf(p);
  const a = zeta * w;
  const overdamped = !(a < w);
  const b = Math.sqrt(Math.abs((w - a) * (w + a)));
  const fast = overdamped ? a + b : a;
  const slow = overdamped ? (w * w) / fast : a;
  const oscillator = { w, a, b, fast, slow, overdamped };
  // Distance of the spring from where it would come to rest.
  const swing = Delta - (p.c * p.v) / p.k;
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

/** When the mass first has the speed of the pulled end, in units of 1/w; infinite if never. */
function timeOfPull(lambda_, zeta) {
  const nu = Math.sqrt(Math.abs((1 - zeta) * (1 + zeta)));
  if (zeta < 1) return Math.atan2(nu, lambda_ - zeta) / nu;
  const lead = lambda_ - zeta;
  if (!(lead > nu)) return Infinity;
  return nu > 0 ? Math.atanh(nu / lead) / nu : 1 / lead;
}
