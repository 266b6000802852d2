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
    const points =
      kind === "stick"
        ? [a, b].map((t) => motion.sticking(t, n, end - t))
        : slipNodes(motion.slip, a - start, b - start, (b - a) * perSecond).map((tau) =>
            motion.slipping(start + tau, n, tau),
          );
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
  const points = phases.flatMap(({ kind, points }) =>
    points.map((point, n) => {
      const place = { t: point.t, x: point.t, y: point[name], dx: 1, dy: point[slope] };
      return { ...place, isLine: !n || kind === "stick" };
    }),
  );
  return pathOf(points, frame);
}

/**
 * A slip as path data, velocity over spring extension: states of it, one at least, t [s] counted
 * from the break-away; closed where the stick leads back to the break-away.
 * @type {(motion: Motion, frame: Frame, states: State[], closed: boolean) => string}
 */
export function loopPath({ p, z_s }, frame, states, closed) {
  const points = states.map(({ t, z, x_dot, x_ddot }) => {
    return { t, x: z, y: x_dot, dx: p.v - x_dot, dy: x_ddot, isLine: false };
  });
  const back = { t: 0, x: z_s, y: 0, dx: 0, dy: 0, isLine: true };
  return pathOf(closed ? [...points, back] : points, frame);
}

/** Points with their rates as a path: a line to each that says so, to others a cubic. */
function pathOf(points, frame) {
  const at = (x, y) => `${px(frame.x(x))} ${px(frame.y(y))}`;
  const parts = points.map(({ t, x, y, dx, dy, isLine }, n) => {
    if (isLine || !n) return `${n ? "L" : "M"}${at(x, y)}`;
    const last = points[n - 1];
    const third = (t - last.t) / 3;
    const out = at(last.x + third * last.dx, last.y + third * last.dy);
    return `C${out} ${at(x - third * dx, y - third * dy)} ${at(x, y)}`;
  });
  return parts.join("");
}
