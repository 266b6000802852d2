/** The applications: settings of known things, their countermeasures, and which one is shown. */

import { byId, on, put } from "../view/dom.js";

/**
 * Returns what shows which application a solution is of: by a button at the top and an entry in the
 * section. Countermeasures that change no parameter are null.
 * @type {(page: Page, applications: Application[]) => (solution: Solution) => void}
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

/** @type {(applications: Application[], p: Setting) => string} id of that with most values in use */
export function likest(applications, p) {
  /** @type {(application: Application) => number} */
  const common = (one) => Object.keys(p).filter((name) => one[name] === p[name]).length;
  return applications.reduce((best, next) => (common(next) > common(best) ? next : best)).id;
}
