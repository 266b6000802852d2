/** The ruler under the ground. */

import { draw, put } from "../view/dom.js";
import { px, write } from "../view/frame.js";
import { scaleFor } from "../view/units.js";

/** Pixels between two numbers, at least. */
const MARKS_APART = 58;

/**
 * Returns what scales the ruler for a window's length [m]; that returns what labels it for the
 * window that starts at a position [m].
 * @type {(svg: SVGSVGElement) => (layout: Layout, length: number) => (start: number) => void}
 */
export function makeRuler(svg) {
  const group = draw(svg, "g", { class: "ruler" });
  const marks = draw(group, "path");
  const name = draw(group, "text", { class: "unit" });
  const labels = [];
  return ({ left, block, ground, scale, width }, length) => {
    const { size, unit } = scaleFor(length, "length");
    const step = roundStep(MARKS_APART / (scale * size));
    const apart = step * size * scale;
    const zero = left + 0.5 * block;
    const y = ground + 30;
    write(name, unit, width - 6, y);
    const count = Math.floor(width / apart + 3);
    while (labels.length < count) labels.push(draw(group, "text"));
    for (const label of labels.splice(count)) label.remove();
    return (start) => {
      const first = Math.floor(start / (step * size) - zero / apart);
      let d = "";
      labels.forEach((label, i) => {
        const at = zero + (first + i - start / (step * size)) * apart;
        for (let j = 0; j < 5; j++) d += `M${px(at + j * apart * 0.2)} ${ground + 11}v${j ? 3 : 7}`;
        const text = String(Number(((first + i) * step).toPrecision(12))).replace("-", "−");
        const roomy = (first + i) % Math.ceil((text.length * 8) / apart) === 0;
        write(label, roomy && at > 12 && at < width - 44 ? text : "", at, y);
      });
      put(marks, { d });
    };
  };
}

/** The least of 1, 2, 5, 10, ... that is not below a number. */
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= least * 0.999);
}
