/** The drawing of an application about the model: on the mass, at the pulled end and on the ground. */

import { byId, draw, put } from "../view/dom.js";
import { write } from "../view/frame.js";

/** Height of the drawings in their own units. */
const UNITS = 100;
/** A letter of the caption is about this wide [px]. */
const CAPTION_LETTER = 7;

/**
 * Bring the drawings to the parts that take one, and to either end of the ground. dress(id, words):
 * take the drawing of an application; shape(): of its body; lay(layout).
 */
export function makeScene(svg) {
  for (const part of ["left", "right"]) {
    svg.querySelector(".mass").before(draw(svg, "use", { "data-part": part }));
  }
  const parts = svg.querySelectorAll("use");
  const caption = draw(svg, "text", { class: "caption" });
  let said = "";
  return {
    dress(id, words) {
      put(svg, { "data-drawing": id, "aria-label": words });
      for (const part of parts) put(part, { href: `#${id}-${part.dataset.part}` });
      said = words;
    },
    shape: () => byId(`${svg.dataset.drawing}-mass`).dataset,
    lay({ width, ground, tall }) {
      const size = `scale(${tall / UNITS})`;
      const places = { left: `translate(0 ${ground})`, right: `translate(${width} ${ground})` };
      for (const part of parts) {
        put(part, { transform: `${places[part.dataset.part] ?? ""}${size}` });
      }
      const fits = ground - tall >= 70 && CAPTION_LETTER * said.length < width;
      write(caption, fits ? said : "", 8, 14);
    },
  };
}
