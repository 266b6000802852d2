/** Sentences that are often said: one click sets the stage, and the numbers say how it is. */

import { claimed } from "../model/claims.js";
import { kineticInUse } from "../model/friction.js";
import { on, put, setText } from "../view/dom.js";
import { digits, quantity, withoutNoughts } from "../view/units.js";

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
    fillIn(id, claimed(id, values, curve));
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

/** Write the numbers of a sentence into its text. */
function fillIn(id, numbers) {
  for (const element of document.querySelectorAll(`#said-${id} data`)) {
    const [name, kind] = /** @type {HTMLElement} */ (element).dataset.of.split(":");
    put(element, { value: numbers[name] });
    setText(element, figure(numbers[name], kind));
  }
}

/** A number as the sentences show it. */
function figure(value, kind) {
  const percent = () => `${value < 0 ? "" : "+"}${digits(100 * value, 3)}\u00a0%`;
  const own = { percent, times: () => digits(value, 3) }[kind];
  return withoutNoughts(own ? own() : quantity(value, kind));
}
