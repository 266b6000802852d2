/** The linear motion between two events, as a function of the time: docs/theory.md (3). */

/**
 * The responses of an oscillator to a unit impulse, tau [s] after it: K, the impulse response [s],
 * and its slope [1]; G, w^2 times the integral of K [1]; H, the integral of G [s].
 * @type {(oscillator: Oscillator, tau: number) => {K: number, slope: number, G: number, H: number}}
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
