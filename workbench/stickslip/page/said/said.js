/** Sentences that are often said: one click sets the stage. */

import { on, put } from "../view/dom.js";

/**
 * Returns what shows which sentence has set the stage.
 * @type {(page: Page, sentences: Sentence[], starts: Setting) => () => void}
 */
export function makeSaid(page, sentences, starts) {
  let chosen = "";
  const rows = sentences.map(({ id, set, curve = null, before, from }) => {
    const values = { ...starts, ...set };
    const button = document.querySelector(`[data-said="${id}"]`);
    on(button, "click", () => {
      chosen = id;
      page.set(values, { over: before && { ...values, ...before }, from, curve });
    });
    return { id, button, curve, values };
  });
  return () => {
    for (const { id, button, values, curve } of rows) {
      put(button, { "aria-pressed": id === chosen && page.isUsed(values, curve) });
    }
  };
}
