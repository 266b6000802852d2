/** The story: its steps, one at a time, each with a setting of its own and a link that opens it. */

import { byId, on } from "../view/dom.js";

/**
 * The story changes no setting before the reader starts it.
 *
 * @param {Page} page
 * @param {Step[]} steps
 * @returns take(hash, moved): open the step that an address such as "#step=4" asks for, false if it
 *   asks for none; moved: whether the reader is to be led there; address(): the part of an address
 *   that opens the step shown while its setting is in use, else null
 */
export function makeStory(page, steps) {
  const articles = steps.map((_, at) => byId(`step=${at + 1}`));
  const links = document.querySelectorAll(".steps a");
  const [start, back, next] = ["start", "back", "next"].map((id) => byId(`story-${id}`));
  let shown = 0;
  let started = false;

  function turn(at) {
    shown = at;
    articles.forEach((article, each) => (article.hidden = each !== at));
    back.disabled = at === 0;
    next.disabled = at === steps.length - 1;
  }

  function open(at, moved) {
    started = true;
    start.hidden = true;
    back.hidden = next.hidden = false;
    turn(at);
    links.forEach((link, each) => {
      if (each === at) link.setAttribute("aria-current", "step");
      else link.removeAttribute("aria-current");
    });
    const { set, over, from, curve = null } = steps[at];
    if (over) page.set(steps[over - 1].set, { curve: null });
    page.set(set, { ghost: Boolean(over), from, curve });
    if (moved) articles[at].querySelector("h3").focus();
  }

  on(start, "click", () => open(0, true));
  on(back, "click", () => open(shown - 1, true));
  on(next, "click", () => open(shown + 1, true));
  byId("story-pager").hidden = false;
  turn(0);

  return {
    /** @param {string} hash @param {boolean} moved */
    take(hash, moved) {
      const at = articles.findIndex(({ id }) => hash === `#${id}`);
      if (at >= 0) open(at, moved);
      return at >= 0;
    },
    address() {
      const setting = page.setting();
      const { set, curve = null } = steps[shown];
      const own = Object.entries(set).every(([name, value]) => setting[name] === value);
      return started && own && `${curve}` === `${page.curve()}` ? { step: shown + 1 } : null;
    },
  };
}
