/** The jump over the speed: the exact curve, the handbooks' constant and the present point. */

import { slowJump } from "../model/cycle.js";
import { jumpOverSpeed } from "../model/maps.js";
import { decades, logAxis } from "../view/axis.js";
import { byId, draw, paths, put, setText } from "../view/dom.js";
import { makeFrame, polyline, px, write } from "../view/frame.js";
import { whenSeen } from "../view/seen.js";
import { digits, quantity } from "../view/units.js";

/** @type {(page: Page) => (solution: Solution) => void} returns what shows a solution */
export function makeJumpMap(page) {
  const frame = makeFrame(byId("jump-map"));
  const said = byId("jump-map-said");
  const [here, constant, curve] = paths(frame.curves, "cursor", "threshold", "curve mass");
  const end = draw(frame.over, "path", { class: "centre" });
  const endName = draw(frame.over, "text", { class: "note", "text-anchor": "end" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4.5 });
  let drawn = "";

  function show(solution) {
    const { motion, v_c, simple } = solution;
    const { p, cycle, numbers } = motion;
    const { low, high } = speeds(p.v, v_c, numbers.w * numbers.Delta);
    // The curve depends on the speed by the ends of its axis alone.
    const key = [numbers.Delta, numbers.w, numbers.zeta, low, high, frame.area.width].join();
    if (key !== drawn) drawCurve(solution, low, high);
    drawn = key;
    put(here, { d: frame.upright(p.v) });
    put(dot, { visibility: cycle.exists ? "visible" : "hidden" });
    if (cycle.exists) put(dot, { cx: px(frame.x(p.v)), cy: px(frame.y(cycle.delta_x)) });
    setText(said, jumpInWords(p, cycle, v_c, simple.delta_x));
  }

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
    put(curve, { d: polyline(points.map(({ v, jump }) => [frame.x(v), frame.y(jump)])) });
    put(constant, { d: simple.delta_x > 0 ? frame.level(simple.delta_x) : "" });
    const last = v_c <= high ? points[points.length - 1] : undefined;
    const [x, y] = last ? [px(frame.x(last.v)), px(frame.y(last.jump))] : [0, 0];
    put(end, { d: last ? `M${x} ${y - 7}V${y + 7}` : "" });
    const words = last ? `ends at ${quantity(v_c, "velocity")}` : "";
    write(endName, words, Math.max(x + 4, frame.area.left + 130), y - 11);
  }

  return whenSeen("maps", page, [frame], show);
}

/**
 * The speeds that the chart spans [m/s], whole decades: slow enough to see the limit. With the speed
 * of the gap lambda is 1.
 * @type {(v: number, v_c: number, ofGap: number) => {low: number, high: number}}
 */
function speeds(v, v_c, ofGap) {
  const known = v_c > 0 && v_c < Infinity ? v_c : ofGap || v;
  const fastest = Math.max(v, known * (v_c < Infinity ? 1 : 5));
  return decades(Math.min(v / 1.3, known / 20), 1.2 * fastest);
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
