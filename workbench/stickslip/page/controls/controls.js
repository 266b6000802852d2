/** The parameters: a slider and a typed value each, the clamp of mu_k, and what is refused. */

import { kineticInUse, kineticStop } from "../model/friction.js";
import { byId, on, setText } from "../view/dom.js";
import { placeSlider, sliderEnds, valueAt } from "./slider.js";
import { readTyped, shortest, typedText } from "./typed.js";
import { shifted } from "../view/units.js";

/**
 * @import { Setting } from "../model/friction.js"
 * @import { Control } from "./typed.js"
 */

/**
 * Bring the controls to life.
 *
 * @param {Control[]} table the page's controls
 * @param {(p: Setting) => string | null} accept called with each new setting; a text refuses it
 * @returns setting: the values in use; wanted; set(values): take these [SI] as if typed, throws a
 *   RangeError with the reason if they are refused; objectionTo(name, value): that reason for one
 *   of them; starts: the values of the FMU
 */
export function makeControls(table, accept) {
  /** @type {any} a Setting, by the names of the table */
  const starts = Object.fromEntries(table.map(({ name, start }) => [name, start]));
  const rows = Object.fromEntries(table.map((control) => [control.name, makeRow(control)]));
  const folded = byId("folded-values");
  /** @type {Setting} */
  let setting = { ...starts };
  // What the person asked of mu_k; what is in use may be less.
  let asked = setting.mu_k;

  function makeRow(control) {
    const box = byId(`${control.name}-control`);
    const row = {
      control,
      text: byId(control.name),
      slider: byId(`${control.name}-slider`),
      track: box.querySelector(".track"),
      ends: box.querySelectorAll(".ends span"),
      said: box.querySelector(".said"),
      shown: null,
      state: null,
      written: null,
    };
    on(row.slider, "input", () => slide(row));
    on(row.text, "input", () => type(row));
    on(row.text, "blur", () => row.said.dataset.bad || write(row));
    on(row.text, "keydown", (event) => {
      if (event.key === "Escape") show(row, true);
    });
    return row;
  }

  function slide(row) {
    const { name } = row.control;
    const value = valueAt(row.slider, row.control, row.shown);
    if (name === "mu_k") return take({ mu_k: value }, value, row);
    // A slider keeps the gap; what is typed needs only to be no more than mu_s.
    const mu_k = name === "mu_s" ? Math.min(asked, kineticStop(value)) : setting.mu_k;
    return take({ [name]: value, mu_k }, asked, row);
  }

  function type(row) {
    const { name } = row.control;
    const read = readTyped(row.text.value, row.control);
    const objection = read.objection ?? tryTyped(name, read.value, row);
    if (objection) refuse(row, objection);
  }

  function tryTyped(name, value, row) {
    const wanted = name === "mu_k" ? value : asked;
    const mu_s = name === "mu_s" ? value : setting.mu_s;
    return take({ [name]: value, mu_k: kineticInUse(mu_s, wanted) }, wanted, row);
  }

  /** Take new values if they are accepted, and show them; `from` is the row they come from. */
  function take(values, wanted, from) {
    const next = { ...setting, ...values };
    const objection = accept(next);
    if (objection) return objection;
    setting = next;
    asked = wanted;
    for (const row of Object.values(rows)) show(row, row !== from);
    showFolded();
    return null;
  }

  /** What is folded away is still said. */
  function showFolded() {
    const texts = ["m", "g", "c"].map((name) => {
      const { control } = rows[name];
      return `${name} ${typedText(setting[name], control)} ${control.unit}`;
    });
    setText(folded, texts.join(", "));
  }

  function refuse(row, objection) {
    row.text.setAttribute("aria-invalid", "true");
    const { name, unit } = row.control;
    const last = `${typedText(setting[name], row.control)} ${unit}`.trim();
    say(row, `${objection} The picture still shows ${last}.`, true);
  }

  function show(row, rewrite) {
    const { control, slider, text, said } = row;
    const isKinetic = control.name === "mu_k";
    const value = setting[control.name];
    const note = isKinetic ? clampNote() : "";
    const state = `${value} ${isKinetic ? setting.mu_s : ""} ${note}`;
    // To set a slider where it stands already would still cost a layout.
    if (state === row.state && text.value === row.written && !said.dataset.bad) return;
    row.state = state;
    if (slider !== document.activeElement || rewrite || isKinetic) place(row, value);
    else slider.setAttribute("aria-valuetext", `${typedText(value, control)} ${control.unit}`);
    if (rewrite || text !== document.activeElement) write(row);
    row.written = text.value;
    text.removeAttribute("aria-invalid");
    say(row, note, false);
  }

  function place(row, value) {
    const { control } = row;
    const shown = shifted(String(control.name === "mu_k" ? setting.mu_s : value), control.decimals);
    const ends = sliderEnds(control, shown);
    setText(row.ends[0], shortest(ends.low));
    setText(row.ends[1], shortest(ends.high));
    row.shown = ends;
    if (control.name === "mu_k") {
      // The slider is as long as mu_k may be, so that both stand on one scale.
      const stop = kineticStop(setting.mu_s);
      row.track.style.setProperty("--share", stop / ends.high);
      row.shown = { low: 0, high: stop };
    }
    placeSlider(row.slider, control, value, row.shown);
  }

  function write(row) {
    const text = typedText(setting[row.control.name], row.control);
    // What rounding left of a difference is not for reading.
    row.text.value = text.length > 14 ? String(Number(Number(text).toPrecision(12))) : text;
  }

  function clampNote() {
    if (asked === setting.mu_k) return "";
    const held = Number(setting.mu_k.toPrecision(6));
    return `Held at ${held}: ${asked} is too near to μs = ${setting.mu_s}, or above.`;
  }

  function say(row, text, bad) {
    setText(row.said, text);
    if (bad) row.said.dataset.bad = "yes";
    else delete row.said.dataset.bad;
  }

  /** What is wrong with a value of a parameter, SI, or null. */
  function objectionTo(name, value) {
    const row = rows[name];
    if (!row) return `There is no parameter ${name}.`;
    const { objection } = readTyped(typedText(Number(value), row.control), row.control);
    return objection ? `${name}: ${objection}` : null;
  }

  function set(values) {
    const next = { ...setting, mu_k: asked };
    for (const [name, value] of Object.entries(values)) {
      const objection = objectionTo(name, value);
      if (objection) throw new RangeError(objection);
      next[name] = Number(value);
    }
    const objection = take({ ...next, mu_k: kineticInUse(next.mu_s, next.mu_k) }, next.mu_k, null);
    if (objection) throw new RangeError(objection);
  }

  return {
    get setting() {
      return setting;
    },
    /** The same with mu_k as the person asked for it. */
    get wanted() {
      return { ...setting, mu_k: asked };
    },
    objectionTo,
    set,
    starts,
  };
}
