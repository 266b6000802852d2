/** The numbers of the cycle: exact and simplified side by side, and how far they are apart. */

import { numbersOf } from "../model/friction.js";
import { byId, put, setText } from "../view/dom.js";
import { digits, quantity, scaleFor } from "../view/units.js";

/** From this deviation on the simplified value is marked. */
const FAR_OFF = 0.05;

/** A reader of the screen is told of a new cycle once the slider has been still this long [ms]. */
const PAUSE = 700;

/** @type {() => (solution: Solution) => void} returns what shows a solution */
export function makeResults() {
  const rows = document.querySelectorAll("[id^='readout-']");
  let waiting = 0;

  return function show({ motion, simple, v_c, v_c_simple }) {
    const exact = { ...motion.cycle, v_c };
    // Under a friction curve the bar over v takes its place.
    const designers = { ...simple, v_c: motion.curve ? NaN : v_c_simple };
    for (const row of rows) {
      const name = row.id.slice("readout-".length);
      showRow(row, name, exact[name], designers[name]);
    }
    const sentence = inWords(motion, v_c);
    setText(byId("lead"), sentence);
    const { zeta, lambda_ } = motion.numbers;
    const lambda = motion.curve ? "" : `, λ = ${digits(lambda_, 3)}`;
    setText(byId("zeta-said"), `Damping ratio ζ = ${digits(zeta, 3)}${lambda}.`);
    clearTimeout(waiting);
    waiting = setTimeout(() => setText(byId("told"), sentence), PAUSE);
  };
}

function showRow(row, name, exact, simple) {
  const { kind } = row.dataset;
  const scale = scaleFor(Number.isFinite(exact) ? exact : simple, kind);
  [exact, simple].forEach((value, n) => {
    const isNone = name === "v_c" && !n && value === Infinity;
    const cell = row.querySelectorAll("data")[n];
    put(cell, { value });
    setText(cell, isNone ? "none" : quantity(value, kind, scale));
  });
  const off = row.cells[3];
  const { words, far } = deviation(exact, simple);
  off.classList.toggle("mark", far);
  setText(off.firstElementChild, words);
  setText(off.lastElementChild, far ? ", more than 5 % off" : "");
}

/** The deviation of the simplified value in words, and whether it deserves a mark. */
function deviation(exact, simple) {
  const off = simple / exact - 1;
  if (exact === simple || Math.abs(off) < 1e-12) return { words: "0 %", far: false };
  if (!Number.isFinite(simple)) return { words: "–", far: false };
  // The designers' formulas know of no end of the cycle.
  if (!(exact > 0)) return { words: "✕ no cycle", far: true };
  const far = Math.abs(off) > FAR_OFF;
  const mark = far ? (off > 0 ? "▲ " : "▼ ") : "";
  if (Math.abs(off) < 1e-4) return { words: "< 0.01 %", far };
  if (off > 9.995) return { words: `${mark}× ${digits(simple / exact, 3)}`, far };
  const percent = digits(Math.abs(100 * off), Math.abs(off) < 0.01 ? 2 : 3);
  return { words: `${mark}${off > 0 ? "+" : "−"}${percent} %`, far };
}

/** @type {(motion: Motion, v_c: number) => string} one sentence on what this setting does */
function inWords({ cycle, numbers, p, slip }, v_c) {
  if (!cycle.exists && Number.isNaN(v_c)) {
    return slip.settles()
      ? "It moves evenly: on this friction curve the slip from break-away calms down."
      : "It swings, without a stop: on this friction curve no slip comes to rest.";
  }
  if (!cycle.exists) return `It moves evenly: ${whyNone(p, v_c)}`;
  const { delta_x, T, t_stick, t_slip } = cycle;
  const jump = `It jumps ${quantity(delta_x, "length")} every ${quantity(T, "time")}`;
  if (numbers.F_s === 0) return `${jump} and never sticks: there is no friction.`;
  if (t_stick === 0) return `${jump} and never sticks: there is no gap between μs and μk.`;
  return `${jump}: sticks ${quantity(t_stick, "time")}, slips ${quantity(t_slip, "time")}.`;
}

/** @type {(p: Setting, v_c: number) => string} why constant friction leaves no cycle */
export function whyNone(p, v_c) {
  const { zeta, Delta } = numbersOf(p);
  if (zeta >= 1) return `the slip does not swing (ζ = ${digits(zeta, 3)}).`;
  if (Delta === 0) return "there is damping and no gap between μs and μk.";
  const [pull, critical] = [p.v, v_c].map((each) => quantity(each, "velocity"));
  return `${pull} is above the critical velocity, ${critical}.`;
}
