/** The force of the spring as a bar as long as its extension, and the force at which the teeth give. */

import { draw, put, setText } from "../view/dom.js";
import { px, write } from "../view/frame.js";
import { quantity } from "../view/units.js";

/** Height of the bar above the block, and how thick it is [px]. */
const ABOVE = 26;
const THICK = 8;
/** A letter is about this wide [px]. */
const GAUGE_LETTER = 6.3;

/**
 * Returns what scales the gauge for a motion; that returns what fills it for an extension [m] of
 * the spring that begins at a place [px].
 * @type {(svg: SVGSVGElement) => (layout: Layout, motion: Motion) => (z: number, right: number) => void}
 */
export function makeGauge(svg) {
  const group = draw(svg, "g", { class: "gauge" });
  const tie = draw(group, "path", { class: "tie force" });
  const track = draw(group, "path", { class: "rail" });
  const bar = draw(group, "rect", { class: "bar force", height: THICK });
  const limit = draw(group, "path", { class: "limit" });
  const name = draw(group, "text", { class: "force" });
  const words = draw(group, "text", { class: "limit" });
  setText(name, "F");
  return ({ base, most, scale, shortest, ground, tall, level, width }, { numbers, z_s }) => {
    const y = ground - tall - ABOVE - THICK;
    const at = (/** @type {number} */ z) => shortest + (z - base) * scale;
    const force = `Fₛ = ${quantity(numbers.F_s, "force")}`;
    const text = width > 620 ? `${force}: the teeth give` : force;
    const half = 0.5 * GAUGE_LETTER * text.length;
    // A gauge that does not begin at a relaxed spring shows that it is cut.
    const cut = `M2 ${THICK + 3}l4 ${-THICK - 6}m3 0l-4 ${THICK + 6}`;
    const zero = base <= 0 ? `M${px(at(0))} -3v${THICK + 6}` : cut;
    const from = Math.min(at(0), at(base)) > 0 ? at(base) : 0;
    put(track, { d: `${zero}M${px(from)} ${0.5 * THICK}H${px(at(most))}` });
    put(limit, { d: `M${px(at(z_s))} -5v${THICK + 10}` });
    return (z, right) => {
      const end = Math.max(at(z), 0);
      const begin = base <= 0 ? at(0) : 0;
      put(group, { transform: `translate(${px(right)} ${px(y)})` });
      put(bar, { x: px(Math.min(begin, end)), width: px(Math.abs(end - begin)) });
      put(tie, { d: `M${px(end)} ${THICK}V${px(level - y)}` });
      put(name, { x: px(end - 8), y: THICK + 14 });
      write(words, text, Math.min(right + at(z_s), width - half - 4) - right, -9);
    };
  };
}
