/** Parts of the page that are out of sight wait: what is seen is drawn first. */

/** What is out of sight is brought up to date once nothing has changed for this long [ms]. */
const UNSEEN_STILL = 250;

/**
 * What draws at once where the element is in sight, else when it comes into sight or nothing has
 * changed for a while.
 *
 * @template What
 * @param {Element} element where it is shown
 * @param {(what: What) => void} show draws it
 * @returns {(what: What) => void}
 */
export function whenSeen(element, show) {
  /** @type {What | null} */
  let latest = null;
  let inSight = false;
  let waiting = 0;
  const flush = () => {
    clearTimeout(waiting);
    if (latest === null) return;
    const what = latest;
    latest = null;
    show(what);
  };
  new IntersectionObserver((entries) => {
    inSight = entries[entries.length - 1].isIntersecting;
    if (inSight) flush();
  }).observe(element);
  addEventListener("beforeprint", flush);
  return (what) => {
    latest = what;
    if (inSight) return flush();
    clearTimeout(waiting);
    waiting = setTimeout(flush, UNSEEN_STILL);
  };
}
