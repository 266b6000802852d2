/** What suppresses the cycle: a table of values, each of them a button that sets it. */

import { curesOf, valueBeyond } from "../model/cures.js";
import { numbersOf } from "../model/friction.js";
import { byId, data, on, put, setText } from "../view/dom.js";
import { whenSeen } from "../view/seen.js";
import { digits, quantity, withoutNoughts } from "../view/units.js";

/** A parameter that changes by more than this factor is out of reach of a design. */
const REACH = 100;
/** So is a damping ratio above this: slides and drives have 0.01 to 0.1. */
const MOST_ZETA = 0.5;
/** A damping ratio that is often met. */
const USUAL_ZETA = 0.03;

/** @type {(parameter: string) => Control} what a parameter is set by: of the load, the normal force */
const controlOf = (parameter) =>
  data.controls.find(({ name }) => name === (parameter === "load" ? "N" : parameter));
const ENDS_FIRST = { words: "ends the cycle first" };
/** What is left at c = 0 without gap or normal force: no even sliding. */
const TOUCHES_REST = "it swings and touches rest";
const JUMP_GROWS = { words: "none: it grows" };
const NO_CURE = { words: "–" };

/** @type {(page: Page) => (solution: Solution) => void} returns what shows the cures of a solution */
export function makeCures(page) {
  const lead = byId("cures-lead");
  const told = byId("cures-said");
  const back = byId("cures-back");
  const rows = [...document.querySelectorAll("[data-cure]")].map((/** @type {HTMLElement} */ row) => {
    const { cure, parameter } = row.dataset;
    const [halve, end] = row.querySelectorAll("td");
    const cells = [halve, end].map((cell) => makeCell(cell, parameter));
    return { cure, parameter, now: row.querySelector(".now"), cells };
  });
  // While a cure is shown, what it was taken from, so that cures are compared and do not add up.
  /** @type {{from: Solution, cured: Setting, button: Element} | null} */
  let tried = null;
  const stillTried = () => tried !== null && tried.cured === page.setting();

  /** @type {(values: Partial<Setting>, what: string, button: Element) => void} */
  function set(values, what, button) {
    const from = stillTried() ? tried.from : page.solution();
    try {
      page.set(values, { over: stillTried() ? from.motion.p : {} });
    } catch (error) {
      return setText(told, error.message);
    }
    tried = { from, cured: page.setting(), button };
    const { exists, delta_x } = page.solution().motion.cycle;
    setText(told, `${what} ${exists ? `The jump is ${quantity(delta_x, "length")}.` : "It no longer sticks."}`);
  }
  on(back, "click", () => {
    page.set(tried.from.motion.p);
    setText(told, "Set back.");
  });

  /** @type {(cell: HTMLTableCellElement, parameter: string) => (offer: Offer, text: string, aim: string) => void} */
  function makeCell(cell, parameter) {
    const name = controlOf(parameter).label.toLowerCase();
    const button = document.createElement("button");
    const note = document.createElement("span");
    note.className = "small";
    button.hidden = true;
    let value = NaN;
    on(button, "click", () => {
      set({ [parameter]: value }, `The ${name} is ${button.textContent}.`, button);
    });
    cell.append(button, note);
    return (offer, text, aim) => {
      value = offer.value;
      button.hidden = !text || offer.far;
      setText(button, text);
      setText(note, offer.far ? `${text}, ${offer.words}` : offer.words);
      const pressed = stillTried() && tried.button === button;
      put(button, {
        "aria-label": `${name} ${text}, ${offer.words}: ${aim}`,
        "aria-pressed": pressed,
      });
    };
  }

  return whenSeen("cures", page, [], (solution) => {
    if (!stillTried()) tried = null;
    back.hidden = !tried;
    const { p } = (tried?.from ?? solution).motion;
    const found = curesOf(p);
    setText(lead, curesInWords(p, found));
    const offers = found.cures.length ? offersOf(p, found.cures) : null;
    for (const { cure, parameter, now, cells } of rows) {
      /** @type {(value: number | undefined) => string} */
      const text = (value) => (value === undefined ? "" : leverInWords(p, parameter, value));
      const [halve, end] = offers ? offers[cure] : [NO_CURE, NO_CURE];
      setText(now, text(p[parameter]));
      cells[0](halve, text(halve.value), "halves the jump");
      cells[1](end, text(end.value), "ends the cycle");
    }
  });
}

/**
 * What the cells of each row offer.
 * @type {(p: Setting, cures: Cure[]) => Record<string, [halve: Offer, end: Offer]>}
 */
function offersOf(p, cures) {
  const { stiffer, softer, damping, slower, faster, gap, lighter, "normal force": force } =
    /** @type {Record<string, Cure>} */ (Object.fromEntries(cures.map((cure) => [cure.name, cure])));
  /** @type {(cure: Cure) => Offer} */
  const halve = (cure) => {
    if (cure.halve !== null) return { value: cure.halve, ...changeOf(p, cure, cure.halve) };
    if (cure.end !== null) return ENDS_FIRST;
    return { words: cure.least < 1 ? `none: ${Math.round(100 * cure.least)} % at best` : "none" };
  };
  /** @type {(cure: Cure, without: string) => Offer} */
  const end = (cure, without) => {
    if (cure.end === null) return { words: `none: ${without}` };
    const value = valueBeyond(p, cure, cure.end);
    return { value, ...changeOf(p, cure, value) };
  };
  const never = (what) => `without damping no ${what} ends it`;
  return {
    stiffer: [halve(stiffer), end(stiffer, never("stiffness"))],
    softer: [JUMP_GROWS, end(softer, never("stiffness"))],
    damping: [halve(damping), end(damping, "")],
    speed: [halve(slower), end(faster, never("speed"))],
    gap: [halve(gap), end(gap, TOUCHES_REST)],
    force: [halve(force), end(force, TOUCHES_REST)],
    lighter: [halve(lighter), end(lighter, never("mass"))],
  };
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
  return withoutNoughts(quantity(shown, controlOf(parameter).kind));
}

/** @type {(p: Setting, found: Cures) => string} */
function curesInWords(p, { jump, v_c, cures }) {
  const { zeta, Delta } = numbersOf(p);
  if (cures.length) {
    const usual = quantity(2 * USUAL_ZETA * Math.sqrt(p.k * p.m), "damping");
    const hint =
      " Without damping (c = 0) no stiffness and no speed ends it. " +
      `A slide often has ζ = ${USUAL_ZETA}: here c = ${usual}.`;
    const now = `Each change alone, the rest held. The jump is ${quantity(jump, "length")} now.`;
    return p.c > 0 ? now : now + hint;
  }
  if (zeta >= 1) return `Nothing to suppress: with ζ = ${digits(zeta, 3)} no slip comes to rest.`;
  if (!(Delta > 0)) return "Nothing to suppress: damping and no gap leave no cycle.";
  const [pull, critical] = [p.v, v_c].map((each) => quantity(each, "velocity"));
  return (
    `Nothing to suppress: the pull of ${pull} is ${digits(p.v / v_c, 3)} times the critical ` +
    `velocity ${critical}.`
  );
}
