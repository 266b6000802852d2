/**
 * What suppresses the cycle: each parameter alone, to halve the jump or to end the cycle,
 * docs/theory.md (6) to (14). In plain units of v and w a setting is lambda, zeta and the share of
 * the weight in the normal force.
 */

import { criticalVelocity, logCriticalLambda, logDepth } from "./critical.js";
import { grazingPeriod, plainPeriod, steadyCycle } from "./cycle.js";
import { numbersOf } from "./friction.js";
import { zeroBetween } from "./root.js";

/** @import { Setting } from "./friction.js" */

/** @typedef {"stiffer" | "softer" | "damping" | "slower" | "faster" | "gap" | "normal force" | "lighter"} CureName */

/**
 * One parameter changed in one direction, all others held.
 *
 * @typedef {object} Cure
 * @property {CureName} name
 * @property {"k" | "c" | "v" | "mu_k" | "load" | "m"} parameter what it changes: the gap by mu_k, the
 *   normal force by the load; the mass with the load held
 * @property {number} now the value in use [SI]
 * @property {number | null} halve the value at which the jump is half of what it is [SI]
 * @property {number | null} end the limit of the cycle: beyond it there is none [SI]
 * @property {number} least the smallest jump on this way over the jump now [1]; 1 where it grows
 */

/**
 * What suppresses the cycle of a setting.
 *
 * @typedef {object} Cures
 * @property {number} jump of the mass now [m], NaN without a cycle
 * @property {number} v_c critical velocity [m/s]
 * @property {Cure[]} cures none where there is no cycle
 */

/** Steps of the search for the mass at which v_c is smallest; it gains a digit in two of them. */
const DIPS = 60;
/** A rounded value is this near to the limit. */
const NEAR_LIMIT = 0.02;

/**
 * What would halve the jump of a setting, and what would end its cycle.
 *
 * @param {Setting} p
 * @returns {Cures}
 */
export function curesOf(p) {
  const { N, zeta, lambda_ } = numbersOf(p);
  const cycle = steadyCycle(p);
  const v_c = criticalVelocity(p);
  if (!cycle.exists) return { jump: NaN, v_c, cures: [] };
  const weight = p.m * p.g;
  const gap = p.mu_s - p.mu_k;
  const damped = zeta > 0;
  const whole = plainPeriod(lambda_, zeta);

  /** @type {(name: CureName, parameter: Cure["parameter"], halve: number | null, end: number | null, least: number) => Cure} */
  const cure = (name, parameter, halve, end, least) => ({
    name,
    parameter,
    now: p[parameter],
    halve,
    end,
    least,
  });
  /** @type {(number: number | null, value: (factor: number) => number) => number | null} */
  const by = (factor, value) => (factor === null ? null : value(factor));

  function stiffer() {
    // Lambda and zeta fall as one; lambda_c is above sqrt(4 pi zeta).
    const ray = lambda_ / zeta;
    const low = (4 * Math.PI) / (ray * ray);
    const limit = damped
      ? endOf((z) => ray * z, zeta, Math.min(low, zeta))
      : 0;
    const end = damped ? (zeta / limit) ** 2 : null;
    const least = damped ? (grazingPeriod(ray * limit, limit) / whole) * (limit / zeta) : 0;
    /** @type {(r: number) => number} */
    const jump = (r) => plainPeriod(lambda_ / Math.sqrt(r), zeta / Math.sqrt(r)) / whole / Math.sqrt(r);
    // Without damping four times the stiffness leaves a half at most.
    const halve = halvingFactor(jump, end ?? 4, least);
    return cure("stiffer", "k", by(halve, (r) => p.k * r), by(end, (r) => p.k * r), least);
  }

  function softer() {
    const ray = lambda_ / zeta;
    const end = damped
      ? p.k * (zeta / endOf((z) => ray * z, zeta, overdamped())) ** 2
      : null;
    return cure("softer", "k", null, end, 1);
  }

  /** A damping ratio at which there is no cycle with lambda below `2 lambda_/zeta`, as zeta < 1. */
  function overdamped() {
    const eta = Math.log1p((2 * lambda_) / zeta) / Math.PI;
    return Math.max(zeta, eta / Math.hypot(1, eta));
  }

  function damping() {
    const limit = dampingLimit(lambda_);
    const end = damped ? p.c * (limit / zeta) : 2 * limit * Math.sqrt(p.k * p.m);
    // It never halves the jump: at the limit the period is above lambda + pi, and without damping
    // it is below twice that.
    return cure("damping", "c", null, end, grazingPeriod(lambda_, limit) / whole);
  }

  function slower() {
    const decay = damped ? Math.exp((-Math.PI * zeta) / Math.sqrt((1 - zeta) * (1 + zeta))) : 1;
    const least = (lambda_ * (1 + decay)) / whole;
    const halve = halvingFactor((r) => (plainPeriod(lambda_ / r, zeta) / whole) * r, 0, least);
    return cure("slower", "v", by(halve, (r) => p.v * r), null, least);
  }

  /** @type {(name: CureName, parameter: Cure["parameter"], value: (factor: number) => number) => Cure} */
  function smallerGap(name, parameter, value) {
    if (lambda_ === 0) return cure(name, parameter, null, null, 1);
    const critical = damped ? Math.exp(logCriticalLambda(zeta)) : 0;
    // Without damping an end to the gap leaves a swing that touches rest.
    const least = (damped ? grazingPeriod(critical, zeta) : 2 * Math.PI) / whole;
    const end = damped ? critical / lambda_ : null;
    const halve = halvingFactor((r) => plainPeriod(lambda_ * r, zeta) / whole, end ?? 0, least);
    return cure(name, parameter, by(halve, value), by(end, value), least);
  }

  function lighter() {
    const part = weight / N;
    const rest = p.load / N;
    /** @type {(r: number) => number} lambda at a part r of the mass */
    const ofLighter = (r) => (lambda_ * Math.max(part * r + rest, 0)) / Math.sqrt(r);
    // A lift leaves no normal force at a mass above 0.
    const lightest = Math.max(-rest / part, 0);
    /** @type {(r: number) => number} */
    const jump = (r) => (plainPeriod(ofLighter(r), zeta / Math.sqrt(r)) / whole) * Math.sqrt(r);
    if (!damped) {
      // Towards m = 0 the slip takes no time; without normal force it is a swing.
      const relief = 2 * lambda_ * Math.max(rest, 0);
      const least = (relief + 2 * Math.PI * Math.sqrt(lightest)) / whole;
      return cure("lighter", "m", by(halvingFactor(jump, lightest, least), (r) => p.m * r), null, least);
    }
    /** @type {(z: number) => number} lambda at the mass that has a damping ratio */
    const path = (z) => ofLighter((zeta / z) ** 2);
    const dip = dipOf(zeta, rest / part);
    const last = lightest > 0 ? zeta / Math.sqrt(lightest) : 1;
    const limit =
      dip > zeta && plainDepth(path(dip), dip) < 0
        ? endOf(path, zeta, dip)
        : endOf(path, Math.max(zeta, dip), Math.min(overdamped(), last));
    const end = (zeta / limit) ** 2;
    const least = (grazingPeriod(path(limit), limit) / whole) * (zeta / limit);
    const halve = halvingFactor(jump, end, least);
    return cure("lighter", "m", by(halve, (r) => p.m * r), p.m * end, least);
  }

  return {
    jump: cycle.delta_x,
    v_c,
    cures: [
      stiffer(),
      softer(),
      damping(),
      slower(),
      cure("faster", "v", null, damped ? v_c : null, 1),
      smallerGap("gap", "mu_k", (r) => p.mu_s - gap * r),
      smallerGap("normal force", "load", (r) => N * r - weight),
      lighter(),
    ],
  };
}

/**
 * The value of a parameter just beyond the limit of the cycle, with as few digits as do it.
 *
 * @param {Setting} p
 * @param {Cure} cure
 * @param {number} end its limit [SI]
 * @returns {number} [SI]
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

/** @type {(lambda_: number, zeta: number) => number} the cycle exists where it is 0 or more */
function plainDepth(lambda_, zeta) {
  return logDepth(Math.log(lambda_), zeta, Math.sqrt((1 - zeta) * (1 + zeta)))[0];
}

/**
 * The damping ratio at which a path through lambda and zeta leaves the cycle.
 *
 * @param {(zeta: number) => number} path lambda at a damping ratio [1]
 * @param {number} inside a damping ratio with a cycle
 * @param {number} outside one without, of the path too
 * @returns {number} [1]
 */
function endOf(path, inside, outside) {
  // In ln eta, eta = zeta/nu: both ends, zeta -> 0 and zeta -> 1, lie far away.
  /** @type {(zeta: number) => number} */
  const toLog = (zeta) => Math.log(zeta) - 0.5 * Math.log1p(-zeta * zeta);
  /** @type {(log: number) => number} */
  const toZeta = (log) => 1 / Math.hypot(1, Math.exp(-log));
  return toZeta(
    zeroBetween((log) => plainDepth(path(toZeta(log)), toZeta(log)), toLog(inside), toLog(outside)),
  );
}

/**
 * The damping ratio at which the cycle with a lambda ends.
 *
 * @param {number} lambda_ w Delta/v [1]
 * @returns {number} [1]
 */
function dampingLimit(lambda_) {
  if (lambda_ === 0) return 0;
  // The depth falls with eta = zeta/nu, by pi to 2 pi for each unit.
  const most = 0.5 * Math.log1p(lambda_ * lambda_);
  /** @type {(eta: number) => number} */
  const toZeta = (eta) => eta / Math.hypot(1, eta);
  const eta = zeroBetween(
    (each) => plainDepth(lambda_, toZeta(each)),
    most / (2.001 * Math.PI),
    most / (0.999 * Math.PI),
  );
  return toZeta(eta);
}

/**
 * The damping ratio at which v_c over the mass has a minimum, with a load; 0 where it has none.
 *
 * There e(zeta) = 2/(1 + X), where e is the logarithmic slope of v_c c/Delta_F over zeta and X the
 * load over the weight. As e falls with zeta, X rises from 3 to its first solution.
 *
 * @param {number} zeta damping ratio now [1]
 * @param {number} ratio load over weight now [1]
 * @returns {number} [1]
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
 *
 * @param {number} zeta damping ratio [1]
 */
function slopeOfCritical(zeta) {
  const nu = Math.sqrt((1 - zeta) * (1 + zeta));
  const inverse = Math.exp(-logCriticalLambda(zeta));
  const theta = Math.atan2(nu, inverse - zeta);
  const turn = 2 * Math.PI - theta + Math.sin(theta) * Math.cos(theta);
  return 1 - (zeta * turn * ((1 - zeta * inverse) ** 2 + (nu * inverse) ** 2)) / nu ** 3;
}

/**
 * The factor on a parameter at which the jump is half of what it is.
 *
 * @param {(factor: number) => number} jump over the jump now [1]
 * @param {number} last factor to which the cycle exists or the range goes; 0: a range down to 0
 * @param {number} least the jump there over the jump now [1]
 * @returns {number | null}
 */
function halvingFactor(jump, last, least) {
  if (least > 0.5) return null;
  // In ln of both, where they are nearly linear.
  /** @type {(log: number) => number} */
  const excess = (log) => {
    const part = jump(Math.exp(log));
    return Math.log(2 * (Number.isNaN(part) ? least : part));
  };
  let low = last > 0 ? Math.log(last) : -2 * Math.LN2;
  while (!(last > 0) && excess(low) > 0 && low > -700) low *= 2;
  return Math.exp(zeroBetween(excess, 0, low));
}
