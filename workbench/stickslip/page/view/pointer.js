/** The pointer on a time chart: it reads, zooms into what is dragged over, and lets go. */

/** A drag shorter than this was meant as a click [px]. */
const CLICK = 6;

/**
 * Listen to a chart.
 *
 * @param {object} chart with its frame and choose(a, b)
 * @param {object} stretch the stretch of time
 * @param {object} say what happens: read(t) the pointer is at t, or null: it left; changed() the
 *   stretch is another
 */
export function listen(chart, stretch, { read, changed }) {
  const { svg, area } = chart.frame;
  let began = null;

  const placeOf = (event) => {
    const left = event.clientX - svg.getBoundingClientRect().left;
    return Math.min(Math.max(left, area.left), area.right);
  };
  const timeAt = (place) => stretch.from + ((place - area.left) / area.width) * stretch.span;
  const end = () => {
    began = null;
    chart.choose();
  };

  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    // A finger that moves along reads; only a mouse or a pen chooses.
    if (event.pointerType !== "touch") began = placeOf(event);
    svg.setPointerCapture(event.pointerId);
    read(timeAt(placeOf(event)));
  });
  svg.addEventListener("pointermove", (event) => {
    const place = placeOf(event);
    read(timeAt(place));
    if (began !== null && Math.abs(place - began) > CLICK) chart.choose(began, place);
  });
  svg.addEventListener("pointerup", (event) => {
    const place = placeOf(event);
    const times = began === null ? [] : [timeAt(began), timeAt(place)].sort((a, b) => a - b);
    const chosen = began !== null && Math.abs(place - began) > CLICK;
    end();
    if (!chosen) return;
    stretch.choose(...times);
    changed();
  });
  svg.addEventListener("pointercancel", end);
  svg.addEventListener("pointerleave", () => read(null));
  svg.addEventListener("dblclick", () => {
    stretch.reset();
    changed();
  });
  svg.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      stretch.zoom(Math.exp(0.002 * event.deltaY), timeAt(placeOf(event)));
      changed();
    },
    { passive: false },
  );
}
