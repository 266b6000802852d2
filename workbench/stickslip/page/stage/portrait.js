/** The phase portrait: velocity of the mass over the spring's extension. */

import { axisOf } from "../view/axis.js";
import { loopPath, slipNodes } from "../view/curves.js";
import { draw, put, setText } from "../view/dom.js";
import { makeFrame, px } from "../view/frame.js";

/**
 * @import { Motion, State } from "../model/motion.js"
 * @import { Frame } from "../view/frame.js"
 */

/** Swings of a slip without end that are drawn. */
const SWINGS = 20;

/**
 * Bring the portrait to life.
 *
 * @param {SVGSVGElement} svg
 * @returns resize(), show(motion, ghost), mark(state)
 */
export function makePortrait(svg) {
  const frame = makeFrame(svg);
  const ghostCurve = draw(frame.curves, "path", { class: "curve ghost" });
  const threshold = draw(frame.curves, "path", { class: "threshold" });
  const whole = draw(frame.curves, "path", { class: "curve mass faint" });
  const trail = draw(frame.curves, "path", { class: "curve trail" });
  const centre = draw(frame.over, "path", { class: "centre" });
  const centreName = draw(frame.over, "text", { class: "note" });
  const thresholdName = draw(frame.over, "text", { class: "note limit", "text-anchor": "end" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4.5 });
  setText(thresholdName, "Fₛ/k");
  setText(centreName, "steady sliding");
  /** @type {Motion} */
  let motion = null;

  /**
   * @param {Motion} next
   * @param {Motion | null} ghost
   */
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
    const line = px(frame.x(z_s));
    put(threshold, { d: `M${line} ${frame.area.top}V${frame.area.bottom}` });
    put(thresholdName, { x: line - 4, y: frame.area.top + 26 });
    const left = px(frame.x(z_even));
    const top = px(frame.y(p.v));
    put(centre, { d: `M${left - 5} ${top}h10M${left} ${top - 5}v10` });
    const anchor = left > frame.area.left + 90 ? "end" : "start";
    put(centreName, { x: left, y: top - 8, "text-anchor": anchor });
  }

  /**
   * What of the present cycle has passed: the stick so far, or the stick and the slip so far.
   *
   * @param {State} state
   */
  function trailOf({ t, z, x_dot, mode }) {
    const { cycle, z_s } = motion;
    const point = (/** @type {number} */ a, /** @type {number} */ b) =>
      `${px(frame.x(a))} ${px(frame.y(b))}`;
    const [phase] = motion.phases(t, t + 1e-9 * motion.beat);
    const n = phase ? phase.n : 0;
    const rest = point(n === 0 ? 0 : z_s - cycle.spring_drop, 0);
    if (mode === 0 || phase?.kind !== "slip") return `M${rest}L${point(z, x_dot)}`;
    const tau = Math.max(t - phase.start, 0);
    // Of a slip without end the last swing is enough.
    const begin = cycle.exists ? 0 : Math.max(tau - motion.slip.scale, 0);
    const states = slipNodes(motion.slip, begin, tau, Infinity).map((each) =>
      motion.slipping(each, 0, each),
    );
    const path = loopPath(motion, frame, states, false);
    return begin === 0 ? `M${rest}L${path.slice(1)}` : path;
  }

  return {
    resize() {
      frame.resize(svg.clientWidth, svg.clientHeight);
    },
    show,
    /** @param {State} state */
    mark(state) {
      put(dot, { cx: px(frame.x(state.z)), cy: px(frame.y(state.x_dot)) });
      put(trail, { d: trailOf(state) });
    },
  };
}

/**
 * States of a motion's slip, t [s] counted from its break-away.
 *
 * @param {Motion} motion
 */
function loopOf(motion) {
  const { cycle, slip } = motion;
  const end = cycle.exists ? cycle.t_slip : Math.min(30 / slip.slow, SWINGS * slip.scale);
  return slipNodes(slip, 0, end, Infinity).map((tau) => motion.slipping(tau, 0, tau));
}
