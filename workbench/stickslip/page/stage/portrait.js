/** The phase portrait: velocity of the mass over the spring's extension. */

import { axisOf } from "../view/axis.js";
import { portraitPath, slipNodes } from "../view/curves.js";
import { draw, put, setText } from "../view/dom.js";
import { makeFrame, px } from "../view/frame.js";

/** @import { Motion, State } from "../model/motion.js" */

/** Swings of a slip without end that are drawn. */
const SWINGS = 20;

/**
 * Bring the portrait to life.
 *
 * @param {SVGSVGElement} svg
 * @returns resize(), show(motion), mark(state)
 */
export function makePortrait(svg) {
  const frame = makeFrame(svg);
  const threshold = draw(frame.curves, "path", { class: "threshold" });
  const curve = draw(frame.curves, "path", { class: "curve mass" });
  const centre = draw(frame.over, "path", { class: "centre" });
  const centreName = draw(frame.over, "text", { class: "note" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4 });

  /** @param {Motion} motion */
  function show(motion) {
    const { cycle, slip, numbers, p, z_s } = motion;
    const end = cycle.exists ? cycle.t_slip : Math.min(30 / slip.slow, SWINGS * slip.scale);
    const states = slipNodes(slip, 0, end, Infinity).map((tau) => motion.slipping(tau, 0, tau));
    const settled = (numbers.F_k + p.c * p.v) / p.k;
    frame.scale(
      axisOf([0, z_s, settled, ...states.map(({ z }) => z)], "length", "z", 0.08),
      axisOf([0, p.v, ...states.map(({ x_dot }) => x_dot)], "velocity", "ẋ", 0.08),
    );
    put(curve, { d: portraitPath(motion, frame, states) });
    put(threshold, { d: `M${px(frame.x(z_s))} ${frame.area.top}V${frame.area.bottom}` });
    const left = px(frame.x(settled));
    const top = px(frame.y(p.v));
    put(centre, { d: `M${left - 5} ${top}h10M${left} ${top - 5}v10` });
    setText(centreName, "steady sliding");
    const anchor = left > frame.area.left + 90 ? "end" : "start";
    put(centreName, { x: left, y: top - 8, "text-anchor": anchor });
  }

  return {
    resize() {
      frame.resize(svg.clientWidth, svg.clientHeight);
    },
    show,
    /** @param {State} state */
    mark({ z, x_dot }) {
      put(dot, { cx: px(frame.x(z)), cy: px(frame.y(x_dot)) });
    },
  };
}
