/**
 * What suppresses the cycle: each parameter alone, to halve the jump or to end the cycle,
 * docs/theory.md (6) to (14). In plain units of v and w a setting is lambda, zeta and the share of
 * the weight in the normal force.
 */

import { endAlong, jumpAlong, plainDepth } from "./along.js";
import { criticalVelocity, logCriticalLambda } from "./critical.js";
import { grazingPeriod, plainPeriod, steadyCycle } from "./cycle.js";
import { nuOf, numbersOf } from "./friction.js";

/** Steps of the search for the mass at which v_c is smallest; it gains a digit in two of them. */
const DIPS = 60;
/** A rounded value is this near to the limit. */
const NEAR_LIMIT = 0.02;

/** @type {(p: Setting) => Cures} what would halve the jump of a setting, and end its cycle */
export function curesOf(p) {
  const { N, zeta, lambda_ } = numbersOf(p);
  const { exists, delta_x } = steadyCycle(p);
  const v_c = criticalVelocity(p);
  if (!exists) return { jump: NaN, v_c, cures: [] };
  const damped = zeta > 0;
  const whole = plainPeriod(lambda_, zeta);
  const weight = p.m * p.g;
  const [part, rest] = [weight / N, p.load / N];
  // A lift leaves no normal force at a mass above 0.
  const lightest = Math.max(-rest / part, 0);

  // What changes by the factor exp(log), jumps in units of the one now.
  /** @type {Way} */
  const stiffness = (log) => {
    const root = Math.exp(-0.5 * log);
    return [lambda_ * root, zeta * root, root / whole];
  };
  /** @type {Way} */
  const speed = (log) => [lambda_ / Math.exp(log), zeta, Math.exp(log) / whole];
  /** @type {Way} */
  const gap = (log) => [lambda_ * Math.exp(log), zeta, 1 / whole];
  /** @type {Way} */
  const mass = (log) => {
    const root = Math.exp(0.5 * log);
    const force = Math.max(part * root * root + rest, 0);
    return [(lambda_ * force) / root, zeta / root, root / whole];
  };
  /** @type {Way} of a damping ratio, as there may be none now */
  const damping = (log) => [lambda_, Math.exp(log), 1 / whole];
  /** @type {(way: Way, log: number | null) => number} the jump where the cycle ends, over that now */
  const leastAt = (way, log) => {
    if (log === null) return 1;
    const [lambda, ratio, unit] = way(log);
    return unit * grazingPeriod(lambda, ratio);
  };

  /**
   * A cure by its way: `end` is the logarithm at which the cycle ends, if it does; `last` that of the
   * range, without one it goes on downwards; `least` the jump there.
   *
   * @param {CureName} name
   * @param {Lever} parameter
   * @param {Way} way
   * @param {number | null} end
   * @returns {Cure}
   */
  function cure(
    name,
    parameter,
    way,
    end,
    least = leastAt(way, end),
    last = end ?? NaN,
    value = (/** @type {number} */ factor) => p[parameter] * factor,
  ) {
    const halve = least > 0.5 ? null : jumpAlong(way, 0.5, least, 0, last, -2 * Math.LN2);
    const [at, limit] = [halve, end].map((log) => (log === null ? null : value(Math.exp(log))));
    return { name, parameter, now: p[parameter], halve: at, end: limit, least };
  }

  function stiffer() {
    // Lambda and zeta fall as one; lambda_c is above sqrt(4 pi zeta).
    const far = Math.max(2 * Math.log((lambda_ * lambda_) / (4 * Math.PI * zeta)), 0);
    const end = damped ? endAlong(stiffness, 0, far) : null;
    // Without damping four times the stiffness leaves a half at most.
    return damped
      ? cure("stiffer", "k", stiffness, end)
      : cure("stiffer", "k", stiffness, null, 0, 2 * Math.LN2);
  }

  function softer() {
    const end = damped ? endAlong(stiffness, 0, 2 * Math.log(zeta)) : null;
    return cure("softer", "k", stiffness, end, 1);
  }

  function moreDamping() {
    // The depth falls with eta = zeta/nu, by pi to 2 pi for each unit. It never halves the jump: at
    // the limit the period is above lambda + pi, and without damping it is below twice that.
    const most = 0.5 * Math.log1p(lambda_ * lambda_) / Math.PI;
    const [inside, outside] = [most / 2.001, most / 0.999].map((eta) =>
      Math.log(eta / Math.hypot(1, eta)),
    );
    const end = lambda_ > 0 ? endAlong(damping, inside, outside) : -Infinity;
    const unit = damped ? p.c / zeta : 2 * Math.sqrt(p.k * p.m);
    return cure("damping", "c", damping, end, leastAt(damping, end), end, (ratio) => unit * ratio);
  }

  function slower() {
    const decay = damped ? Math.exp((-Math.PI * zeta) / nuOf(zeta)) : 1;
    return cure("slower", "v", speed, null, (lambda_ * (1 + decay)) / whole);
  }

  /** @type {(name: CureName, parameter: Lever, value: (factor: number) => number) => Cure} */
  function smallerGap(name, parameter, value) {
    const end = damped && lambda_ > 0 ? logCriticalLambda(zeta) - Math.log(lambda_) : null;
    // Without damping an end to the gap leaves a swing that touches rest.
    const least = damped || lambda_ === 0 ? leastAt(gap, end) : (2 * Math.PI) / whole;
    return cure(name, parameter, gap, end, least, end ?? NaN, value);
  }

  function lighter() {
    if (!damped) {
      // Towards m = 0 the slip takes no time; without normal force it is a swing.
      const relief = 2 * lambda_ * Math.max(rest, 0);
      const least = (relief + 2 * Math.PI * Math.sqrt(lightest)) / whole;
      return cure("lighter", "m", mass, null, least, lightest > 0 ? Math.log(lightest) : NaN);
    }
    /** @type {(ratio: number) => number} ln of the part of the mass that has a damping ratio */
    const at = (ratio) => 2 * Math.log(zeta / ratio);
    const dip = dipOf(zeta, rest / part);
    const isShort = dip > zeta && plainDepth(mass(at(dip))[0], dip) < 0;
    const end = isShort
      ? endAlong(mass, 0, at(dip))
      : endAlong(mass, at(Math.max(zeta, dip)), Math.max(at(1), Math.log(lightest)));
    return cure("lighter", "m", mass, end);
  }

  return {
    jump: delta_x,
    v_c,
    cures: [
      stiffer(),
      softer(),
      moreDamping(),
      slower(),
      { ...cure("faster", "v", speed, null, 1), end: damped ? v_c : null },
      smallerGap("gap", "mu_k", (factor) => p.mu_s - (p.mu_s - p.mu_k) * factor),
      smallerGap("normal force", "load", (factor) => N * factor - weight),
      lighter(),
    ],
  };
}

/**
 * The value [SI] of a parameter just beyond the limit `end` of the cycle, with as few digits as do it.
 * @type {(p: Setting, cure: Cure, end: number) => number}
 */
export function valueBeyond(p, { name, parameter, now }, end) {
  // The gap and the normal force are what is rounded, not mu_k and the load.
  const part = { gap: p.mu_s, "normal force": -p.m * p.g }[/** @type {string} */ (name)] ?? 0;
  const sign = name === "gap" ? -1 : 1;
  // Without a gap any damping ends it.
  const limit = sign * (end - part) || 2e-3 * Math.sqrt(p.k * p.m);
  const up = sign * (end - now) >= 0;
  for (let count = 2; count < 17; count++) {
    const unit = 10 ** (Math.floor(Math.log10(limit)) - count + 1);
    const rounded = (up ? Math.ceil(limit / unit) : Math.floor(limit / unit)) * unit;
    const value = Number((part + sign * rounded).toPrecision(15));
    const isNear = Math.abs(rounded / limit - 1) <= NEAR_LIMIT;
    if (isNear && !steadyCycle({ ...p, [parameter]: value }).exists) return value;
  }
  // A double of mu_k may not tell so small a gap, nor one of the load so small a rest of force.
  return part || end;
}

/**
 * The damping ratio at which v_c over the mass has a minimum, with a load of `ratio` times the
 * weight; 0 where it has none.
 *
 * There e(zeta) = 2/(1 + X), where e is the logarithmic slope of v_c c/Delta_F over zeta and X the
 * load over the weight. As e falls with zeta, X rises from 3 to its first solution.
 *
 * @type {(zeta: number, ratio: number) => number}
 */
function dipOf(zeta, ratio) {
  if (!(ratio > 0)) return 0;
  let X = 3;
  let here = 0;
  for (let step = 0; step < DIPS; step++) {
    const next = zeta * Math.sqrt(X / ratio);
    if (next === here) break;
    here = next;
    const slope = here < 1 ? slopeOfCritical(here) : 0;
    if (!(slope > 0)) return 0;
    X = 2 / slope - 1;
  }
  return here;
}

/**
 * Logarithmic slope of v_c c/Delta_F = 2 zeta/lambda_c over zeta, from the derivatives of (13).
 * @type {(zeta: number) => number}
 */
function slopeOfCritical(zeta) {
  const nu = nuOf(zeta);
  const inverse = Math.exp(-logCriticalLambda(zeta));
  const theta = Math.atan2(nu, inverse - zeta);
  const turn = 2 * Math.PI - theta + Math.sin(theta) * Math.cos(theta);
  return 1 - (zeta * turn * ((1 - zeta * inverse) ** 2 + (nu * inverse) ** 2)) / nu ** 3;
}
