/** The story: its steps, one at a time, each with a setting of its own and a link that opens it. */

import { byId, on, put } from "../view/dom.js";

/**
 * The story changes no setting before the reader starts it.
 *
 * @type {(page: Page, steps: Step[]) => any} take(hash, moved): open the step that an address such as
 *   "#step=4" asks for, and lead the reader there, false if it asks for none; address(): the part of
 *   an address that opens the step shown while its setting is in use, else null
 */
export function makeStory(page, steps) {
  const articles = steps.map((_, at) => byId(`step=${at + 1}`));
  const links = document.querySelectorAll(".steps a");
  const [start, back, next] = ["start", "back", "next"].map((id) => byId(`story-${id}`));
  let shown = 0;

  function turn(at) {
    shown = at;
    articles.forEach((article, each) => (article.hidden = each !== at));
    back.disabled = at === 0;
    next.disabled = at === steps.length - 1;
  }

  function open(at, moved) {
    start.hidden = true;
    back.hidden = next.hidden = false;
    turn(at);
    links.forEach((link, each) => put(link, { "aria-current": each === at ? "step" : "false" }));
    const { set, over, from, curve = null } = steps[at];
    page.set(set, { over: over && steps[over - 1].set, from, curve });
    if (moved) articles[at].querySelector("h3").focus();
  }

  on(start, "click", () => open(0, true));
  on(back, "click", () => open(shown - 1, true));
  on(next, "click", () => open(shown + 1, true));
  byId("story-pager").hidden = false;
  turn(0);

  return {
    take(hash, moved) {
      const at = articles.findIndex(({ id }) => hash === `#${id}`);
      if (at >= 0) open(at, moved);
      return at >= 0;
    },
    address() {
      const { set, curve } = steps[shown];
      return start.hidden && page.isUsed(set, curve) ? { step: shown + 1 } : null;
    },
  };
}
