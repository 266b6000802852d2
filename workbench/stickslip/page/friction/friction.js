/** The friction curve: its points are dragged, and the bar under it says what each speed gives. */

import { regimesOf } from "../model/regimes.js";
import { CURVE_POINTS, coefficientAt } from "../model/friction.js";
import { save } from "../keeping/keeping.js";
import { axisOf, decades, logAxis } from "../view/axis.js";
import { byId, draw, on, paths, put, setText } from "../view/dom.js";
import { makeFrame, polyline, px, write } from "../view/frame.js";
import { makeKnob } from "../view/knob.js";
import { whenSeen } from "../view/seen.js";
import { quantity } from "../view/units.js";
import { drawBar, nameOfRegime, regimesInWords } from "./bar.js";
import { curveIn, tableOf } from "./table.js";

/** Parts of the speed between two samples of the bar: while it moves, and once it is still [ms]. */
const COARSE = 0.06;
const FINE = 0.01;
const BAR_STILL = 250;
/** Points of a line as it is drawn over the logarithm of the speed. */
const LINE_PARTS = 150;
/** An arrow key changes a speed by this factor and a coefficient by this much; with Shift by more. */
const KEY_FACTOR = 1.05;
const KEY_MU = 0.01;
const MORE = 5;
/** What is about constant friction says so while a curve is set. */
const ABOUT_CONSTANT = ["mu_k-control", "said", "cures", "maps", "bristles", "questions", "theory"];

/**
 * Returns what shows a solution; curves are offered, and set the FMU's start values too.
 * @type {(page: Page, curves: {set: Setting, points: Curve}[], starts: Setting, reader: Reader) =>
 *   (solution: Solution) => void}
 */
export function makeFriction(page, curves, starts, reader) {
  const svg = byId("friction-chart");
  const frame = makeFrame(svg);
  const bar = byId("friction-bar");
  const [limit, line, here] = paths(frame.curves, "threshold", "curve force", "cursor");
  const limitName = draw(frame.over, "text", { class: "note limit" });
  const speed = byId("friction-v");
  const table = byId("friction-text");
  const bad = byId("friction-bad");
  const buttons = [...document.querySelectorAll("[data-curve]")];
  const notes = ABOUT_CONSTANT.map((id, n) => {
    const note = document.createElement("p");
    note.className = "small";
    const about = "A friction curve is set; this is about constant μs and μk.";
    note.textContent = n ? about : "Not used: a friction curve is set.";
    byId(id).querySelector("h2, .typed").after(note);
    return note;
  });
  /** @type {HTMLElement[]} one for each point that a curve may have */
  const knobs = [...svg.parentElement.querySelectorAll(".knob:not(#friction-v)")];
  knobs.forEach((knob, n) => on(knob, "focus", () => (chosen = n)));
  /** @type {Curve} the curve in use, or the constant as one */
  let points = [];
  let span = null;
  let regimes = [];
  let chosen = 1;
  let waiting = 0;
  let key = "";

  function show({ motion }) {
    const { p, curve } = motion;
    points = curve ?? [[0, p.mu_k], [Number((5 * p.v).toPrecision(1)), p.mu_k]];
    if (!handles.some(({ isHeld }) => isHeld())) span = spanOf(p, points);
    const coefficients = { ...axisOf([0, span.top], "number", "μ", 0), title: "μ" };
    frame.scale(logAxis(span.low, span.high, "velocity", "speed"), coefficients);
    const { left, right, width } = frame.area;
    const step = (span.high / span.low) ** (1 / LINE_PARTS);
    const speeds = points.map(([u]) => u || span.low);
    for (let n = 0; n <= LINE_PARTS; n++) speeds.push(span.low * step ** n);
    speeds.sort((a, b) => a - b);
    put(line, { d: polyline(speeds.map((u) => [frame.x(u), frame.y(coefficientAt(points, u))])) });
    put(limit, { d: frame.level(p.mu_s) });
    write(limitName, "μₛ", right - 18, px(frame.y(p.mu_s)) - 4);
    put(here, { d: frame.upright(p.v) });
    knobs.forEach((knob, n) => {
      knob.hidden = n >= points.length;
      if (knob.hidden) return;
      const [u, mu] = points[n];
      const words = `${quantity(u, "velocity")}, μ ${mu}`;
      handles[n].put(n ? frame.x(u) : left, frame.y(mu), mu, [0, span.top], words);
    });
    byId("point-more").disabled = points.length === CURVE_POINTS.most;
    byId("point-less").disabled = points.length === CURVE_POINTS.least;
    buttons.forEach((button, n) => {
      put(button, { "aria-pressed": page.isUsed({}, n ? curves[n - 1].points : null) });
    });
    for (const note of notes) note.hidden = !curve;
    const now = JSON.stringify([{ ...p, v: 0 }, curve, span, width]);
    if (now !== key) {
      key = now;
      // A refusal stands until something else is taken, as the table that it is about.
      if (table !== document.activeElement) table.value = tableOf(points);
      setText(bad, "");
      lay(COARSE);
    }
    const regime = regimes.find(({ high }) => p.v <= high) ?? regimes[0];
    const words = `${quantity(p.v, "velocity")}, ${nameOfRegime(regime)}`;
    const ends = [span.low, span.high];
    handles[knobs.length].put(frame.x(p.v), svg.clientHeight + 38, p.v, ends, words);
    setText(byId("friction-said"), regimesInWords(regimes, p.v, motion.slip.settles()));

    /** @type {(step: number) => void} the bar, and again with all detail once nothing moves */
    function lay(step) {
      clearTimeout(waiting);
      regimes = regimesOf(p, points, span.low, span.high, step);
      drawBar(bar, regimes, frame);
      if (!curve || step === FINE) return;
      waiting = setTimeout(() => {
        lay(FINE);
        // The speed may have changed since.
        show(page.solution());
      }, BAR_STILL);
    }
  }

  /** Take a curve, or a speed of the pull, if the page does; `curve` may have to be read. */
  function take(values, curve, still = true) {
    try {
      page.set(values, { curve: typeof curve === "function" ? curve() : curve, still });
      setText(bad, "");
    } catch (error) {
      setText(bad, error.message);
    }
  }

  /** @type {(n: number, u: number, mu: number) => void} put a point, or the speed of the pull */
  function move(n, u, mu) {
    const within = (value, low, high) => Math.min(Math.max(value, low), high);
    if (n < 0) return take({ v: Number(within(u, span.low, span.high).toPrecision(3)) });
    const least = n > 1 ? points[n - 1][0] * 1.01 : span.low;
    const most = n + 1 < points.length ? points[n + 1][0] / 1.01 : span.high;
    const next = [...points];
    const highest = n ? span.top : page.setting().mu_s;
    // The ends of what a point may be are no round numbers.
    const rounded = n ? within(Number(u.toPrecision(3)), least, most) : 0;
    next[n] = [rounded, within(Number(mu.toFixed(3)), 0, highest)];
    take({}, next);
  }

  const handles = [...knobs, speed].map((knob, at) => {
    const n = knob === speed ? -1 : at;
    const now = () => (n < 0 ? [page.setting().v, 0] : (page.solution().motion.curve ?? points)[n]);
    return makeKnob(knob, {
      place() {
        const [u, mu] = now();
        return [frame.x(u || span.low), frame.y(mu)];
      },
      move: (x, y) => move(n, frame.valueAtX(x), frame.valueAtY(y)),
      step(right, up) {
        const [u, mu] = now();
        move(n, u * KEY_FACTOR ** (n < 0 ? right + up : right), mu + up * KEY_MU);
      },
      more: MORE,
      keys: { Delete: () => n > 0 && byId("point-less").click() },
      drop: () => show(page.solution()),
    });
  });

  buttons.forEach((button, n) => {
    on(button, "click", () => {
      if (!n) return page.set({}, { curve: null });
      const { set, points } = curves[n - 1];
      page.set({ ...starts, ...set }, { curve: points });
    });
  });
  on(byId("point-more"), "click", () => {
    // What is drawn may be a press behind. Half-way to the next point, as the axis is; beyond the
    // last at twice its speed.
    points = page.solution().motion.curve ?? points;
    const n = Math.min(chosen, points.length - 1);
    const [[low], [high]] = [points[n], points[n + 1] ?? [2 * points[n][0]]];
    const u = Number((points[n + 1] ? Math.sqrt((low || 0.1 * high) * high) : high).toPrecision(3));
    chosen = n + 1;
    take({}, points.toSpliced(n + 1, 0, [u, coefficientAt(points, u)]));
  });
  on(byId("point-less"), "click", () => {
    points = page.solution().motion.curve ?? points;
    const n = Math.min(Math.max(chosen, 1), points.length - 1);
    chosen = n - 1;
    if (points.length > CURVE_POINTS.least) take({}, points.toSpliced(n, 1));
  });
  const read = () => take({}, () => curveIn(table.value, reader), false);
  on(table, "change", read);
  on(byId("friction-file"), "change", async ({ target }) => {
    table.value = await target.files[0].text();
    read();
  });
  on(byId("friction-save"), "click", () => save("curve.csv", tableOf(points), "text/csv"));

  return whenSeen("friction", page, [frame], show);
}

/**
 * The ends of the axes: whole decades about the points and the speed, and room above the friction.
 * @type {(p: Setting, points: Curve) => {low: number, high: number, top: number}}
 */
function spanOf({ v, mu_s }, points) {
  const [least, most] = [Math.min(v, points[1][0]), Math.max(v, points[points.length - 1][0])];
  const top = 1.25 * Math.max(mu_s, ...points.map(([, mu]) => mu)) || 1;
  return { ...decades(least / 3, 1.5 * most), top };
}
