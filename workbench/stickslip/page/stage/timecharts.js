/** Position and spring force over time: two charts with one stretch of time and one cursor. */

import { axisOf } from "../view/axis.js";
import { seenPhases, timePath } from "../view/curves.js";
import { draw, paths, put, setText } from "../view/dom.js";
import { hatched, makeFrame, makeTexts, px, write } from "../view/frame.js";
import { quantity, scaleFor } from "../view/units.js";
import { cyclesBegin } from "./stretch.js";

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
 * Bring the charts of position and force to life. show(motion, seen, ghost): draw them, and beside
 * them the steady cycles of a ghost; mark(state): move the cursor there.
 */
export function makeTimeCharts(svgX, svgF) {
  const x = makeChart(svgX);
  const F = makeChart(svgF);
  const [ghostX, pull, mass] = paths(x.frame.curves, "curve ghost", "curve pull", "curve mass");
  const ofForce = ["curve ghost", "threshold", "curve force"];
  const [ghostF, threshold, force] = paths(F.frame.curves, ...ofForce);
  const thresholdName = draw(F.frame.over, "text", { class: "note limit", "text-anchor": "end" });
  const pullName = draw(x.frame.over, "text", { class: "note pull" });
  const massName = draw(x.frame.over, "text", { class: "note mass", "text-anchor": "middle" });
  const overshoot = draw(F.frame.over, "text", { class: "note" });
  const pullDot = draw(x.frame.over, "circle", { class: "dot pull", r: 4 });
  const nameBands = makeTexts(x.frame.over, { class: "band-name" });

  /** @type {(start: number, end: number) => number} [px] */
  const widthOf = (start, end) => x.frame.x(end) - x.frame.x(start);

  function show(motion, seen, ghost) {
    const { p, numbers } = motion;
    const { left, right, top, bottom, width } = x.frame.area;
    const phases = seenPhases(motion, seen, width);
    const points = phases.flatMap((phase) => phase.points);
    const before = ghost ? ghostOf(ghost, motion, seen, width) : [];
    const { size, unit } = scaleFor(seen.to, "time");
    const time = { low: seen.from, high: seen.to, size, title: `time in ${unit}` };
    const edges = [points[0].x, points[points.length - 1].x, p.v * seen.from, p.v * seen.to];
    x.frame.scale(time, axisOf(edges, "length", "x", 0.13, 0.06));
    const forces = [...points, ...before.flatMap((phase) => phase.points)].map((point) => point.F);
    // Whole cycles are seen against zero and the threshold; a detail for itself.
    if (seen.to - seen.from >= motion.beat) forces.push(0, numbers.F_s);
    F.frame.scale(time, axisOf(forces, "force", "F", 0.05, 0.22));
    put(ghostX, { d: timePath(before, x.frame, "x", "x_dot") });
    put(ghostF, { d: timePath(before, F.frame, "F", "F_dot") });
    put(mass, { d: timePath(phases, x.frame, "x", "x_dot") });
    put(force, { d: timePath(phases, F.frame, "F", "F_dot") });
    const [start, end] = [seen.from, seen.to].map((t) => px(x.frame.y(p.v * t)));
    put(pull, { d: `M${left} ${start}L${right} ${end}` });
    put(threshold, { d: F.frame.level(numbers.F_s) });
    const level = px(F.frame.y(numbers.F_s));
    const above = level - top > ROOM_ABOVE ? -6 : 13;
    const limit = `Fₛ = ${quantity(numbers.F_s, "force")}`;
    note(thresholdName, limit, right - 4, level + above, F.frame);
    nameCurves(motion, seen, phases);
    showOvershoot(motion, seen, phases);
    x.shade(phases);
    F.shade(phases);
    const wide = phases.filter(({ start, end }) => widthOf(start, end) >= ROOM_FOR_NAME);
    const middle = ({ start, end }) => x.frame.x(0.5 * (start + end));
    nameBands(wide.map((phase) => [phase.kind, middle(phase), bottom - 5]));
  }

  /** Write the names of mass and pulled end at their curves, where these are apart. */
  function nameCurves({ p }, seen, phases) {
    const { left, right, bottom } = x.frame.area;
    // The line rises: the name clears it where it ends.
    const t = seen.from + ((8 + PULLED_END) / (right - left)) * (seen.to - seen.from);
    note(pullName, "pulled end", left + 8, x.frame.y(p.v * t) - 2, x.frame);
    const stick = phases.findLast(
      ({ kind, start, end }) =>
        kind === "stick" && widthOf(start, end) > ROOM_FOR_NAME && end < seen.to,
    );
    const middle = stick ? x.frame.x(0.5 * (stick.start + stick.end)) : right - 20;
    const height = stick ? Math.min(x.frame.y(stick.points[0].x) + 15, bottom - 18) : Infinity;
    note(massName, "mass", middle, height, x.frame);
  }

  function showOvershoot({ numbers, p, slip }, seen, phases) {
    const { tau, growth } = slip.overshoot ?? { tau: 0, growth: 0 };
    const height = p.k * growth;
    const { area, y } = F.frame;
    const top = y(numbers.F_s + height);
    const first = phases.find(({ kind, start }) => kind === "slip" && start > seen.from);
    const left = first ? F.frame.x(first.start + tau) : Infinity;
    const words = `F passes Fₛ by ${quantity(height, "force")}`;
    const width = LETTER * words.length;
    // Beside the title of the axis, not on it.
    const leftmost = area.left + 60;
    const isHigh = y(numbers.F_s) - top >= ROOM_FOR_OVERSHOOT;
    const room = isHigh && leftmost + width < area.right;
    const at = Math.min(Math.max(left + 4, leftmost), area.right - width);
    note(overshoot, room && left < area.right ? words : "", at, top - 4, F.frame);
  }

  return {
    charts: [x, F],
    resize: () => [x, F].forEach(({ frame }) => frame.resize()),
    show,
    mark(state) {
      x.mark(state.t, state.x);
      F.mark(state.t, state.F);
      put(pullDot, { cx: px(x.frame.x(state.t)), cy: px(x.frame.y(state.x_pull)) });
    },
  };
}

/** A chart's frame with bands for the phases, a cursor, and the stretch that is being chosen. */
export function makeChart(svg) {
  const frame = makeFrame(svg);
  const hatch = hatched(svg, `${svg.id}-hatch`, 6);
  draw(hatch, "rect", { class: "slip-band", width: 6, height: 6 });
  draw(hatch, "path", { class: "hatch", d: "M0 0V6" });
  const bands = {
    stick: draw(frame.under, "path", { class: "stick-band" }),
    slip: draw(frame.under, "path", { fill: `url(#${svg.id}-hatch)` }),
  };
  const choice = draw(frame.over, "rect", { class: "choice", visibility: "hidden" });
  const line = draw(frame.over, "path", { class: "cursor" });
  const dot = draw(frame.over, "circle", { class: "dot", r: 4 });

  return {
    frame,
    shade(phases) {
      const { top, bottom } = frame.area;
      const paths = { stick: "", slip: "" };
      for (const { kind, start, end } of phases) {
        const [left, right] = [start, end].map((t) => px(frame.x(t)));
        paths[kind] += `M${left} ${top}H${right}V${bottom}H${left}Z`;
      }
      for (const kind of ["stick", "slip"]) put(bands[kind], { d: paths[kind] });
    },
    /** @type {(t: number, value: number) => void} at a time [s] */
    mark(t, value) {
      put(line, { d: frame.upright(t) });
      put(dot, { cx: px(frame.x(t)), cy: px(frame.y(value)) });
    },
    /** @type {(a?: number, b?: number) => void} the stretch between two places [px], or none */
    choose(a, b) {
      const shown = b !== undefined;
      put(choice, { visibility: shown ? "visible" : "hidden" });
      if (!shown) return;
      const { top, height } = frame.area;
      put(choice, { x: Math.min(a, b), width: Math.abs(b - a), y: top, height });
    },
  };
}

/**
 * The steady cycles of a motion as they are drawn beside those of another, both from the end of
 * their first slips, in a width [px]; none where they would be a blur.
 * @type {(ghost: Motion, motion: Motion, seen: Seen, width: number) => SeenPhase[]}
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

/** Write a note where it is inside the plot [px], else hide it. */
function note(element, words, left, top, { area }) {
  if (words && top > area.top && top < area.bottom) write(element, words, left, top);
  else setText(element, "");
}
