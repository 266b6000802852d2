/** The numbers of the cycle: exact and simplified side by side, and how far they are apart. */

import { contactOf } from "../model/chain.js";
import { regimeAt } from "../model/regimes.js";
import { byId, put, setText } from "../view/dom.js";
import { digits, quantity, scaleFor } from "../view/units.js";

/**
 * @import { Setting, Numbers } from "../model/friction.js"
 * @import { Motion } from "../model/motion.js"
 * @import { Solution } from "../view/solution.js"
 */

/** From this deviation on the simplified value is marked. */
const FAR_OFF = 0.05;

/** A reader of the screen is told of a new cycle once the slider has been still this long [ms]. */
const PAUSE = 700;

/**
 * Bring the table of results to life.
 *
 * @returns {(solution: Solution) => void} shows a solution
 */
export function makeResults() {
  const rows = [...document.querySelectorAll("[id^='readout-']")].map((/** @type {HTMLTableRowElement} */ row) => ({
    name: row.id.slice("readout-".length),
    kind: row.dataset.kind,
    exact: row.querySelectorAll("data")[0],
    simple: row.querySelectorAll("data")[1],
    off: row.cells[3],
    shown: "",
  }));
  const lead = byId("lead");
  const told = byId("told");
  const ratios = byId("zeta-said");
  let waiting = 0;

  return function show({ motion, simple, v_c, v_c_simple }) {
    const exact = { ...motion.cycle, v_c };
    // Under a friction curve the bar over v takes its place.
    const designers = { ...simple, v_c: motion.curve ? NaN : v_c_simple };
    for (const row of rows) showRow(row, exact[row.name], designers[row.name]);
    const sentence = inWords(motion, v_c);
    setText(lead, sentence);
    const { zeta, lambda_ } = motion.numbers;
    const lambda = motion.curve ? "" : `, λ = ${digits(lambda_, 3)}`;
    setText(ratios, `Damping ratio ζ = ${digits(zeta, 3)}${lambda}.`);
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      setText(told, sentence);
    }, PAUSE);
  };
}

function showRow(row, exact, simple) {
  const known = Number.isFinite(exact) ? exact : simple;
  const scale = scaleFor(known, row.kind);
  const [ofExact, ofSimple] = [exact, simple].map((value) => quantity(value, row.kind, scale));
  fill(row.exact, exact, row.name === "v_c" && exact === Infinity ? "none" : ofExact);
  fill(row.simple, simple, ofSimple);
  const { words, far } = deviation(exact, simple);
  if (row.shown === words) return;
  row.shown = words;
  setText(row.off, words);
  row.off.classList.toggle("mark", far);
  if (far) row.off.append(hidden(", more than 5 % off"));
}

function fill(cell, value, words) {
  put(cell, { value });
  setText(cell, words);
}

/** The deviation of the simplified value in words, and whether it deserves a mark. */
function deviation(exact, simple) {
  if (!Number.isFinite(simple) || exact === simple) {
    return { words: exact === simple ? "0 %" : "–", far: false };
  }
  // The designers' formulas know of no end of the cycle.
  if (!(exact > 0)) return { words: "✕ no cycle", far: true };
  const off = simple / exact - 1;
  const far = Math.abs(off) > FAR_OFF;
  const mark = far ? (off > 0 ? "▲ " : "▼ ") : "";
  if (Math.abs(off) < 1e-12) return { words: "0 %", far };
  if (Math.abs(off) < 1e-4) return { words: "< 0.01 %", far };
  if (off > 9.995) return { words: `${mark}× ${digits(simple / exact, 3)}`, far };
  const percent = digits(Math.abs(100 * off), Math.abs(off) < 0.01 ? 2 : 3);
  return { words: `${mark}${off > 0 ? "+" : "−"}${percent} %`, far };
}

function hidden(words) {
  const span = document.createElement("span");
  span.className = "hidden";
  setText(span, words);
  return span;
}

/**
 * One sentence on what this setting does.
 *
 * @param {Motion} motion
 * @param {number} v_c critical velocity [m/s]
 */
function inWords({ cycle, numbers, p, curve, slip }, v_c) {
  if (!cycle.exists && slip.settles) {
    const { even } = regimeAt(contactOf(p, curve), p.v);
    const settles = even && slip.settles();
    return settles
      ? "It moves evenly: on this friction curve the slip from break-away calms down."
      : "It swings, without a stop: on this friction curve no slip comes to rest.";
  }
  if (!cycle.exists) {
    return `It moves evenly: ${whyNone(numbers, p, v_c)}`;
  }
  const { delta_x, T, t_stick, t_slip } = cycle;
  const jump = `It jumps ${quantity(delta_x, "length")} every ${quantity(T, "time")}`;
  if (numbers.F_s === 0) return `${jump} and never sticks: there is no friction.`;
  if (t_stick === 0) return `${jump} and never sticks: there is no gap between μs and μk.`;
  return `${jump}: sticks ${quantity(t_stick, "time")}, slips ${quantity(t_slip, "time")}.`;
}

/**
 * @param {Numbers} numbers
 * @param {Setting} p
 * @param {number} v_c critical velocity [m/s]
 */
function whyNone({ zeta, Delta }, p, v_c) {
  if (zeta >= 1) return `the slip does not swing (ζ = ${digits(zeta, 3)}).`;
  if (Delta === 0) return "there is damping and no gap between μs and μk.";
  const [pull, critical] = [p.v, v_c].map((each) => quantity(each, "velocity"));
  return `${pull} is above the critical velocity, ${critical}.`;
}
