/** The applications: settings of known things, their countermeasures, and which one is shown. */

import { byId, on, put } from "../view/dom.js";

/**
 * Returns what shows which application the setting is of: by a button at the top and an entry in the
 * section. Countermeasures that change no parameter are null.
 * @type {(page: Page, applications: Application[]) => () => void}
 */
export function makeApplications(page, applications) {
  const names = Object.keys(page.setting());
  const parts = applications.map((application) => {
    const entry = byId(`application-${application.id}`);
    const button = document.querySelector(`[data-preset="${application.id}"]`);
    const own = Object.fromEntries(names.map((name) => [name, application[name]]));
    const choose = () => page.set(own, { curve: null });
    on(button, "click", choose);
    // Closed still: the click is about to open it.
    on(entry.querySelector("summary"), "click", () => entry.open || choose());
    const buttons = entry.querySelectorAll("button");
    application.cures.filter(Boolean).forEach((cure, at) => {
      on(buttons[at], "click", () => page.set({ ...own, ...cure }, { over: own, curve: null }));
    });
    return { button, entry, own };
  });

  let shown = null;
  return function show() {
    const current = parts.find(({ own }) => page.isUsed(own));
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
  const common = (one) => Object.keys(p).filter((name) => one[name] === p[name]).length;
  return applications.reduce((best, next) => (common(next) > common(best) ? next : best)).id;
}
