/**
 * The scales of the schematic: the force of the spring as a bar as long as its extension, with the
 * force at which the teeth give, and the ruler under the ground.
 */

import { roundStep } from "../view/axis.js";
import { draw, paths, put, setText } from "../view/dom.js";
import { makeTexts, px, write } from "../view/frame.js";
import { quantity, scaleFor } from "../view/units.js";

/** Height of the bar above the block, and how thick it is [px]. */
const ABOVE = 26;
const THICK = 8;
/** A letter is about this wide [px]. */
const GAUGE_LETTER = 6.3;
/** Pixels between two numbers, at least. */
const MARKS_APART = 58;

/**
 * Returns what scales the gauge for a motion; that returns what fills it for an extension [m] of
 * the spring that begins at a place [px].
 * @type {(svg: SVGSVGElement) => (layout: Layout, motion: Motion) => (z: number, right: number) => void}
 */
export function makeGauge(svg) {
  const group = draw(svg, "g", { class: "gauge" });
  const [tie, track] = paths(group, "tie force", "rail");
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

/**
 * Returns what scales the ruler for a window's length [m]; that returns what labels it for the
 * window that starts at a position [m].
 * @type {(svg: SVGSVGElement) => (layout: Layout, length: number) => (start: number) => void}
 */
export function makeRuler(svg) {
  const group = draw(svg, "g", { class: "ruler" });
  const marks = draw(group, "path");
  const name = draw(group, "text", { class: "unit" });
  const label = makeTexts(group);
  return ({ left, block, ground, scale, width }, length) => {
    const { size, unit } = scaleFor(length, "length");
    const step = roundStep(MARKS_APART / (scale * size));
    const apart = step * size * scale;
    const zero = left + 0.5 * block;
    const y = ground + 30;
    write(name, unit, width - 6, y);
    return (start) => {
      const first = Math.floor(start / (step * size) - zero / apart);
      let d = "";
      const labels = [];
      for (let n = first; n < first + Math.floor(width / apart + 3); n++) {
        const at = zero + (n - start / (step * size)) * apart;
        for (let j = 0; j < 5; j++) d += `M${px(at + j * apart * 0.2)} ${ground + 11}v${j ? 3 : 7}`;
        const text = String(Number((n * step).toPrecision(12))).replace("-", "−");
        const roomy = n % Math.ceil((text.length * 8) / apart) === 0;
        if (roomy && at > 12 && at < width - 44) labels.push([text, at, y]);
      }
      put(marks, { d });
      label(labels);
    };
  };
}
