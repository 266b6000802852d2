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

/**
 * @import { Curve } from "./curve.js"
 * @import { Setting } from "./friction.js"
 */

/** The step of the script [s], the limit of hearing [Hz], and a light damping ratio [1]. */
const STEP = 1e-3;
const HEARING = 2e4;
const LIGHT = 0.03;

/**
 * The numbers of each sentence by its name, SI; NaN where a cycle that is compared does not exist.
 *
 * @type {Record<string, (p: Setting, asked: number, curve: Curve) => Record<string, number>>}
 */
const CLAIMS = {
  jump: (p) => ({ ...jumpOf(p), spring: steadyCycle(p).spring_drop }),

  stick: (p) => {
    const first = simplified(p).t_stick;
    const exact = steadyCycle(p).t_stick;
    return { first, exact, factor: first / exact };
  },

  /** The simplified jump at this speed, at 2/5 and at 1/25 of it. */
  speed: (p) => {
    const [slow, middle] = [p.v / 25, p.v / 2.5];
    const off = (/** @type {number} */ v) => jumpOf({ ...p, v }).off;
    return {
      simplified: simplified(p).delta_x,
      slow,
      middle,
      fast: p.v,
      off_slow: off(slow),
      off_middle: off(middle),
      off_fast: off(p.v),
    };
  },

  /** Both coefficients less by 0.2, or by all of the kinetic one. */
  friction: (p) => {
    const less = Math.min(0.2, p.mu_k);
    const other = { ...p, mu_s: p.mu_s - less, mu_k: p.mu_k - less };
    return {
      exact: jumpAt(p),
      other: jumpAt(other),
      F_s: numbersOf(p).F_s,
      F_s_other: numbersOf(other).F_s,
    };
  },

  /** A quarter of the gap, at this speed and at a twentieth of it. */
  gap: (p) => {
    const mu_k = p.mu_s - (p.mu_s - p.mu_k) / 4;
    const slow = p.v / 20;
    const ratio = (/** @type {number} */ v) => jumpAt({ ...p, v }) / jumpAt({ ...p, v, mu_k });
    return { v: p.v, slow, ratio: ratio(p.v), ratio_slow: ratio(slow) };
  },

  /** The same with a light damping: where that ends the cycle. */
  faster: (p) => {
    const { f, delta_x } = steadyCycle(p);
    const c = 2 * LIGHT * Math.sqrt(p.k * p.m);
    return { v: p.v, f, exact: delta_x, zeta: LIGHT, c, v_c: criticalVelocity({ ...p, c }) };
  },

  /** A fifth of the stiffness. */
  stiffer: (p) => {
    const exact = jumpAt(p);
    const before = jumpAt({ ...p, k: p.k / 5 });
    return { exact, before, ratio: exact / before };
  },

  /** By which factor of stiffness the undamped cycle, and the natural frequency, leave hearing. */
  audible: (p) => {
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
    const [low, high] = [Math.min(wanted, 2 * wanted), Math.max(wanted, 2 * wanted)];
    return {
      f,
      limit: HEARING,
      natural: Math.exp(2 * wanted),
      factor: Math.exp(risingZero(excess, low, high, 1.5 * wanted)),
    };
  },

  /** The same contact on a quarter of the stiffness. */
  slope: (p) => ({ v_c: criticalVelocity(p), before: criticalVelocity({ ...p, k: p.k / 4 }) }),

  /** The ends of the two ranges in which it sticks, from a hundredth of this speed to ten times. */
  above: (p, _, curve) => {
    const regimes = regimesOf(p, curve, p.v / 100, 10 * p.v, 0.05);
    const [first, again, last] = regimes
      .filter(({ sticks }, n) => n && sticks !== regimes[n - 1].sticks)
      .map(({ low }) => low);
    return { first, again, last, v: p.v, exact: slipOnCurve(p, curve).cycle.delta_x };
  },

  /** How steeply the curve falls at first, and what damping would hold. */
  gapless: (p, _, curve) => {
    const [[, mu], [u, next]] = curve;
    const exact = slipOnCurve(p, curve).cycle.delta_x;
    return { slope: (mu - next) / u, held: p.c / numbersOf(p).N, exact };
  },

  condition: (p) => ({ slope: p.c / numbersOf(p).N }),

  /** How far off the script is, relative to the undamped cycle. */
  step: (p) => {
    const run = march(p, STEP);
    const { t_slip, t_stick, T, delta_x } = steadyCycle({ ...p, c: 0 });
    return {
      h: STEP,
      stick: t_stick,
      break_away: run.break_away / simplified(p).t_stick - 1,
      t_slip: run.t_slip / t_slip - 1,
      t_stick: run.t_stick / t_stick - 1,
      T: run.T / T - 1,
      delta_x: run.delta_x / delta_x - 1,
    };
  },

  /** What would push the mass back at its break-away. */
  clamp: (p, asked) => ({
    asked,
    used: p.mu_k,
    F_s: numbersOf(p).F_s,
    asked_force: asked * numbersOf(p).N,
  }),

  line: (p) => {
    const overshoot = slipFromRest(p).overshoot;
    return {
      F_s: numbersOf(p).F_s,
      over: overshoot ? p.k * overshoot.growth : NaN,
      after: overshoot ? overshoot.tau : NaN,
    };
  },
};

/**
 * The numbers of a sentence.
 *
 * @param {string} name of the sentence
 * @param {Setting} asked its mu_k as it is asked for, before the clamp
 * @param {Curve} curve its friction curve, of no influence where it has none
 * @returns {Record<string, number>} SI, ratios plain
 */
export function claimed(name, asked, curve) {
  const p = { ...asked, mu_k: kineticInUse(asked.mu_s, asked.mu_k) };
  return CLAIMS[name](p, asked.mu_k, curve);
}

/**
 * The jump of the mass [m].
 *
 * @param {Setting} p
 * @returns {number}
 */
function jumpAt(p) {
  return steadyCycle(p).delta_x;
}

/**
 * The jump [m], as designers write it and exactly, and the relative error of the first.
 *
 * @param {Setting} p
 * @returns {{simplified: number, exact: number, off: number}}
 */
function jumpOf(p) {
  const [simple, exact] = [simplified(p).delta_x, jumpAt(p)];
  return { simplified: simple, exact, off: simple / exact - 1 };
}
