/** Parts of the page that are out of sight wait: what is seen is drawn first. */

import { byId } from "./dom.js";

/** What is out of sight is brought up to date once nothing has changed for this long [ms]. */
const UNSEEN_STILL = 250;

/**
 * What shows a solution in a section, once its frames have a size: at once where it is in sight, else
 * when it comes into sight or nothing has changed for a while.
 * @type {(id: string, page: Page, frames: Frame[], show: (solution: Solution) => void) =>
 *   (solution: Solution) => void}
 */
export function whenSeen(id, page, frames, show) {
  let latest = null;
  let sized = !frames.length;
  let inSight = false;
  let waiting = 0;
  const flush = () => {
    clearTimeout(waiting);
    if (latest && sized) show(latest);
    latest = null;
  };
  new IntersectionObserver((entries) => {
    inSight = entries[entries.length - 1].isIntersecting;
    if (inSight) flush();
  }).observe(byId(id));
  addEventListener("beforeprint", flush);
  const resizes = new ResizeObserver(() => {
    for (const frame of frames) frame.resize();
    sized = true;
    show(page.solution());
  });
  for (const { svg } of frames) resizes.observe(svg);
  return (solution) => {
    latest = solution;
    if (inSight) return flush();
    clearTimeout(waiting);
    waiting = setTimeout(flush, UNSEEN_STILL);
  };
}
