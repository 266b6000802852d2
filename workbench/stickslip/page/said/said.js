/** Sentences that are often said: one click sets the stage. */

import { kineticInUse } from "../model/friction.js";
import { on, put } from "../view/dom.js";

/**
 * Returns what shows which sentence has set the stage.
 * @type {(page: Page, sentences: Sentence[], starts: Setting) => (solution: Solution) => void}
 */
export function makeSaid(page, sentences, starts) {
  let chosen = "";
  const rows = sentences.map(({ id, set, curve = null, before, from }) => {
    const values = { ...starts, ...set };
    const button = document.querySelector(`[data-said="${id}"]`);
    on(button, "click", () => {
      chosen = id;
      if (before) page.set({ ...values, ...before }, { curve });
      page.set(values, { ghost: !!before, from: from ?? "cycles", curve });
    });
    return { id, button, curve, values: { ...values, mu_k: kineticInUse(values.mu_s, values.mu_k) } };
  });
  return ({ motion }) => {
    const { p } = motion;
    for (const { id, button, values, curve } of rows) {
      const isSet = id === chosen && `${curve}` === `${motion.curve}`;
      const current = isSet && Object.keys(values).every((name) => values[name] === p[name]);
      put(button, { "aria-pressed": current });
    }
  };
}
