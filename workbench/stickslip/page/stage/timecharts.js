/** Position and spring force over time: two charts with one stretch of time and one cursor. */

import { axisOf } from "../view/axis.js";
import { seenPhases, timePath } from "../view/curves.js";
import { draw, put, setText } from "../view/dom.js";
import { makeFrame, px } from "../view/frame.js";
import { quantity, scaleFor } from "../view/units.js";
import { cyclesBegin } from "./stretch.js";

/**
 * @import { Motion, State } from "../model/motion.js"
 * @import { SeenPhase } from "../view/curves.js"
 * @import { Frame } from "../view/frame.js"
 */

/** @typedef {ReturnType<typeof makeChart>} Chart */
/** @typedef {{from: number, to: number}} Seen a stretch of time [s] */

/** A phase's name is written into its band where that is this wide [px]. */
const ROOM_FOR_NAME = 38;
/** The name of the break-away force stands above its line where this is free [px]. */
const ROOM_ABOVE = 18;
/** Width of the words "pulled end" [px]. */
const PULLED_END = 62;
/** The overshoot is told where it is this high [px]. */
const ROOM_FOR_OVERSHOOT = 2;
/** Cycles of a ghost that are drawn. */
const MOST_GHOSTS = 60;
/** A letter of a note is about this wide [px]. */
const LETTER = 6.2;

/**
 * Bring the two charts to life.
 *
 * @param {SVGSVGElement} svgX for the position
 * @param {SVGSVGElement} svgF for the force
 * @returns charts: both; resize(); show(motion, seen): draw them; mark(state): move the
 *   cursor there
 */
export function makeTimeCharts(svgX, svgF) {
  const x = makeChart(svgX);
  const F = makeChart(svgF);
  const ghosts = [x, F].map(({ frame }) => draw(frame.curves, "path", { class: "curve ghost" }));
  const pull = draw(x.frame.curves, "path", { class: "curve pull" });
  const position = draw(x.frame.curves, "path", { class: "curve mass" });
  const threshold = draw(F.frame.curves, "path", { class: "threshold" });
  const force = draw(F.frame.curves, "path", { class: "curve force" });
  const thresholdName = draw(F.frame.over, "text", { class: "note limit", "text-anchor": "end" });
  const pullName = draw(x.frame.over, "text", { class: "note pull" });
  const massName = draw(x.frame.over, "text", { class: "note mass", "text-anchor": "middle" });
  const overshoot = draw(F.frame.over, "text", { class: "note" });
  const pullDot = draw(x.frame.over, "circle", { class: "dot pull", r: 4 });
  /** @type {Element[]} */
  const names = [];

  /**
   * @param {Motion} motion
   * @param {Seen} seen
   * @param {Motion | null} ghost whose steady cycles are drawn beside those of the motion
   */
  function show(motion, seen, ghost) {
    const { p, numbers } = motion;
    const phases = seenPhases(motion, seen, x.frame.area.width);
    const points = phases.flatMap((phase) => phase.points);
    const before = ghost ? ghostOf(ghost, motion, seen, x.frame.area.width) : [];
    const time = timeAxis(seen);
    const edges = [points[0].x, points[points.length - 1].x, p.v * seen.from, p.v * seen.to];
    x.frame.scale(time, axisOf(edges, "length", "x", 0.13, 0.06));
    F.frame.scale(time, forceAxis(motion, seen, [...points, ...before.flatMap((phase) => phase.points)]));
    put(ghosts[0], { d: timePath(before, x.frame, "x", "x_dot") });
    put(ghosts[1], { d: timePath(before, F.frame, "F", "F_dot") });
    put(position, { d: timePath(phases, x.frame, "x", "x_dot") });
    put(force, { d: timePath(phases, F.frame, "F", "F_dot") });
    const { left, right } = x.frame.area;
    const [start, end] = [seen.from, seen.to].map((t) => px(x.frame.y(p.v * t)));
    put(pull, { d: `M${left} ${start}L${right} ${end}` });
    const level = px(F.frame.y(numbers.F_s));
    put(threshold, { d: `M${left} ${level}H${right}` });
    const above = level - F.frame.area.top > ROOM_ABOVE ? -6 : 13;
    const F_s = quantity(numbers.F_s, "force");
    note(thresholdName, `Fₛ = ${F_s}`, right - 4, level + above, F.frame);
    nameCurves(motion, seen, phases);
    showOvershoot(motion, seen, phases);
    x.shade(phases);
    F.shade(phases);
    nameBands(phases);
  }

  /**
   * Write the names of mass and pulled end at their curves, where these are apart.
   *
   * @param {Motion} motion
   * @param {Seen} seen
   * @param {SeenPhase[]} phases
   */
  function nameCurves({ p }, seen, phases) {
    const { left, right, bottom } = x.frame.area;
    // The line rises: the name clears it where it ends.
    const t = seen.from + ((8 + PULLED_END) / (right - left)) * (seen.to - seen.from);
    note(pullName, "pulled end", left + 8, x.frame.y(p.v * t) - 2, x.frame);
    const stick = [...phases].reverse().find(
      ({ kind, start, end }) =>
        kind === "stick" && x.frame.x(end) - x.frame.x(start) > ROOM_FOR_NAME && end < seen.to,
    );
    const middle = stick ? 0.5 * (x.frame.x(stick.start) + x.frame.x(stick.end)) : right - 20;
    const height = stick ? x.frame.y(stick.points[0].x) + 15 : Infinity;
    note(massName, "mass", middle, Math.min(height, stick ? bottom - 18 : height), x.frame);
  }

  /**
   * @param {Motion} motion
   * @param {Seen} seen
   * @param {SeenPhase[]} phases
   */
  function showOvershoot({ numbers, p, slip }, seen, phases) {
    const height = slip.overshoot ? p.k * slip.overshoot.growth : 0;
    const top = F.frame.y(numbers.F_s + height);
    const first = phases.find(({ kind, start }) => kind === "slip" && start > seen.from);
    const left = first ? F.frame.x(first.start + (slip.overshoot?.tau ?? 0)) : Infinity;
    const { area } = F.frame;
    const words = `F passes Fₛ by ${quantity(height, "force")}`;
    const width = LETTER * words.length;
    // Beside the title of the axis, not on it.
    const leftmost = area.left + 60;
    const isHigh = F.frame.y(numbers.F_s) - top >= ROOM_FOR_OVERSHOOT;
    const room = isHigh && leftmost + width < area.right;
    const at = Math.min(Math.max(left + 4, leftmost), area.right - width);
    note(overshoot, room && left < area.right ? words : "", at, top - 4, F.frame);
  }

  /** @param {SeenPhase[]} phases */
  function nameBands(phases) {
    let used = 0;
    for (const { kind, start, end } of phases) {
      const left = x.frame.x(start);
      const width = x.frame.x(end) - left;
      if (width < ROOM_FOR_NAME) continue;
      names[used] ??= draw(x.frame.over, "text", { class: "band-name", "text-anchor": "middle" });
      const name = names[used++];
      setText(name, kind === "stick" ? "stick" : "slip");
      put(name, { x: px(left + 0.5 * width), y: x.frame.area.bottom - 5 });
    }
    for (const name of names.splice(used)) name.remove();
  }

  /** @param {State} state */
  function mark(state) {
    x.mark(state.t, state.x);
    F.mark(state.t, state.F);
    put(pullDot, { cx: px(x.frame.x(state.t)), cy: px(x.frame.y(state.x_pull)) });
  }

  return {
    charts: [x, F],
    resize() {
      for (const { frame } of [x, F]) {
        const { clientWidth, clientHeight } = frame.svg;
        frame.resize(clientWidth, clientHeight);
      }
    },
    show,
    mark,
  };
}

/**
 * A chart's frame with bands for the phases, a cursor, and the stretch that is being chosen.
 *
 * @param {SVGSVGElement} svg
 */
function makeChart(svg) {
  const frame = makeFrame(svg);
  const hatch = draw(svg.querySelector("defs"), "pattern", {
    id: `${svg.id}-hatch`,
    width: 6,
    height: 6,
    patternUnits: "userSpaceOnUse",
    patternTransform: "rotate(45)",
  });
  draw(hatch, "rect", { class: "slip-band", width: 6, height: 6 });
  draw(hatch, "path", { class: "hatch", d: "M0 0V6" });
  const sticks = draw(frame.under, "path", { class: "stick-band" });
  const slips = draw(frame.under, "path", { fill: `url(#${svg.id}-hatch)` });
  const choice = draw(frame.over, "rect", { class: "choice", visibility: "hidden" });
  const line = draw(frame.over, "path", { class: "cursor" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4 });

  /** @param {SeenPhase[]} phases */
  function shade(phases) {
    const { top, bottom } = frame.area;
    const paths = { stick: "", slip: "" };
    for (const { kind, start, end } of phases) {
      const [left, right] = [start, end].map((t) => px(frame.x(t)));
      paths[kind] += `M${left} ${top}H${right}V${bottom}H${left}Z`;
    }
    put(sticks, { d: paths.stick });
    put(slips, { d: paths.slip });
  }

  /**
   * @param {number} t [s]
   * @param {number} value SI
   */
  function mark(t, value) {
    const left = px(frame.x(t));
    put(line, { d: `M${left} ${frame.area.top}V${frame.area.bottom}` });
    put(dot, { cx: left, cy: px(frame.y(value)) });
  }

  /**
   * Show the stretch between two places as chosen, or none.
   *
   * @param {number} [a] [px]
   * @param {number} [b] [px]
   */
  function choose(a, b) {
    const shown = b !== undefined;
    put(choice, { visibility: shown ? "visible" : "hidden" });
    if (!shown) return;
    const { top, height } = frame.area;
    put(choice, { x: Math.min(a, b), width: Math.abs(b - a), y: top, height });
  }

  return { frame, shade, mark, choose };
}

/**
 * The steady cycles of a motion as they are drawn beside those of another, both from the end of
 * their first slips.
 *
 * @param {Motion} ghost
 * @param {Motion} motion
 * @param {Seen} seen
 * @param {number} width of the chart [px]
 * @returns {SeenPhase[]} none where they would be a blur
 */
function ghostOf(ghost, motion, { from, to }, width) {
  const later = cyclesBegin(motion) - cyclesBegin(ghost);
  const start = Math.max(from - later, 0);
  if (to - later <= start || (to - from) / ghost.beat > MOST_GHOSTS) return [];
  const ahead = motion.at(cyclesBegin(motion)).x - ghost.at(cyclesBegin(ghost)).x;
  return seenPhases(ghost, { from: start, to: to - later }, width).map((phase) => ({
    ...phase,
    points: phase.points.map((point) => ({ ...point, t: point.t + later, x: point.x + ahead })),
  }));
}

/** @param {Seen} seen */
function timeAxis({ from, to }) {
  const { size, unit } = scaleFor(to, "time");
  return { low: from, high: to, size, title: `time in ${unit}` };
}

/**
 * @param {Motion} motion
 * @param {Seen} seen
 * @param {SeenPhase["points"]} points
 */
function forceAxis({ numbers, beat }, { from, to }, points) {
  const values = points.map(({ F }) => F);
  // Whole cycles are seen against zero and the threshold; a detail for itself.
  if (to - from >= beat) values.push(0, numbers.F_s);
  return axisOf(values, "force", "F", 0.05, 0.22);
}

/**
 * Write a note where it is inside the plot, else hide it.
 *
 * @param {Element} element
 * @param {string} words
 * @param {number} left [px]
 * @param {number} top [px]
 * @param {Frame} frame
 */
function note(element, words, left, top, { area }) {
  const shown = words && top > area.top && top < area.bottom;
  setText(element, shown ? words : "");
  if (!shown) return;
  put(element, { x: px(left), y: px(top) });
}
