/** The presets: settings of known things, each with what it shows and its source. */

import { byId, on, setText } from "../view/dom.js";

/** @import { Setting } from "../model/friction.js" */

/** @typedef {Setting & {id: string, about: string, source: string}} Preset */

/**
 * Bring the presets to life.
 *
 * @param {Preset[]} presets of the page
 * @param {string[]} names of the parameters
 * @param {(values: Record<string, number>) => void} choose called with the values of the one that
 *   is chosen, SI
 * @returns {(setting: Setting) => void} shows which preset a setting is
 */
export function makePresets(presets, names, choose) {
  const buttons = new Map(
    presets.map(({ id }) => [id, document.querySelector(`[data-preset="${id}"]`)]),
  );
  const box = byId("preset-about");
  const valuesOf = (preset) => Object.fromEntries(names.map((name) => [name, preset[name]]));
  for (const preset of presets) {
    on(buttons.get(preset.id), "click", () => choose(valuesOf(preset)));
  }

  let shown = null;
  return function show(setting) {
    const current = presets.find((preset) => names.every((name) => preset[name] === setting[name]));
    if (shown === current) return;
    shown = current;
    for (const [id, button] of buttons) {
      button.setAttribute("aria-pressed", String(id === current?.id));
    }
    // Its line keeps its room.
    box.style.visibility = current ? "" : "hidden";
    if (!current) return;
    setText(box.querySelector("summary"), current.about);
    setText(box.querySelector("p"), current.source);
  };
}
