/** The pointer on a time chart: it reads, zooms into what is dragged over, and lets go. */

import { on } from "../view/dom.js";

/** A drag shorter than this was meant as a click [px]. */
const CLICK = 6;
/** Fingers nearer to each other than this tell no stretch [px]. */
const NEAREST = 12;

/**
 * Listen to a chart, and choose the stretch of time; read(t) says that the pointer is at t [s], or
 * null: it left.
 * @type {(chart: Chart, stretch: Stretch, read: (t: number | null) => void) => void}
 */
export function listen(chart, stretch, read) {
  const { svg, area } = chart.frame;
  let began = null;
  /** @type {Map<number, number>} places of the fingers [px] */
  const fingers = new Map();
  /** @type {number[]} the times under two fingers when the second came [s] */
  let held = [];

  /** @type {(event: MouseEvent) => number} [px] */
  const placeOf = (event) => {
    const left = event.clientX - svg.getBoundingClientRect().left;
    return Math.min(Math.max(left, area.left), area.right);
  };
  /** @type {(place: number) => number} from [px] to [s] */
  const timeAt = (place) => stretch.from + ((place - area.left) / area.width) * stretch.span();
  const end = () => {
    began = null;
    chart.choose();
  };

  /** What was under two fingers stays under them. */
  const pinch = () => {
    const [a, b] = [...fingers.values()];
    if (Math.abs(a - b) < NEAREST || held[0] === held[1]) return;
    const perPixel = (held[1] - held[0]) / (b - a);
    if (!(perPixel > 0)) return;
    const from = held[0] - (a - area.left) * perPixel;
    stretch.choose(from, from + area.width * perPixel);
  };
  const lift = (event) => {
    fingers.delete(event.pointerId);
    held = [];
    end();
  };

  on(svg, "pointerdown", (event) => {
    if (event.button !== 0) return;
    const place = placeOf(event);
    svg.setPointerCapture(event.pointerId);
    // One finger that moves along reads, two zoom; a mouse or a pen chooses.
    if (event.pointerType !== "touch") began = place;
    else fingers.set(event.pointerId, place);
    held = fingers.size === 2 ? [...fingers.values()].map(timeAt) : [];
    read(held.length ? null : timeAt(place));
  });
  on(svg, "pointermove", (event) => {
    const place = placeOf(event);
    if (fingers.has(event.pointerId)) fingers.set(event.pointerId, place);
    if (held.length) return pinch();
    read(timeAt(place));
    if (began !== null && Math.abs(place - began) > CLICK) chart.choose(began, place);
  });
  on(svg, "pointerup", (event) => {
    const [from, to] = [began, placeOf(event)];
    lift(event);
    if (from === null || Math.abs(to - from) <= CLICK) return;
    stretch.choose(...[timeAt(from), timeAt(to)].sort((a, b) => a - b));
  });
  on(svg, "pointercancel", lift);
  on(window, "keydown", ({ key }) => key === "Escape" && end());
  on(svg, "pointerleave", () => read(null));
  on(svg, "dblclick", stretch.reset);
  const zoom = (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const turn = Math.min(Math.max(0.002 * event.deltaY, -2), 2);
    stretch.zoom(Math.exp(turn), timeAt(placeOf(event)));
  };
  on(svg, "wheel", zoom, { passive: false });
}
