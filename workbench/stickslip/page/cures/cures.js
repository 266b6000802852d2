/** What suppresses the cycle: a table of values, each of them a button that sets it. */

import { curesOf, valueBeyond } from "../model/cures.js";
import { numbersOf } from "../model/friction.js";
import { byId, on, put, setText } from "../view/dom.js";
import { whenSeen } from "../view/seen.js";
import { digits, quantity } from "../view/units.js";

/**
 * @import { Page } from "../main.js"
 * @import { Cure, Cures } from "../model/cures.js"
 * @import { Setting } from "../model/friction.js"
 * @import { Solution } from "../view/solution.js"
 */

/**
 * What a cell of the table offers.
 *
 * @typedef {object} Offer
 * @property {number} [value] of the parameter [SI]; without one the cell only says why
 * @property {string} words beneath the value, or in its place
 */

/** A parameter that changes by more than this factor is out of reach of a design. */
const REACH = 100;
/** So is a damping ratio above this: slides and drives have 0.01 to 0.1. */
const MOST_ZETA = 0.5;

/**
 * Bring the cures to life.
 *
 * @param {Page} page
 * @returns {(solution: Solution) => void} shows the cures of a solution
 */
export function makeCures(page) {
  const lead = byId("cures-lead");
  const told = byId("cures-said");
  const back = byId("cures-back");
  const rows = ["k", "c", "v", "mu_k", "load", "m"].map((parameter) => {
    const body = byId(`cure-${parameter}`);
    const [halve, end] = body.rows[0].cells.length ? [...body.rows[0].cells].slice(1) : [];
    return { parameter, now: body.querySelector(".now"), cells: [makeCell(halve), makeCell(end)] };
  });
  /** @type {Partial<Setting> | null} */
  let before = null;

  /** @type {(values: Partial<Setting>, words: string) => void} */
  function set(values, words) {
    const old = page.setting();
    try {
      page.set(values, { ghost: true });
    } catch (error) {
      setText(told, error.message);
      return;
    }
    before = old;
    back.disabled = false;
    setText(told, words);
  }
  on(back, "click", () => {
    page.set(before);
    setText(told, "Set back.");
    // A button that is disabled loses the focus.
    byId("cures-title").focus();
    back.disabled = true;
  });

  /** @param {HTMLTableCellElement} cell */
  function makeCell(cell) {
    const made = { cell, shown: "", parts: [] };
    return made;
  }

  /**
   * @param {ReturnType<typeof makeCell>} made
   * @param {Setting} p
   * @param {string} parameter
   * @param {Offer[]} offers
   * @param {string} aim what the value does
   */
  function fill(made, p, parameter, offers, aim) {
    const shown = JSON.stringify(offers);
    if (made.shown === shown) return;
    made.shown = shown;
    offers.forEach(({ value, words }, index) => {
      made.parts[index] ??= makePart(made.cell);
      const { button, small } = made.parts[index];
      button.hidden = value === undefined;
      small.hidden = false;
      setText(small, words);
      if (value === undefined) return;
      const text = shownValue(p, parameter, value);
      setText(button, text);
      put(button, { "aria-label": `Set ${NAMES[parameter]} to ${text}: ${aim}` });
      button.onclick = () => set({ [parameter]: value }, `${NAMES[parameter]} is ${text} now.`);
    });
    for (const { button, small } of made.parts.slice(offers.length)) {
      button.hidden = true;
      small.hidden = true;
    }
  }

  return whenSeen(byId("cures"), ({ motion: { p } }) => {
    const found = curesOf(p);
    setText(lead, inWords(p, found));
    /** @type {Record<string, Cure>} */
    const by = Object.fromEntries(found.cures.map((cure) => [cure.name, cure]));
    for (const { parameter, now, cells } of rows) {
      setText(now, shownValue(p, parameter, p[parameter]));
      const offers = found.cures.length ? offersOf(p, by, parameter) : [NOTHING, NOTHING];
      fill(cells[0], p, parameter, offers[0], "halves the jump");
      fill(cells[1], p, parameter, offers[1], "ends the cycle");
    }
  });
}
