/** Sentences that are often said: one click sets the stage, and the numbers say how it is. */

import { claimed } from "../model/claims.js";
import { kineticInUse } from "../model/friction.js";
import { on, put, setText } from "../view/dom.js";
import { digits, quantity } from "../view/units.js";

/**
 * @import { Page } from "../main.js"
 * @import { Curve } from "../model/curve.js"
 * @import { Setting } from "../model/friction.js"
 * @import { Solution } from "../view/solution.js"
 */

/**
 * What a sentence asks of the stage.
 *
 * @typedef {object} Sentence
 * @property {string} id
 * @property {Partial<Setting>} set the setting, the start values apart, SI
 * @property {Partial<Setting>} [before] what differs in the setting that it is compared with
 * @property {Curve} [curve] its friction curve
 * @property {"start"} [from] where the first load-up belongs to it
 */

/**
 * Bring the sentences to life.
 *
 * @param {Page} page
 * @param {Sentence[]} sentences
 * @param {Setting} starts the values of the FMU
 * @returns {(solution: Solution) => void} shows which sentence has set the stage
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

/** A number as the sentences show it: without noughts at its end. */
function figure(value, kind) {
  const text =
    kind === "percent"
      ? `${value < 0 ? "" : "+"}${digits(100 * value, 3)}\u00a0%`
      : kind === "times"
        ? digits(value, 3)
        : quantity(value, kind);
  return text.replace(/(\.\d*?)0+(?!\d)/, "$1").replace(/\.(?!\d)/, "");
}
