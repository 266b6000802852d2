/** The address bar holds the setting, so that a link or a bookmark brings it back. */

/** The address is written once the setting has been still this long [ms]. */
const STILL = 250;
/** Presses that follow each other faster are one step of the browser's Back [ms]. */
const ONE_STEP = 1000;

/**
 * What an address such as "#k=1000&v=0.02" (SI) asks for: numbers by name, the parts that are none,
 * and the points of a friction curve, from mu_1 on.
 * @type {(hash: string) => {values: Record<string, number>, bad: string[], points?: Curve}}
 */
export function valuesIn(hash) {
  /** @type {Record<string, number>} */
  const values = {};
  const bad = [];
  let points;
  for (const [name, text] of new URLSearchParams(hash.slice(1))) {
    const value = text.trim() === "" ? NaN : Number(text);
    const listed = [0, ...text.split(",").map(Number)];
    if (name === "curve" && listed.length % 2 === 0 && listed.every(Number.isFinite)) {
      points = /** @type {Curve} */ (listed.flatMap((u, n) => (n % 2 ? [] : [[u, listed[n + 1]]])));
    } else if (Number.isFinite(value)) values[name] = value;
    else bad.push(`${name}=${text}`);
  }
  return { values, bad, points };
}

/** @type {(values: Record<string, any>) => string} the part of an address that asks for these */
export function hashOf(values) {
  const parts = Object.entries(values).map(([name, value]) => `${name}=${value}`);
  return `#${parts.join("&")}`;
}

/**
 * Keep the address bar. place(): what it should hold; write(): once the page has been still a
 * moment; step(before, after): the setting changes at one press, so that the browser's Back brings
 * `before` back.
 * @type {(place: () => Record<string, any>) => any}
 */
export function makeAddress(place) {
  let waiting = 0;
  let last = -Infinity;
  const now = () => {
    // A write would end a way back that has just begun, so none is made for nothing.
    const hash = hashOf(place());
    if (hash !== location.hash) history.replaceState(null, "", hash);
  };
  const write = () => {
    clearTimeout(waiting);
    waiting = setTimeout(now, STILL);
  };
  // Where a link or Back has led is not written over before the page has taken it.
  addEventListener("popstate", write);
  return {
    write,
    step(before, after) {
      const pause = performance.now() - last;
      last += pause;
      if (pause < ONE_STEP) return;
      clearTimeout(waiting);
      history.replaceState(null, "", hashOf(before));
      history.pushState(null, "", hashOf(after));
    },
  };
}
