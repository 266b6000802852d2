/** The jump over the speed: the exact curve, the handbooks' constant and the present point. */

import { jumpOverSpeed, slowJump } from "../model/maps.js";
import { logAxis } from "../view/axis.js";
import { byId, draw, put, setText } from "../view/dom.js";
import { makeFrame, polyline, px } from "../view/frame.js";
import { digits, quantity } from "../view/units.js";

/** @import { Solution } from "../view/solution.js" */

/**
 * Bring the chart to life.
 *
 * @param {SVGSVGElement} svg
 * @returns svg; resize(width, height) [px]; show(solution)
 */
export function makeJumpMap(svg) {
  const frame = makeFrame(svg);
  const said = byId("jump-map-said");
  const here = draw(frame.curves, "path", { class: "cursor" });
  const constant = draw(frame.curves, "path", { class: "threshold" });
  const curve = draw(frame.curves, "path", { class: "curve mass" });
  const end = draw(frame.over, "path", { class: "centre" });
  const endName = draw(frame.over, "text", { class: "note", "text-anchor": "end" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4.5 });

  let drawn = "";

  /** @param {Solution} solution */
  function show(solution) {
    const { motion, v_c, simple } = solution;
    const { p, cycle, numbers } = motion;
    const { low, high } = speeds(p.v, v_c, numbers.w * numbers.Delta);
    // The curve depends on the speed by the ends of its axis alone.
    const key = [numbers.Delta, numbers.w, numbers.zeta, low, high, frame.area.width].join();
    if (key !== drawn) drawCurve(solution, low, high);
    drawn = key;
    const at = px(frame.x(p.v));
    put(here, { d: `M${at} ${frame.area.top}V${frame.area.bottom}` });
    put(dot, { visibility: cycle.exists ? "visible" : "hidden" });
    if (cycle.exists) put(dot, { cx: at, cy: px(frame.y(cycle.delta_x)) });
    setText(said, jumpInWords(p, cycle, v_c, simple.delta_x));
  }

  /** @type {(solution: Solution, low: number, high: number) => void} */
  function drawCurve({ motion: { p, numbers }, v_c, simple }, low, high) {
    const points = jumpOverSpeed(p, low, high);
    const jumps = [simple.delta_x, ...points.map(({ jump }) => jump)];
    const known = jumps.filter((jump) => jump > 0);
    // Without cycle and gap there is no jump to scale by.
    if (!known.length) known.push(p.v / numbers.w);
    frame.scale(
      logAxis(low, high, "velocity", "v"),
      logAxis(Math.min(...known) / 2, Math.max(...known) * 2.5, "length", "jump"),
    );
    const { left, right } = frame.area;
    put(curve, { d: polyline(points.map(({ v, jump }) => [frame.x(v), frame.y(jump)])) });
    const level = simple.delta_x > 0 ? `M${left} ${px(frame.y(simple.delta_x))}H${right}` : "";
    put(constant, { d: level });
    const last = v_c <= high ? points[points.length - 1] : undefined;
    const [x, y] = last ? [px(frame.x(last.v)), px(frame.y(last.jump))] : [0, 0];
    put(end, { d: last ? `M${x} ${y - 7}V${y + 7}` : "" });
    setText(endName, last ? `ends at ${quantity(v_c, "velocity")}` : "");
    put(endName, { x: Math.max(x + 4, left + 130), y: y - 11 });
  }

  return {
    svg,
    resize: frame.resize,
    show,
  };
}

/**
 * The speeds that the chart spans, whole decades: slow enough to see the limit.
 *
 * @param {number} v in use [m/s]
 * @param {number} v_c critical velocity [m/s]
 * @param {number} ofGap speed at which lambda is 1 [m/s]
 */
function speeds(v, v_c, ofGap) {
  const known = v_c > 0 && v_c < Infinity ? v_c : ofGap || v;
  return {
    low: 10 ** Math.floor(Math.log10(Math.min(v / 1.3, known / 20))),
    high: 10 ** Math.ceil(Math.log10(Math.max(v, known * (v_c < Infinity ? 1 : 5)) * 1.2)),
  };
}

function jumpInWords(p, { exists, delta_x }, v_c, constant) {
  if (v_c === 0) return "There is no cycle at any speed.";
  const [pull, critical] = [p.v, v_c].map((each) => quantity(each, "velocity"));
  const limit = `For v → 0 it comes down to ${quantity(slowJump(p), "length")}`;
  const end = v_c < Infinity ? `, and at ${critical} it ends.` : ".";
  if (!exists) return `It does not stick at ${pull}. ${limit.replace("it", "the jump")}${end}`;
  const ratio = constant > 0 ? `, ${digits(delta_x / constant, 3)} times the constant` : "";
  return `At ${pull} the jump is ${quantity(delta_x, "length")}${ratio}. ${limit}${end}`;
}
