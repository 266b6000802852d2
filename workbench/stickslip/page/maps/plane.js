/** The plane of stiffness and speed: where there is no stick-slip, and the setting as a point. */

import { numbersOf } from "../model/friction.js";
import { criticalCurve, equalJump } from "../model/maps.js";
import { logAxis } from "../view/axis.js";
import { byId, draw, on, paths, put, setText } from "../view/dom.js";
import { hatched, makeFrame, makeTexts, polyline, px, write } from "../view/frame.js";
import { makeKnob } from "../view/knob.js";
import { whenSeen } from "../view/seen.js";
import { brief, quantity } from "../view/units.js";

/** Decades of each axis. */
const DECADES = 4;
/** Where the point is nearer to an edge than this part of the axis, the axis is placed anew. */
const EDGE = 0.06;
/** Lines of equal jump are drawn this often at most while a slider is dragged [ms]. */
const LINES_EVERY = 150;
/** An arrow key changes a parameter by this factor; a page key, or Shift, by so many of them. */
const KEY_STEP = 10 ** (1 / 40);
const PAGE = 10;
/** Room for the words of the free region [px]. */
const ROOM_FOR_WORDS = 30;
const MOST_LINES = 9;

/** @type {(page: Page) => (solution: Solution) => void} returns what shows a solution */
export function makePlane(page) {
  const svg = byId("plane");
  const frame = makeFrame(svg);
  draw(hatched(svg, "plane-hatch", 7), "path", { class: "free-line", d: "M0 0V7" });
  const free = draw(frame.under, "path", { fill: "url(#plane-hatch)" });
  const [lines, curve] = paths(frame.curves, "level", "curve mass");
  const words = draw(frame.over, "text", { class: "note", "text-anchor": "middle" });
  const nameLines = makeTexts(frame.over, { class: "note" });
  let spans = null;
  let p = null;
  let drawn = "";
  let waiting = 0;

  function show({ motion, v_c }) {
    p = motion.p;
    if (!knob.isHeld()) spans = { k: spanFor(p.k, spans?.k), v: spanFor(p.v, spans?.v) };
    // The plane depends on k and v by its axes alone.
    const now = JSON.stringify([{ ...p, k: 0, v: 0 }, spans, frame.area.width]);
    if (now !== drawn) {
      drawn = now;
      drawPlane();
      waiting ||= setTimeout(drawLines, LINES_EVERY);
    }
    const values = `k ${quantity(p.k, "stiffness")}, v ${quantity(p.v, "velocity")}`;
    const told = `${values}, ${motion.cycle.exists ? "stick-slip" : "no stick-slip"}`;
    const [place, ...range] = [p.k, spans.k.low, spans.k.high].map(Math.log10);
    knob.put(frame.x(p.k), frame.y(p.v), place, range, told);
    setText(byId("plane-said"), planeInWords(p, v_c, values));
  }

  /** @type {(values: {k: number, v: number}) => [x: number, y: number]} [px] */
  const placeOf = ({ k, v }) => [frame.x(k), frame.y(v)];

  function drawPlane() {
    const { k, v } = spans;
    const axis = logAxis(k.low, k.high, "stiffness", "k");
    frame.scale(axis, logAxis(v.low, v.high, "velocity", "v"));
    const { left, right, top, bottom } = frame.area;
    const points = criticalCurve(p, k.low, k.high).map(placeOf);
    put(curve, { d: polyline(points) });
    // Without damping there is no region without stick-slip; with it, all that is not below v_c.
    const under = points.length ? `H${px(points[0][0])}L${polyline(points).slice(1)}V${top}` : "V";
    const around = points.length ? `M${left} ${bottom}${under}H${left}Z` : "";
    const whole = `M${left} ${bottom}H${right}V${top}H${left}Z`;
    put(free, { d: p.c === 0 ? "" : around || whole });
    const { text, x, y } = wordsFor(points);
    write(words, text, x, y);
  }

  /** The words for the free region, where there is most room for them. */
  function wordsFor(points) {
    const { left, top, width, bottom } = frame.area;
    const middle = left + 0.5 * width;
    if (p.c === 0) return { text: "c = 0: stick-slip in the whole plane", x: middle, y: top + 30 };
    const rooms = [0.3, 0.5, 0.7].map((share) => {
      const x = left + share * width;
      const beyond = points.findIndex(([px]) => px >= x);
      // To the left of the curve all is free.
      const floor = beyond > 0 ? Math.min(points[beyond][1], points[beyond - 1][1]) : bottom;
      return { x, room: Math.min(floor, bottom) - top };
    });
    const best = rooms.reduce((one, other) => (other.room > one.room ? other : one));
    const hasRoom = best.room > ROOM_FOR_WORDS + 14;
    return { text: hasRoom ? "no stick-slip" : "", x: best.x, y: top + 0.5 * best.room + 8 };
  }

  function drawLines() {
    waiting = 0;
    const { left, right, top, bottom } = frame.area;
    let path = "";
    const names = [];
    for (const jump of levels(p, spans)) {
      const points = equalJump(p, jump, spans.v.low, spans.v.high).map(placeOf);
      path += polyline(points);
      const seen = points.find(
        ([x, y]) => x > left + 18 && x < right - 18 && y < bottom - 4 && y > top + 22,
      );
      if (seen) names.push([brief(jump, "length"), ...seen]);
    }
    nameLines(names);
    put(lines, { d: path });
  }

  function move(values) {
    const rounded = Object.entries(values).map(([name, value]) => [name, Number(value.toPrecision(3))]);
    try {
      page.set(Object.fromEntries(rounded));
    } catch {
      // What the page refuses, the point does not reach.
    }
  }

  /** @type {(x: number, y: number) => void} to a place in the drawing [px], held inside the plot */
  function moveTo(x, y) {
    const { left, right, top, bottom } = frame.area;
    move({
      k: frame.valueAtX(Math.min(Math.max(x, left), right)),
      v: frame.valueAtY(Math.min(Math.max(y, top), bottom)),
    });
  }

  on(svg, "click", ({ clientX, clientY }) => {
    const box = svg.getBoundingClientRect();
    moveTo(clientX - box.left, clientY - box.top);
  });
  const step = (right, up) => {
    // What is shown may be a few presses behind.
    const { k, v } = page.setting();
    move({ k: k * KEY_STEP ** right, v: v * KEY_STEP ** up });
  };
  const knob = makeKnob(byId("plane-point"), {
    place: () => placeOf(p),
    move: moveTo,
    step,
    more: PAGE,
    keys: {
      PageUp: () => step(0, PAGE),
      PageDown: () => step(0, -PAGE),
      Home: () => move({ k: spans.k.low }),
      End: () => move({ k: spans.k.high }),
    },
    // The axes follow once the point is let go, so that it stays under the pointer.
    drop: () => show(page.solution()),
  });
  return whenSeen("maps", page, [frame], show);
}

/**
 * The ends of an axis, whole decades: those in use while the value is well inside them.
 * @type {(value: number, old: {low: number, high: number} | undefined) => typeof old}
 */
function spanFor(value, old) {
  const share = old ? Math.log(value / old.low) / Math.log(old.high / old.low) : 0;
  if (share > EDGE && share < 1 - EDGE) return old;
  const low = Math.round(Math.log10(value) - 0.5 * DECADES);
  return { low: Number(`1e${low}`), high: Number(`1e${low + DECADES}`) };
}

/** The powers of ten among the jumps in the plane [m]. */
function levels(p, { k, v }) {
  const force = (p.mu_s - p.mu_k) * numbersOf(p).N;
  const swing = (speed, stiffness) => 2 * Math.PI * speed * Math.sqrt(p.m / stiffness);
  const least = Math.log10(force / k.high + swing(v.low, k.high));
  const most = Math.log10((2 * force) / k.low + swing(v.high, k.low));
  const step = Math.max(1, Math.ceil((most - least) / MOST_LINES));
  const found = [];
  for (let n = Math.ceil(least); n <= most; n += step) found.push(Number(`1e${n}`));
  return found;
}

function planeInWords(p, v_c, values) {
  if (p.c === 0) return `At ${values}: c = 0, so there is no critical velocity at any stiffness.`;
  if (v_c === 0) return `At ${values}: no stick-slip at any speed.`;
  const critical = quantity(v_c, "velocity");
  return p.v > v_c
    ? `At ${values}: no stick-slip, as v is above the critical ${critical}.`
    : `At ${values}: stick-slip; it ends above ${critical}.`;
}
