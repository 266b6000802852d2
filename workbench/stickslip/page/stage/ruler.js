/** The ruler under the ground. */

import { roundStep } from "../view/axis.js";
import { draw, put } from "../view/dom.js";
import { makeTexts, px, write } from "../view/frame.js";
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
