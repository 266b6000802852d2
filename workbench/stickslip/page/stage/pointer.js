/** The pointer on a time chart: it reads, zooms into what is dragged over, and lets go. */

import { on } from "../view/dom.js";

/**
 * @import { Stretch } from "./stretch.js"
 * @import { Chart } from "./timecharts.js"
 */

/** A drag shorter than this was meant as a click [px]. */
const CLICK = 6;

/**
 * Listen to a chart.
 *
 * @param {Chart} chart
 * @param {Stretch} stretch the stretch of time
 * @param {{read: (t: number | null) => void, changed: () => void}} say what happens: read(t) the
 *   pointer is at t [s], or null: it left; changed() the stretch is another
 */
export function listen(chart, stretch, { read, changed }) {
  const { svg, area } = chart.frame;
  let began = null;

  /** @type {(event: MouseEvent) => number} [px] */
  const placeOf = (event) => {
    const left = event.clientX - svg.getBoundingClientRect().left;
    return Math.min(Math.max(left, area.left), area.right);
  };
  /** @type {(place: number) => number} from [px] to [s] */
  const timeAt = (place) => stretch.from + ((place - area.left) / area.width) * stretch.span;
  const end = () => {
    began = null;
    chart.choose();
  };

  on(svg, "pointerdown", (event) => {
    if (event.button !== 0) return;
    // A finger that moves along reads; only a mouse or a pen chooses.
    if (event.pointerType !== "touch") began = placeOf(event);
    svg.setPointerCapture(event.pointerId);
    read(timeAt(placeOf(event)));
  });
  on(svg, "pointermove", (event) => {
    const place = placeOf(event);
    read(timeAt(place));
    if (began !== null && Math.abs(place - began) > CLICK) chart.choose(began, place);
  });
  on(svg, "pointerup", (event) => {
    const place = placeOf(event);
    const times = began === null ? [] : [timeAt(began), timeAt(place)].sort((a, b) => a - b);
    const chosen = began !== null && Math.abs(place - began) > CLICK;
    end();
    if (!chosen) return;
    stretch.choose(...times);
    changed();
  });
  on(svg, "pointercancel", end);
  on(window, "keydown", ({ key }) => key === "Escape" && end());
  on(svg, "pointerleave", () => read(null));
  on(svg, "dblclick", () => {
    stretch.reset();
    changed();
  });
  const zoom = (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    const turn = Math.min(Math.max(0.002 * event.deltaY, -2), 2);
    stretch.zoom(Math.exp(turn), timeAt(placeOf(event)));
    changed();
  };
  on(svg, "wheel", zoom, { passive: false });
}
