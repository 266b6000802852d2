/** The phase portrait: velocity of the mass over the spring's extension. */

import { axisOf } from "../view/axis.js";
import { loopPath, slipNodes } from "../view/curves.js";
import { draw, paths, put } from "../view/dom.js";
import { makeFrame, px, write } from "../view/frame.js";

/** Swings of a slip without end that are drawn. */
const SWINGS = 20;

/** Returns resize(), show(motion, ghost), mark(state). */
export function makePortrait(svg) {
  const frame = makeFrame(svg);
  const looks = ["curve ghost", "threshold", "curve mass faint", "curve trail"];
  const [ghostCurve, threshold, whole, trail] = paths(frame.curves, ...looks);
  const centre = draw(frame.over, "path", { class: "centre" });
  const centreName = draw(frame.over, "text", { class: "note" });
  const thresholdName = draw(frame.over, "text", { class: "note limit", "text-anchor": "end" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4.5 });
  let motion = null;

  function show(next, ghost) {
    motion = next;
    const { cycle, p, z_s, z_even } = motion;
    const states = loopOf(motion);
    const others = ghost ? loopOf(ghost) : [];
    const lengths = [z_s, z_even, ...[...states, ...others].map(({ z }) => z)];
    // The way from a relaxed spring is in sight where the loop is not lost beside it.
    const near = Math.max(...lengths) - Math.min(...lengths) < 0.4 * Math.max(...lengths);
    frame.scale(
      axisOf(near ? lengths : [0, ...lengths], "length", "z", 0.08),
      axisOf([0, p.v, ...[...states, ...others].map(({ x_dot }) => x_dot)], "velocity", "ẋ", 0.08),
    );
    put(whole, { d: loopPath(motion, frame, states, cycle.exists) });
    put(ghostCurve, { d: ghost ? loopPath(ghost, frame, others, ghost.cycle.exists) : "" });
    put(threshold, { d: frame.upright(z_s) });
    write(thresholdName, "Fₛ/k", px(frame.x(z_s)) - 4, frame.area.top + 26);
    const left = px(frame.x(z_even));
    const top = px(frame.y(p.v));
    put(centre, { d: `M${left - 5} ${top}h10M${left} ${top - 5}v10` });
    write(centreName, "steady sliding", left, top - 8);
    put(centreName, { "text-anchor": left > frame.area.left + 90 ? "end" : "start" });
  }

  /**
   * What of the present cycle has passed: the stick so far, or the stick and the slip so far.
   * @type {(state: State) => string}
   */
  function trailOf({ t, z, x_dot, mode }) {
    const { cycle, z_s } = motion;
    const point = (a, b) => `${px(frame.x(a))} ${px(frame.y(b))}`;
    const [phase] = motion.phases(t, t + 1e-9 * motion.beat);
    const n = phase ? phase.n : 0;
    const rest = point(n === 0 ? 0 : z_s - cycle.spring_drop, 0);
    if (mode === 0 || phase?.kind !== "slip") return `M${rest}L${point(z, x_dot)}`;
    const tau = Math.max(t - phase.start, 0);
    // Of a slip without end the last swing is enough.
    const begin = cycle.exists ? 0 : Math.max(tau - motion.slip.scale, 0);
    const path = loopPath(motion, frame, statesOf(motion, begin, tau), false);
    return begin === 0 ? `M${rest}L${path.slice(1)}` : path;
  }

  return {
    resize: frame.resize,
    show,
    mark(state) {
      put(dot, { cx: px(frame.x(state.z)), cy: px(frame.y(state.x_dot)) });
      put(trail, { d: trailOf(state) });
    },
  };
}

/**
 * States of a motion's slip, t [s] counted from its break-away.
 * @type {(motion: Motion, begin: number, end: number) => State[]}
 */
function statesOf(motion, begin, end) {
  const nodes = slipNodes(motion.slip, begin, end, Infinity);
  return nodes.map((tau) => motion.slipping(tau, 0, tau));
}

/** @type {(motion: Motion) => State[]} those of its whole slip */
function loopOf(motion) {
  const { cycle, slip } = motion;
  const end = cycle.exists ? cycle.t_slip : Math.min(30 / slip.slow, SWINGS * slip.scale);
  return statesOf(motion, 0, end);
}
