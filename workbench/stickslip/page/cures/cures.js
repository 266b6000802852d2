/** What suppresses the cycle: a table of values, each of them a button that sets it. */

import { curesOf, valueBeyond } from "../model/cures.js";
import { numbersOf } from "../model/friction.js";
import { whyNone } from "../results/results.js";
import { byId, data, on, put, setText } from "../view/dom.js";
import { whenSeen } from "../view/seen.js";
import { brief, digits, quantity } from "../view/units.js";

/** A parameter that changes by more than this factor is out of reach of a design. */
const REACH = 100;
/** So is a damping ratio above this: slides and drives have 0.01 to 0.1. */
const MOST_ZETA = 0.5;
/** A damping ratio that is often met. */
const USUAL_ZETA = 0.03;

/** Of the row of the speed one way halves the jump, and the other ends the cycle. */
const WAYS = { speed: ["slower", "faster"] };
/** @type {(parameter: string) => Control} what a parameter is set by: of the load, the normal force */
const controlOf = (parameter) =>
  data.controls.find(({ name }) => name === (parameter === "load" ? "N" : parameter));

/** @type {(page: Page) => (solution: Solution) => void} returns what shows the cures of a solution */
export function makeCures(page) {
  const told = byId("cures-said");
  const back = byId("cures-back");
  const rows = [...document.querySelectorAll("[data-cure]")].map((/** @type {any} */ row) => {
    const { cure, parameter } = row.dataset;
    const cells = Array.from(row.querySelectorAll("td"), (cell) => makeCell(cell, parameter));
    return { ways: WAYS[cure] ?? [cure, cure], parameter, now: row.querySelector(".now"), cells };
  });
  // While a cure is shown, what it was taken from, so that cures are compared and do not add up.
  /** @type {{from: Solution, cured: Setting, button: Element} | null} */
  let tried = null;
  const stillTried = () => tried !== null && tried.cured === page.setting();

  function set(values, what, button) {
    const from = stillTried() ? tried.from : page.solution();
    try {
      page.set(values, { over: stillTried() ? from.motion.p : {} });
    } catch (error) {
      return setText(told, error.message);
    }
    tried = { from, cured: page.setting(), button };
    const { exists, delta_x } = page.solution().motion.cycle;
    const now = exists ? `The jump is ${quantity(delta_x, "length")}.` : "It no longer sticks.";
    setText(told, `${what} ${now}`);
  }
  on(back, "click", () => {
    page.set(tried.from.motion.p);
    setText(told, "Set back.");
  });

  /** Returns what shows an offer in a cell: its value as a text, and what it is for. */
  function makeCell(cell, parameter) {
    const name = controlOf(parameter).label.toLowerCase();
    const [button, note] = cell.children;
    let value = NaN;
    on(button, "click", () => {
      set({ [parameter]: value }, `The ${name} is ${button.textContent}.`, button);
    });
    return (/** @type {Offer} */ offer, text, aim) => {
      value = offer.value;
      button.hidden = !text || offer.far;
      setText(button, text);
      setText(note, offer.far ? `${text}, ${offer.words}` : offer.words);
      const label = `${name} ${text}, ${offer.words}: ${aim}`;
      const pressed = stillTried() && tried.button === button;
      put(button, { "aria-label": label, "aria-pressed": pressed });
    };
  }

  return whenSeen("cures", page, [], (solution) => {
    if (!stillTried()) tried = null;
    back.hidden = !tried;
    const { p } = (tried?.from ?? solution).motion;
    const found = curesOf(p);
    setText(byId("cures-lead"), curesInWords(p, found));
    for (const { ways, parameter, now, cells } of rows) {
      setText(now, leverInWords(p, parameter, p[parameter]));
      ["halves the jump", "ends the cycle"].forEach((aim, n) => {
        const cure = found.cures.find(({ name }) => name === ways[n]);
        const offer = cure ? [halving, ending][n](p, cure) : { words: "–" };
        const isValue = offer.value !== undefined;
        cells[n](offer, isValue ? leverInWords(p, parameter, offer.value) : "", aim);
      });
    }
  });
}

/** @type {(p: Setting, cure: Cure) => Offer} what halves the jump */
function halving(p, cure) {
  if (cure.halve !== null) return { value: cure.halve, ...changeOf(p, cure, cure.halve) };
  if (cure.name === "softer") return { words: "none: it grows" };
  if (cure.end !== null) return { words: "ends the cycle first" };
  return { words: cure.least < 1 ? `none: ${Math.round(100 * cure.least)} % at best` : "none" };
}

/** @type {(p: Setting, cure: Cure) => Offer} what ends the cycle */
function ending(p, cure) {
  if (cure.end !== null) {
    const value = valueBeyond(p, cure, cure.end);
    return { value, ...changeOf(p, cure, value) };
  }
  // At c = 0 no even sliding is left without gap or normal force.
  if (["mu_k", "load"].includes(cure.parameter)) return { words: "none: it swings and touches rest" };
  return { words: `none: without damping no ${controlOf(cure.parameter).kind} ends it` };
}

/** A change of a parameter in words, and whether it is out of reach. */
function changeOf(p, { name, parameter, now }, value) {
  const { N } = numbersOf(p);
  const [from, to] = {
    gap: [p.mu_s - now, p.mu_s - value],
    "normal force": [N, N - now + value],
  }[name] ?? [now, value];
  const factor = to / from;
  const { zeta } = numbersOf({ ...p, [parameter]: value });
  const isFar = name === "damping" ? zeta > MOST_ZETA : factor > REACH || factor < 1 / REACH;
  const times = factor >= 1 ? `× ${digits(factor, 3)}` : to > 0 ? `÷ ${digits(1 / factor, 3)}` : "0";
  const words = name === "damping" ? `ζ = ${digits(zeta, 2)}` : (name === "gap" ? "gap " : "") + times;
  return { words: isFar ? `${words}, out of reach` : words, far: isFar };
}

/** The value of a parameter with its unit, without needless zeros; of the load, the normal force. */
function leverInWords(p, parameter, value) {
  const shown = parameter === "load" ? p.m * p.g + value : value;
  return brief(shown, controlOf(parameter).kind);
}

/** @type {(p: Setting, found: Cures) => string} */
function curesInWords(p, { jump, v_c, cures }) {
  if (!cures.length) return `Nothing to suppress: ${whyNone(p, v_c)}`;
  const now = `Each change alone, the rest held. The jump is ${quantity(jump, "length")} now.`;
  if (p.c > 0) return now;
  const usual = quantity(2 * USUAL_ZETA * Math.sqrt(p.k * p.m), "damping");
  const hint = `A slide often has ζ = ${USUAL_ZETA}: here c = ${usual}.`;
  return `${now} Without damping (c = 0) no stiffness and no speed ends it. ${hint}`;
}
