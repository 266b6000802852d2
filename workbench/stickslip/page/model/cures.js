/**
 * What suppresses the cycle: each parameter alone, to halve the jump or to end the cycle,
 * docs/theory.md (6) to (14).
 */

import { jumpAlong, marginOf, zeroFrom, zerosAlong } from "./along.js";
import { criticalVelocity, limitJump, logCriticalLambda, slowJump, steadyCycle } from "./cycle.js";
import { numbersOf } from "./friction.js";

/** Steps of the mass [ln] on the way to its limit, which a load may bring twice. */
const STEP = 0.02;
/** A rounded value is this near to the limit. */
const NEAR_LIMIT = 0.02;

/** @type {(p: Setting) => Cures} what would halve the jump of a setting, and end its cycle */
export function curesOf(p) {
  const { N, w, zeta, lambda_ } = numbersOf(p);
  const { exists, delta_x } = steadyCycle(p);
  const v_c = criticalVelocity(p);
  if (!exists) return { jump: NaN, v_c, cures: [] };
  const damped = zeta > 0;
  const weight = p.m * p.g;
  // A lift leaves no normal force at a mass above 0.
  const lightest = Math.max(-p.load / weight, 0);

  /** @type {(parameter: Lever, value?: (factor: number) => number) => Way} what it changes by a factor */
  const by =
    (parameter, value = (factor) => p[parameter] * factor) =>
    (log) => ({ ...p, [parameter]: value(Math.exp(log)) });
  const stiffness = by("k");
  const mass = by("m");
  const gap = by("mu_k", (factor) => p.mu_s - (p.mu_s - p.mu_k) * factor);
  // Of a damping ratio, as there may be none now.
  const damping = by("c", (ratio) => ratio * (damped ? p.c / zeta : 2 * p.m * w));

  /**
   * A cure by its way: `end` is the logarithm at which the cycle ends, if it does; `last` that of the
   * range, without one it goes on downwards; `least` the jump there over that now.
   * @type {(name: CureName, parameter: Lever, way: Way, end: number | null, least?: number,
   *   last?: number) => Cure}
   */
  function cure(
    name,
    parameter,
    way,
    end,
    least = end === null ? 1 : limitJump(way(end)) / delta_x,
    last = end ?? NaN,
  ) {
    const excess = jumpAlong(way, least * delta_x, 0.5 * delta_x);
    const halve = least > 0.5 ? null : zeroFrom(excess, 0, last, -2 * Math.LN2);
    const [at, limit] = [halve, end].map((log) => (log === null ? null : way(log)[parameter]));
    return { name, parameter, now: p[parameter], halve: at, end: limit, least };
  }

  /** @type {(way: Way, step: number, from?: number) => number} where a way leaves the cycle */
  const endAlong = (way, step, from = 0) => zeroFrom((log) => marginOf(way(log)), from, NaN, step);

  function moreDamping() {
    // It never halves the jump: at the limit the period is above lambda + pi, and without damping it
    // is below twice that. Light damping ends a cycle of lambda = sqrt(4 pi zeta).
    const light = 2 * Math.log(Math.min(lambda_, 1)) - 6;
    return cure("damping", "c", damping, lambda_ > 0 ? endAlong(damping, 1, light) : -Infinity);
  }

  /** @type {(name: CureName, parameter: Lever, way: Way) => Cure} */
  function smallerGap(name, parameter, way) {
    const end = damped && lambda_ > 0 ? logCriticalLambda(zeta) - Math.log(lambda_) : null;
    // Without damping an end to the gap leaves a swing that touches rest.
    const swing = damped || lambda_ === 0 ? undefined : (2 * Math.PI * p.v) / w / delta_x;
    return cure(name, parameter, way, end, swing);
  }

  function lighter() {
    if (!damped) {
      // Towards m = 0 the slip takes no time; without normal force it is a swing.
      const relief = (2 * (p.mu_s - p.mu_k) * Math.max(p.load, 0)) / p.k;
      const least = (relief + (2 * Math.PI * p.v * Math.sqrt(lightest)) / w) / delta_x;
      return cure("lighter", "m", mass, null, least, lightest > 0 ? Math.log(lightest) : NaN);
    }
    // At the least mass it does not swing, or has no normal force.
    const to = Math.max(2 * Math.log(zeta), Math.log(lightest));
    return cure("lighter", "m", mass, zerosAlong((log) => marginOf(mass(log)), 0, to, STEP)[0] ?? 0);
  }

  return {
    jump: delta_x,
    v_c,
    cures: [
      // Without damping four times the stiffness leaves a half at most.
      damped
        ? cure("stiffer", "k", stiffness, endAlong(stiffness, 1))
        : cure("stiffer", "k", stiffness, null, 0, 2 * Math.LN2),
      cure("softer", "k", stiffness, damped ? endAlong(stiffness, -1) : null, 1),
      moreDamping(),
      cure("slower", "v", by("v"), null, slowJump(p) / delta_x),
      { ...cure("faster", "v", by("v"), null, 1), end: damped ? v_c : null },
      smallerGap("gap", "mu_k", gap),
      smallerGap("normal force", "load", by("load", (factor) => N * factor - weight)),
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
