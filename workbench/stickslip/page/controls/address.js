/** The address bar holds the setting, so that a link or a bookmark brings it back. */

/** The address is written once the setting has been still this long [ms]. */
const STILL = 250;
/** Presses that follow each other faster are one step of the browser's Back [ms]. */
const ONE_STEP = 1000;

/**
 * The values that an address asks for.
 *
 * @param {string} hash such as "#k=1000&v=0.02", SI
 * @returns {{values: Record<string, number>, bad: string[]}} numbers by name, and the parts that
 *   are none
 */
export function valuesIn(hash) {
  /** @type {Record<string, number>} */
  const values = {};
  const bad = [];
  for (const [name, text] of new URLSearchParams(hash.slice(1))) {
    const value = text.trim() === "" ? NaN : Number(text);
    if (Number.isFinite(value)) values[name] = value;
    else bad.push(`${name}=${text}`);
  }
  return { values, bad };
}

/** The part of an address that asks for these values. */
function hashOf(values) {
  return `#${Object.entries(values)
    .map(([name, value]) => `${name}=${value}`)
    .join("&")}`;
}

/**
 * Keep the address bar.
 *
 * @returns write(values): write them once they have been still a moment; step(before, after):
 *   the setting changes at one press, so that the browser's Back brings `before` back
 */
export function makeAddress() {
  let waiting = 0;
  let last = -Infinity;
  return {
    write(/** @type {Record<string, number>} */ values) {
      clearTimeout(waiting);
      waiting = setTimeout(() => history.replaceState(null, "", hashOf(values)), STILL);
    },
    step(/** @type {Record<string, number>} */ before, /** @type {Record<string, number>} */ after) {
      const pause = performance.now() - last;
      last += pause;
      if (pause < ONE_STEP) return;
      clearTimeout(waiting);
      history.replaceState(null, "", hashOf(before));
      history.pushState(null, "", hashOf(after));
    },
  };
}
