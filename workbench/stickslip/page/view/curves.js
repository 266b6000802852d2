/**
 * The motion as paths, drawn from its events: a stick is one straight line, a slip a few cubics
 * through exact points with exact slopes, cut anew for what is seen, so that corners stay corners.
 */

import { px } from "./frame.js";

/** Radians of the fastest motion that one cubic spans; it then errs by 1e-4 of the swing. */
const FINE_STEP = 0.4;
/** The same where swings are so dense that a thousandth is not seen. */
const COARSE_STEP = 0.8;
/** Decays after which a motion is as still as it is drawn. */
const STILL_AFTER = 30;
const MOST_NODES = 4000;

/**
 * The phases in a stretch of time that is so many pixels wide.
 * @type {(motion: Motion, seen: Seen, width: number) => SeenPhase[]}
 */
export function seenPhases(motion, { from, to }, width) {
  const perSecond = width / (to - from);
  return Array.from(motion.phases(from, to), ({ kind, n, start, end }) => {
    const a = Math.max(start, from);
    const b = Math.min(end, to);
    const states =
      kind === "stick"
        ? [a, b].map((t) => motion.sticking(t, n, end - t))
        : slipNodes(motion.slip, a - start, b - start, (b - a) * perSecond).map((tau) =>
            motion.slipping(start + tau, n, tau),
          );
    const { k, v } = motion.p;
    const points = states.map((state) => ({ ...state, F_dot: k * (v - state.x_dot) }));
    return { kind, start: a, end: b, points };
  });
}

/**
 * The times since break-away at which a slip is computed, from `a` to `b` [s], in so many pixels.
 * @type {(slip: Slip, a: number, b: number, width: number) => number[]}
 */
export function slipNodes(slip, a, b, width) {
  // More than a cubic to three pixels is not seen.
  const least = (b - a) / Math.max(width / 3, 8);
  const nodes = [a];
  for (const { start, end, rate, fast, slow, turns } of slip.pieces(a, b)) {
    for (let tau = nodes[nodes.length - 1]; tau < end && nodes.length < MOST_NODES; nodes.push(tau)) {
      // What decays fast is still after a while, and the slow rest takes longer steps.
      const quickest = fast * (tau - start) > STILL_AFTER ? slow : rate;
      const step = Math.max(FINE_STEP / quickest, Math.min(least, COARSE_STEP / quickest));
      tau = slow * (tau - start) > STILL_AFTER ? end : Math.min(tau + step, end);
    }
    // Where the mass turns back its acceleration jumps: a node on either side.
    if (turns) nodes.splice(-1, 0, end * (1 - 2 ** -52));
  }
  if (nodes[nodes.length - 1] < b) nodes.push(b);
  return nodes;
}

/**
 * Path data of a quantity over time, by its name and that of its derivative.
 * @type {(phases: SeenPhase[], frame: Frame, name: "x" | "F", slope: "x_dot" | "F_dot") => string}
 */
export function timePath(phases, frame, name, slope) {
  let path = "";
  for (const { kind, points } of phases) {
    points.forEach((point, index) => {
      const last = points[index - 1];
      const here = `${px(frame.x(point.t))} ${px(frame.y(point[name]))}`;
      if (!last || kind === "stick") path += `${path ? "L" : "M"}${here}`;
      else {
        const third = (point.t - last.t) / 3;
        const out = px(frame.y(last[name] + third * last[slope]));
        const into = px(frame.y(point[name] - third * point[slope]));
        path += `C${px(frame.x(last.t + third))} ${out}`;
        path += ` ${px(frame.x(point.t - third))} ${into} ${here}`;
      }
    });
  }
  return path;
}

/**
 * A slip as path data, velocity over spring extension: states of it, one at least, t [s] counted
 * from the break-away; closed where the stick leads back to the break-away.
 * @type {(motion: Motion, frame: Frame, states: State[], closed: boolean) => string}
 */
export function loopPath(motion, frame, states, closed) {
  const point = (z, x_dot) => `${px(frame.x(z))} ${px(frame.y(x_dot))}`;
  const { v } = motion.p;
  let path = `M${point(states[0].z, states[0].x_dot)}`;
  states.slice(1).forEach(({ t, z, x_dot, x_ddot }, index) => {
    const last = states[index];
    const third = (t - last.t) / 3;
    path +=
      `C${point(last.z + third * (v - last.x_dot), last.x_dot + third * last.x_ddot)}` +
      ` ${point(z - third * (v - x_dot), x_dot - third * x_ddot)} ${point(z, x_dot)}`;
  });
  return closed ? `${path}L${point(motion.z_s, 0)}` : path;
}
