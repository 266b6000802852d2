/** The phase portrait: velocity of the mass over the spring's extension. */

import { portraitPath, slipNodes } from "./curves.js";
import { draw, put, setText } from "./dom.js";
import { makeFrame, px } from "./frame.js";
import { scaleFor } from "./units.js";

/** Pixels that a loop is computed for. */
const LOOP_PIXELS = 240;

/**
 * Bring the portrait to life.
 *
 * @param {SVGSVGElement} svg
 * @returns {object} resize(), show(motion), mark(state)
 */
export function makePortrait(svg) {
  const frame = makeFrame(svg);
  const threshold = draw(frame.curves, "path", { class: "threshold" });
  const curve = draw(frame.curves, "path", { class: "curve mass" });
  const centre = draw(frame.over, "path", { class: "centre" });
  const centreName = draw(frame.over, "text", { class: "note" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4 });

  function show(motion) {
    const { cycle, slip, numbers, p, z_s } = motion;
    // A slip without end is followed until it has settled.
    const end = cycle.exists ? cycle.t_slip : Math.min(30 / slip.slow, 60 * slip.scale);
    const nodes = slipNodes(slip, 0, end, LOOP_PIXELS);
    const states = nodes.map((tau) => motion.slipping(0, 0, tau));
    const settled = (numbers.F_k + p.c * p.v) / p.k;
    frame.scale(
      axis([0, z_s, settled, ...states.map(({ z }) => z)], "length", "z in"),
      axis([0, p.v, ...states.map(({ x_dot }) => x_dot)], "velocity", "ẋ in"),
    );
    curve.setAttribute("d", portraitPath(motion, frame, nodes));
    threshold.setAttribute("d", `M${px(frame.x(z_s))} ${frame.area.top}V${frame.area.bottom}`);
    const left = px(frame.x(settled));
    const top = px(frame.y(p.v));
    centre.setAttribute("d", `M${left - 5} ${top}h10M${left} ${top - 5}v10`);
    setText(centreName, "steady sliding");
    const anchor = left > frame.area.left + 90 ? "end" : "start";
    put(centreName, { x: left, y: top - 8, "text-anchor": anchor });
  }

  return {
    resize() {
      frame.resize(svg.clientWidth, svg.clientHeight);
    },
    show,
    mark({ z, x_dot }) {
      put(dot, { cx: px(frame.x(z)), cy: px(frame.y(x_dot)) });
    },
  };
}

function axis(values, kind, title) {
  const low = Math.min(...values);
  const high = Math.max(...values);
  const room = 0.08 * (high - low);
  const { size, unit } = scaleFor(Math.max(Math.abs(low), Math.abs(high)), kind);
  return { low: low - room, high: high + room, size, title: `${title} ${unit}` };
}
