/**
 * Sentences about stick-slip that are often said, as numbers: what each gives at a setting, and
 * what the exact cycle gives. docs/theory.md (6) to (14).
 */

import { criticalVelocity } from "./critical.js";
import { slipOnCurve } from "./curveslip.js";
import { simplified, steadyCycle } from "./cycle.js";
import { kineticInUse, numbersOf } from "./friction.js";
import { risingZero } from "./root.js";
import { regimesOf } from "./regimes.js";
import { slipFromRest } from "./slip.js";
import { march } from "./verlet.js";

/** The step of the script [s], the limit of hearing [Hz], and a light damping ratio [1]. */
const STEP = 1e-3;
const HEARING = 2e4;
const LIGHT = 0.03;

/** @type {(p: Setting, changes?: Partial<Setting>) => number} the jump of the mass [m] */
const jumpAt = (p, changes) => steadyCycle({ ...p, ...changes }).delta_x;

/** @type {(p: Setting, v?: number) => number} relative error of the simplified jump */
const offAt = (p, v = p.v) => simplified(p).delta_x / jumpAt(p, { v }) - 1;

/**
 * The numbers of each sentence by its name, SI; NaN where a cycle that is compared does not exist.
 *
 * @type {Record<string, (p: Setting, asked: number, curve: Curve) => Record<string, number>>}
 */
const CLAIMS = {
  jump(p) {
    const { delta_x: exact, spring_drop: spring } = steadyCycle(p);
    return { simplified: simplified(p).delta_x, exact, off: offAt(p), spring };
  },

  stick(p) {
    const first = simplified(p).t_stick;
    const exact = steadyCycle(p).t_stick;
    return { first, exact, factor: first / exact };
  },

  /** The simplified jump at this speed, at 2/5 and at 1/25 of it. */
  speed(p) {
    const [slow, middle, fast] = [p.v / 25, p.v / 2.5, p.v];
    const [off_slow, off_middle, off_fast] = [slow, middle, fast].map((v) => offAt(p, v));
    const { delta_x } = simplified(p);
    return { simplified: delta_x, slow, middle, fast, off_slow, off_middle, off_fast };
  },

  /** Both coefficients less by 0.2, or by all of the kinetic one. */
  friction(p) {
    const less = Math.min(0.2, p.mu_k);
    const other = { ...p, mu_s: p.mu_s - less, mu_k: p.mu_k - less };
    const [F_s, F_s_other] = [p, other].map((each) => numbersOf(each).F_s);
    return { exact: jumpAt(p), other: jumpAt(other), F_s, F_s_other };
  },

  /** A quarter of the gap, at this speed and at a twentieth of it. */
  gap(p) {
    const mu_k = p.mu_s - (p.mu_s - p.mu_k) / 4;
    const slow = p.v / 20;
    const [ratio, ratio_slow] = [p.v, slow].map((v) => jumpAt(p, { v }) / jumpAt(p, { v, mu_k }));
    return { v: p.v, slow, ratio, ratio_slow };
  },

  /** The same with a light damping: where that ends the cycle. */
  faster(p) {
    const { f, delta_x } = steadyCycle(p);
    const c = 2 * LIGHT * Math.sqrt(p.k * p.m);
    return { v: p.v, f, exact: delta_x, zeta: LIGHT, c, v_c: criticalVelocity({ ...p, c }) };
  },

  /** A fifth of the stiffness. */
  stiffer(p) {
    const exact = jumpAt(p);
    const before = jumpAt(p, { k: p.k / 5 });
    return { exact, before, ratio: exact / before };
  },

  /** By which factor of stiffness the undamped cycle, and the natural frequency, leave hearing. */
  audible(p) {
    const { f, lambda_ } = steadyCycle({ ...p, c: 0 });
    const wanted = Math.log(HEARING / f);
    // The period times w; with the stiffness, lambda falls as 1/sqrt(k) and the period by 1/k to
    // 1/sqrt(k).
    const turns = (/** @type {number} */ lambda) => 2 * (lambda + Math.PI - Math.atan(lambda));
    /** @type {(log: number) => [number, number]} of ln of the factor */
    const excess = (log) => {
      const lambda = lambda_ * Math.exp(-0.5 * log);
      const now = turns(lambda);
      const slope = 0.5 + lambda ** 3 / (1 + lambda ** 2) / now;
      return [0.5 * log + Math.log(turns(lambda_) / now) - wanted, slope];
    };
    const [low, high] = [wanted, 2 * wanted].sort((a, b) => a - b);
    const factor = Math.exp(risingZero(excess, low, high, 1.5 * wanted));
    return { f, limit: HEARING, natural: Math.exp(2 * wanted), factor };
  },

  /** The same contact on a quarter of the stiffness. */
  slope: (p) => ({ v_c: criticalVelocity(p), before: criticalVelocity({ ...p, k: p.k / 4 }) }),

  /** The ends of the two ranges in which it sticks, from a hundredth of this speed to ten times. */
  above(p, _, curve) {
    const regimes = regimesOf(p, curve, p.v / 100, 10 * p.v, 0.05);
    const [first, again, last] = regimes
      .filter(({ sticks }, n) => n && sticks !== regimes[n - 1].sticks)
      .map(({ low }) => low);
    return { first, again, last, v: p.v, exact: slipOnCurve(p, curve).cycle.delta_x };
  },

  /** How steeply the curve falls at first, and what damping would hold. */
  gapless(p, _, curve) {
    const [[, mu], [u, next]] = curve;
    const exact = slipOnCurve(p, curve).cycle.delta_x;
    return { slope: (mu - next) / u, held: p.c / numbersOf(p).N, exact };
  },

  condition: (p) => ({ slope: p.c / numbersOf(p).N }),

  /** How far off the script is, relative to the undamped cycle. */
  step(p) {
    const exact = steadyCycle({ ...p, c: 0 });
    const { break_away, ...run } = march(p, STEP);
    const off = Object.entries(run).map(([name, value]) => [
      name,
      value / exact[/** @type {keyof run} */ (name)] - 1,
    ]);
    const late = break_away / simplified(p).t_stick - 1;
    return { h: STEP, stick: exact.t_stick, break_away: late, ...Object.fromEntries(off) };
  },

  /** What would push the mass back at its break-away. */
  clamp(p, asked) {
    const { F_s, N } = numbersOf(p);
    return { asked, used: p.mu_k, F_s, asked_force: asked * N };
  },

  line(p) {
    const { growth, tau } = slipFromRest(p).overshoot ?? { growth: NaN, tau: NaN };
    return { F_s: numbersOf(p).F_s, over: p.k * growth, after: tau };
  },
};

/**
 * The numbers of a sentence, SI, ratios plain. The mu_k of the setting is as it is asked for, before
 * the clamp; a friction curve is of no influence where the sentence has none.
 * @type {(name: string, asked: Setting, curve: Curve) => Record<string, number>}
 */
export function claimed(name, asked, curve) {
  const p = { ...asked, mu_k: kineticInUse(asked.mu_s, asked.mu_k) };
  return CLAIMS[name](p, asked.mu_k, curve);
}
