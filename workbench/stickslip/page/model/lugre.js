/**
 * The cycle of a block on LuGre's bristles: docs/theory.md (33), (34). Its motion is integrated by the
 * linearly implicit Euler method, extrapolated, with the rules of the native FMU: no stride steps over
 * a break-away, and one ends where the velocity changes its sign, as |x_dot| has a kink there.
 *
 * E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, IV.9.
 */

import { numbersOf } from "./friction.js";

/** Errors of a stride, relative. A slow velocity, which bristles damp, may err by so much more. */
const TOLERANCE = 1e-10;
const SLOW = 1e5;
/** Rows of the table of extrapolation: the first has two sub-steps, each other one more. */
const ROWS = 7;
/** A stride aims at this part of the tolerance, and is so many times the last one at most. */
const AIM = 0.3;
const MOST_CHANGE = 8;
/** A stride lets a velocity rise and, from above v_s, fall by no more than these factors. */
const MOST_RISE = 30;
const MOST_FALL = 4;
/** Tables of extrapolation in a run, some 0.2 s of work; and the tables of a zero. */
const MOST_TABLES = 30000;
const ZERO_TABLES = 4;
/** A cycle is steady where its state comes back to this part of the spring's fall, and of F_s/k. */
const STEADY = 1e-8;
const NOISE = 1e-9;
/** Falls that differ by less than this part become equal; while bristles ring a cycle has several. */
const ALIKE = 1e-3;
/** Even sliding, if stable, is reached at this part of v; what is unstable is lost at that one. */
const CALM = 1e-3;
const TOO_NEAR = 1e-6;
/** Points of a cycle as it is shown, about. */
const SHOWN_POINTS = 600;
/** Friction is at least this part of the weight. */
const LEAST_FRICTION = 1e-12;

/** @typedef {[z: number, x_dot: number, zeta: number]} Unknowns [m], [m/s], [m] */
/** @typedef {{t: number, from: Unknowns, way: number, length: number}} Stride way: sign of x_dot */
/** @typedef {Setting & Bristles & Numbers & {floor: number, creep: number, fast: number}} Block */

/** @type {(p: Setting, own: Bristles) => Block} with least friction [N] and scales of velocity [m/s] */
function blockOf(p, own) {
  const numbers = numbersOf(p);
  const { F_s } = numbers;
  const creep = Math.max((p.k * p.v) / own.sigma_0, (1e-6 * F_s) / Math.sqrt(p.m * own.sigma_0));
  const fast = Math.max(p.v, F_s / Math.sqrt(p.m * p.k));
  return { ...p, ...own, ...numbers, floor: LEAST_FRICTION * p.m * p.g, creep, fast };
}

/** @type {(block: Block, y: Unknowns, way: number) => Record<string, number>} rates, and their parts */
function fieldAt({ k, m, c, F_s, F_k, floor, sigma_0, sigma_1, v_s }, [z, u, zeta], way) {
  const ratio = u / v_s;
  const fall = (F_s - F_k) * Math.exp(-ratio * ratio);
  const g = Math.max(F_k + fall, floor);
  const wear = (sigma_0 * way * u) / g;
  const bending = u - wear * zeta;
  const friction = sigma_0 * zeta + sigma_1 * bending + c * u;
  return { g, fall, wear, bending, friction, x_ddot: (k * z - friction) / m };
}

/**
 * The slopes of x_ddot over z, x_dot and zeta, and of the bending over x_dot and zeta.
 * @type {(block: Block, y: Unknowns, way: number) => number[]}
 */
function slopesAt(block, y, way) {
  const { k, m, c, floor, sigma_0, sigma_1, v_s } = block;
  const { g, fall, wear } = fieldAt(block, y, way);
  const slope = g > floor ? ((-2 * fall) / v_s) * (y[1] / v_s) : 0;
  const bend = 1 - ((way * sigma_0 * y[2]) / g) * (1 - (y[1] * slope) / g);
  return [k / m, -(sigma_1 * bend + c) / m, -(sigma_0 - sigma_1 * wear) / m, bend, -wear];
}

/** @type {(block: Block, stride: Stride, slopes: number[], count: number) => Unknowns} in sub-steps */
function march(block, { from, way, length }, [a, b, c, d, e], count) {
  const { k, v, m, F_s, F_k, floor, sigma_0, sigma_1, v_s } = block;
  const h = length / count;
  const last = h / (1 - h * e);
  const pivot = h / (1 - h * (b - h * a + c * d * last));
  let [z, u, zeta] = from;
  for (let n = 0; n < count; n++) {
    // As fieldAt has it, which would take twice the time.
    const ratio = u / v_s;
    const g = Math.max(F_k + (F_s - F_k) * Math.exp(-ratio * ratio), floor);
    const bending = u - ((sigma_0 * way * u) / g) * zeta;
    const x_ddot = (k * z - sigma_0 * zeta - sigma_1 * bending - block.c * u) / m;
    const du = pivot * (x_ddot + h * a * (v - u) + c * last * bending);
    z += h * (v - u - du);
    zeta += last * (bending + d * du);
    u += du;
  }
  return [z, u, zeta];
}

/** @type {(block: Block, stride: Stride) => Unknowns[]} where a stride leads to; and by one row less */
function extrapolated(block, stride) {
  const slopes = slopesAt(block, stride.from, stride.way);
  /** @type {Unknowns[]} */
  const line = [];
  let less = stride.from;
  for (let row = 0; row < ROWS; row++) {
    let entry = march(block, stride, slopes, row + 2);
    for (let column = 0; column < row; column++) {
      const kept = line[column];
      line[column] = less = entry;
      const part = (row + 1 - column) / (column + 1);
      const [z, u, zeta] = entry;
      entry = [z + (z - kept[0]) * part, u + (u - kept[1]) * part, zeta + (zeta - kept[2]) * part];
    }
    line[row] = entry;
  }
  return [line[ROWS - 1], less];
}

/** @type {(block: Block, stride: Stride, tau: number) => Unknowns} tau [s] after the start of a stride */
const within = (block, stride, tau) =>
  tau === 0 ? stride.from : extrapolated(block, { ...stride, length: tau })[0];

/**
 * The error of a stride over the tolerance, infinite where it steps over a break-away.
 * @type {(block: Block, stride: Stride, ends: Unknowns[]) => number}
 */
function errorOf({ F_s, k, sigma_0, v_s, creep, fast }, { from, way }, [to, less]) {
  const [before, after] = [Math.abs(from[1]), way * to[1]];
  if (after > MOST_RISE * (before + creep)) return Infinity;
  if (before > v_s && after < before / MOST_FALL) return Infinity;
  const slow = SLOW * (creep + Math.max(before, Math.abs(after)));
  const bend = (10 * F_s) / sigma_0 + Math.max(Math.abs(from[2]), Math.abs(to[2]));
  const sizes = [F_s / k, Math.min(slow, fast), bend];
  const error = Math.max(...sizes.map((size, n) => Math.abs(to[n] - less[n]) / size));
  return error >= 0 ? error / TOLERANCE : Infinity;
}

/**
 * The time [s] at which a velocity passes a level in a stride, which it does: by Newton's method. Of
 * the kink at standstill only the square of an error counts.
 * @type {(block: Block, stride: Stride, to: Unknowns, level: number) => number}
 */
function crossing(block, stride, to, level) {
  const near = level ? 1e-11 * level : 1e-7 * Math.min(block.creep, block.v);
  let [low, high] = [0, stride.length];
  let tau = (high * (stride.from[1] - level)) / (stride.from[1] - to[1]);
  for (let n = 0; n < 60; n++) {
    const y = within(block, stride, tau);
    const off = y[1] - level;
    if (Math.abs(off) <= near) break;
    if (off > 0 === to[1] > level) high = tau;
    else low = tau;
    const next = tau - off / fieldAt(block, y, stride.way).x_ddot;
    tau = next > low && next < high ? next : 0.5 * (low + high);
  }
  return tau;
}

/**
 * Whether even sliding is stable: by Routh and Hurwitz, from s^3 + a s^2 + b s + c. A sign that is
 * rounding, as without damping far above v_s, is none.
 * @type {(block: Block, g: number) => boolean}
 */
function isCalm(block, g) {
  const [push, drag, back, bend, wear] = slopesAt(block, [0, block.v, g / block.sigma_0], 1);
  const [a, b, c] = [-drag - wear, drag * wear - back * bend + push, -push * wear];
  return a > 0 && a * b > c * (1 + 1e-9);
}

/**
 * The steady cycle that a block comes to from rest with its spring at ease, if it comes to one.
 * @type {(p: Setting, own: Bristles) => LugreCycle}
 */
export function lugreCycle(p, own) {
  const block = blockOf(p, own);
  const { k, v, v_s, F_s, sigma_0, w } = block;
  if (!(F_s > block.floor)) return { outcome: "none", calm: true };
  const { g } = fieldAt(block, [0, v, 0], 1);
  const calm = isCalm(block, g);
  /** @type {Stride[]} */
  const strides = [];
  /** @type {Top[]} */
  const tops = [];
  /** @type {Unknowns} */
  let y = [0, 0, 0];
  let [t, length, falls, side] = [0, (1e-4 * F_s) / k / v, false, 1];
  for (let tables = 0; tables < MOST_TABLES; tables++) {
    const way = Math.sign(y[1]) || side * (Math.sign(fieldAt(block, y, 1).x_ddot) || 1);
    const stride = { t, from: y, way, length };
    const ends = extrapolated(block, stride);
    const error = errorOf(block, stride, ends);
    const change = (AIM / error) ** (1 / ROWS);
    length *= Math.min(Math.max(change, 1 / MOST_CHANGE), error <= 1 ? MOST_CHANGE : 0.5);
    if (!(error <= 1)) continue;
    // From standstill the sign of a force that is rounding leads nowhere.
    side = !y[1] && way * ends[0][1] < 0 ? -side : 1;
    if (side < 0) continue;
    y = ends[0];
    const stops = way * y[1] < 0;
    const turns = !stops && (falls ? y[1] < v : y[1] > v);
    if (stops || turns) {
      const level = stops ? 0 : v;
      stride.length = crossing(block, stride, y, level);
      y = within(block, stride, stride.length);
      y[1] = level;
      tables += ZERO_TABLES;
    }
    strides.push(stride);
    t += stride.length;
    const off = Math.hypot(y[1] / v - 1, (w * (y[0] - (g + p.c * v) / k)) / v);
    if (off * Math.max(v / v_s, 1) < (calm ? CALM : TOO_NEAR)) {
      return { outcome: calm ? "even" : "creep", calm };
    }
    if (!turns) continue;
    falls = !falls;
    if (falls) tops.push({ at: strides.length, t, y, drop: 0 });
    else {
      const last = tops[tops.length - 1];
      last.drop = last.y[0] - y[0];
      const before = cycleBefore(tops, F_s / k, F_s / sigma_0);
      if (before) return { outcome: "cycle", calm, ...measured(block, strides, tops, before, t) };
    }
  }
  return { outcome: "unsettled", calm };
}

/** @typedef {{at: number, t: number, y: Unknowns, drop: number}} Top a maximum of the spring: strides
 *   before it, time [s], state, the fall after it [m] */

/**
 * The maximum of the spring that the last one repeats, both at the largest fall of a cycle.
 * @type {(tops: Top[], length: number, bend: number) => Top | null}
 */
function cycleBefore(tops, length, bend) {
  const last = tops[tops.length - 1];
  const near = STEADY * last.drop + NOISE * length;
  for (const top of tops.slice(0, -1).reverse()) {
    const off = Math.abs(top.drop - last.drop);
    const turned = Math.abs(top.y[2] - last.y[2]);
    if (Math.max(off, Math.abs(top.y[0] - last.y[0])) < near && turned < STEADY * bend) return top;
    if (top.drop > last.drop || off < ALIKE * last.drop) return null;
  }
  return null;
}

/**
 * A cycle up to the last maximum of the spring; the fall after that ends at `end` [s].
 * @type {(block: Block, strides: Stride[], tops: Top[], before: Top, end: number) => object}
 */
function measured(block, strides, tops, before, end) {
  const last = tops[tops.length - 1];
  const path = strides.slice(before.at, last.at);
  const parts = Math.ceil(SHOWN_POINTS / path.length);
  /** @type {(spot: {stride: Stride, tau: number}) => LugreState} */
  const stateAt = ({ stride, tau }) => {
    const y = within(block, stride, tau);
    const { friction } = fieldAt(block, y, stride.way);
    return { t: stride.t + tau - before.t, z: y[0], x_dot: y[1], friction };
  };
  const spots = path.flatMap((stride) =>
    Array.from({ length: parts }, (_, n) => ({ stride, tau: (n * stride.length) / parts })),
  );
  const states = spots.map(stateAt);
  /** By golden sections to both sides of the largest point. */
  const largest = (/** @type {"x_dot" | "friction"} */ name) => {
    const values = states.map((state) => state[name]);
    const at = values.indexOf(Math.max(...values));
    const peaks = spots.slice(Math.max(at - 1, 0), at + 1).map(({ stride, tau }) => {
      let [low, high] = [tau, tau + stride.length / parts];
      const value = (/** @type {number} */ time) => stateAt({ stride, tau: time })[name];
      for (let n = 0; n < 25; n++) {
        const [left, right] = [0.618, 0.382].map((part) => part * low + (1 - part) * high);
        if (value(left) > value(right)) high = right;
        else low = left;
      }
      return value(low);
    });
    return Math.max(...peaks);
  };
  const peaks = { x_dot_peak: largest("x_dot"), friction_max: largest("friction") };
  const T = last.t - before.t;
  states.push({ ...states[0], t: T });
  const delta_x = last.drop + block.v * (end - last.t);
  const falls = tops.length - 1 - tops.indexOf(before);
  return { T, delta_x, ...peaks, F_max: block.k * last.y[0], falls, states };
}

/**
 * Slow friction [N] over displacement [m], to and fro over a way [m]: points of a closed loop.
 * @type {(F_s: number, sigma_0: number, way: number) => number[][]}
 */
export function presliding(F_s, sigma_0, way) {
  const end = F_s * Math.tanh((0.5 * way * sigma_0) / F_s);
  const forth = Array.from({ length: 61 }, (_, n) => {
    const x = (way * n) / 60;
    return [x, F_s - (F_s + end) * Math.exp((-x * sigma_0) / F_s)];
  });
  return [...forth, ...forth.map(([x, force]) => [way - x, -force])];
}

/** @type {(p: Setting, own: Bristles) => boolean} whether friction is not passive: docs/theory.md (34) */
export function givesEnergy({ mu_s, mu_k, c }, { sigma_1 }) {
  return sigma_1 * (mu_s - mu_k) > c * mu_k;
}
