/** The applications: settings of known things, their countermeasures, and which one is shown. */

import { byId, on, put } from "../view/dom.js";

/**
 * @import { Setting } from "../model/friction.js"
 * @import { Page } from "../main.js"
 * @import { Solution } from "../view/solution.js"
 */

/**
 * An application; a countermeasure that changes no parameter is null.
 *
 * @typedef {Setting & {id: string, cures: (Partial<Setting> | null)[]}} Application
 */

/**
 * Bring the applications to life: their buttons at the top and their entries in the section.
 *
 * @param {Page} page
 * @param {Application[]} applications
 * @returns {(solution: Solution) => void} shows which application a solution is of
 */
export function makeApplications(page, applications) {
  const names = Object.keys(page.setting());
  const parts = applications.map((application) => {
    const entry = byId(`application-${application.id}`);
    const part = {
      button: document.querySelector(`[data-preset="${application.id}"]`),
      entry,
      own: Object.fromEntries(names.map((name) => [name, application[name]])),
    };
    const choose = () => page.set(part.own, { curve: null });
    on(part.button, "click", choose);
    // Closed still: the click is about to open it.
    on(entry.querySelector("summary"), "click", () => entry.open || choose());
    const buttons = entry.querySelectorAll("button");
    application.cures.filter(Boolean).forEach((cure, at) => {
      on(buttons[at], "click", () => {
        choose();
        page.set(cure, { ghost: true });
      });
    });
    return part;
  });

  let shown = null;
  return function show({ motion: { p, curve } }) {
    const current = parts.find(({ own }) => !curve && names.every((name) => own[name] === p[name]));
    if (shown === current) return;
    shown = current;
    for (const part of parts) {
      put(part.button, { "aria-pressed": part === current });
      if (current) part.entry.open = part === current;
    }
  };
}
