/**
 * The whole motion of a mass that starts at rest on a relaxed spring: a first load-up, then the
 * steady cycle for ever, or one slip without end. docs/theory.md (6), (10), (13).
 *
 * Any instant is reached at once and not from the one before, so nothing adds up over the cycles.
 */

import { coefficientAt, isFlat, numbersOf } from "./friction.js";
import { slipOf } from "./slip.js";
import { twofoldOver, twofoldPlus, twofoldTimes, twoProduct, twoSum } from "./twofold.js";

/** @type {(p: Setting, curve?: Curve | null) => Motion} a curve takes the place of mu_k */
export function motionOf(p, curve = null) {
  const used = curve ? { ...p, mu_k: curve[0][1] } : p;
  /** @type {Curve} */
  const points = curve && !isFlat(curve) ? curve : [[0, used.mu_k]];
  const numbers = numbersOf(used);
  const { cycle, slip } = slipOf(used, points);
  const date = datesOf(used, cycle, points.length === 1 && cycle.zeta === 0);
  /** @type {(speed: number) => number} kinetic friction [N] */
  const kinetic = (speed) => coefficientAt(points, Math.abs(speed)) * numbers.N;
  const z_s = numbers.F_s / p.k;

  /** @type {(n: number) => number} the time [s] of the break-away after n slips */
  const breakAway = (n) => date(n)[0];
  const first = breakAway(0);
  /** @type {(n: number) => number} the time [s] at which the slip after n others ends */
  const reStick = (n) => breakAway(n) + cycle.t_slip;
  /** @type {(t: number, n: number) => number} from the break-away after n slips to t [s] */
  const sinceBreakAway = (t, n) => {
    const [high, low] = date(n);
    return t - high - low;
  };
  /** @type {(n: number) => number} position of the mass in the stick after n slips [m] */
  const positionBefore = (n) => (n === 0 ? 0 : n * cycle.delta_x);

  /** @type {Motion["sticking"]} */
  function sticking(t, n, left) {
    const z = n === 0 ? p.v * t : z_s - p.v * left;
    const x = positionBefore(n);
    const F = p.k * z;
    const forces = { F, F_dot: p.k * p.v, F_friction: -F };
    return { t, mode: 0, x, x_dot: 0, x_ddot: 0, x_pull: x + z, z, ...forces };
  }

  /** @type {Motion["slipping"]} */
  function slipping(t, n, tau) {
    const { displacement, x_dot, x_ddot, growth, mode = 1 } = slip.at(tau);
    // A re-stick is at rest to the last bit; rounding must not show a mass that goes back.
    const speed = mode * Math.max(mode * x_dot, 0);
    const x = positionBefore(n) + displacement;
    const z = z_s + growth;
    const F = numbers.F_s + p.k * growth;
    const F_friction = -(mode * kinetic(speed) + p.c * speed);
    const forces = { F, F_dot: p.k * (p.v - speed), F_friction };
    return { t, mode, x, x_dot: speed, x_ddot, x_pull: x + z, z, ...forces };
  }

  /** @type {(t: number) => number} break-aways before t [s], less one; t is after the first */
  function lastBreakAway(t) {
    if (!cycle.exists) return 0;
    let n = Math.max(Math.floor((t - first) / cycle.T), 0);
    // The quotient may be off by one; the mass still sticks at the very time of a break-away.
    if (n > 0 && sinceBreakAway(t, n) <= 0) n -= 1;
    if (sinceBreakAway(t, n + 1) > 0) n += 1;
    return n;
  }

  /** @type {Motion["at"]} */
  function at(t) {
    const sinceFirst = sinceBreakAway(t, 0);
    if (sinceFirst <= 0) return sticking(t, 0, -sinceFirst);
    const n = lastBreakAway(t);
    const tau = sinceBreakAway(t, n);
    if (!cycle.exists || tau < cycle.t_slip) return slipping(t, n, tau);
    return sticking(t, n + 1, Math.max(-sinceBreakAway(t, n + 1), 0));
  }

  /** @type {(from: number, to: number) => Generator<Phase>} */
  function* phases(from, to) {
    if (from < first) yield { kind: "stick", n: 0, start: 0, end: first };
    if (to <= first) return;
    if (!cycle.exists) {
      yield { kind: "slip", n: 0, start: first, end: Infinity };
      return;
    }
    for (let n = from > first ? lastBreakAway(from) : 0; breakAway(n) < to; n++) {
      if (reStick(n) > from) yield { kind: "slip", n, start: breakAway(n), end: reStick(n) };
      if (reStick(n) < to && breakAway(n + 1) > from && cycle.t_stick > 0) {
        yield { kind: "stick", n: n + 1, start: reStick(n), end: breakAway(n + 1) };
      }
    }
  }

  /** @type {(from: number, to: number) => Generator<Transition>} */
  function* events(from, to) {
    for (let n = from > first ? lastBreakAway(from) : 0; breakAway(n) <= to; n++) {
      if (breakAway(n) >= from) yield { t: breakAway(n), kind: "break-away" };
      const end = reStick(n);
      if (end >= from && end <= to) yield { t: end, kind: "re-stick" };
    }
  }

  // What repeats, or where nothing does, how long a swing or the decay of the slip takes.
  const beat = cycle.exists ? cycle.T : slip.scale;
  const z_even = (kinetic(p.v) + p.c * p.v) / p.k;
  const found = { p, curve, numbers, cycle, slip, first, beat, z_s, z_even };
  return { ...found, at, sticking, slipping, phases, events };
}

/**
 * When [s] the mass breaks away after n slips: (6), and every period from then on, in twice the
 * digits. Undamped: under constant friction, without damping.
 * @type {(p: Setting, cycle: Cycle, undamped: boolean) => (n: number) => Twofold}
 */
function datesOf({ m, g, load, k, mu_s, mu_k, v }, cycle, undamped) {
  const rate = twoProduct(k, v);
  const normal = twofoldPlus(twoProduct(m, g), [load, 0]);
  const first = twofoldOver(twofoldTimes(normal, mu_s), rate);
  // Without damping the stick is as long as the gap takes to load up, twice: (9).
  const gap = twoSum(mu_s, -mu_k);
  const climb = twofoldPlus(twofoldTimes(normal, gap[0]), [normal[0] * gap[1], 0]);
  /** @type {Twofold} */
  const stick = undamped ? twofoldTimes(twofoldOver(climb, rate), 2) : [cycle.t_stick, 0];
  const period = twofoldPlus(stick, [cycle.t_slip, 0]);
  return (n) => (n === 0 ? first : twofoldPlus(first, twofoldTimes(period, n)));
}
