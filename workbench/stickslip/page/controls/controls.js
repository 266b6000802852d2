/** The parameters: a slider and a typed value each, the clamp of mu_k, and what is refused. */

import { kineticInUse, kineticStop, numbersOf } from "../model/friction.js";
import { byId, on, setText } from "../view/dom.js";
import { brief, scaleFor, shortest } from "../view/units.js";
import { numberAt, outOfRange, placeSlider, readTyped, sliderEnds, typedText } from "./values.js";

/** A unit may be half typed: what is wrong with it is told when nothing more comes [ms]. */
const HALF_TYPED = 900;

/** A number beyond these is too long for its field, in the unit that is shown. */
const WIELDY = { least: 1e-3, most: 1e6 };

/**
 * Bring the controls to life.
 *
 * @param {Control[]} table the page's controls, and the parameters without one
 * @param {Reader} reader of the typed quantities
 * @param {(p: Setting) => string | null} accept called with each new setting; a text refuses it
 * @returns setting(): the values in use; wanted(): the same as the person asked for; set(values):
 *   take these [SI] as if typed, throws a RangeError with the reason if they are refused;
 *   objectionTo(name, value): that reason for one of them; starts: the values of the FMU
 */
export function makeControls(table, reader, accept) {
  const parameters = table.filter(({ start }) => start !== undefined);
  /** @type {any} a Setting, by the names of the table */
  const starts = Object.fromEntries(parameters.map(({ name, start }) => [name, start]));
  const rows = table.filter(({ label }) => label).map(makeRow);
  /** @type {Setting} */
  let setting = { ...starts };
  // What the person asked for; mu_k in use may be less, and the load more.
  let wanted = setting;

  function makeRow(control) {
    const { name } = control;
    const box = byId(`${name}-control`);
    /** @type {any} its elements; later, how its value is shown and written */
    const row = {
      control,
      text: byId(name),
      unit: byId(`${name}-unit`),
      slider: byId(`${name}-slider`),
      track: box.querySelector(".track"),
      ends: box.querySelectorAll(".ends span"),
      said: byId(`${name}-said`),
    };
    on(row.slider, "input", () => slide(row));
    on(row.slider, "blur", () => show(row, null, false));
    on(row.text, "input", () => type(row));
    on(row.text, "blur", () => leave(row));
    on(row.text, "keydown", ({ key }) => {
      if (key === "Enter") leave(row);
      if (key === "Escape") show(row, null, false);
    });
    return row;
  }

  function slide(row) {
    const { name } = row.control;
    const value = reader.valueOf(numberAt(row.slider, row.control, row.shown), row.scale.unit);
    const next = changed(name, value);
    // A slider keeps the gap; what is typed needs only to be no more than mu_s.
    const stop = name === "mu_s" ? Math.min(next.mu_k, kineticStop(value)) : setting.mu_k;
    take(next, name === "mu_k" ? value : stop, row);
  }

  function type(row, isAll = false) {
    clearTimeout(row.waiting);
    row.waiting = 0;
    const read = readTyped(row.text.value, row.control, reader, row.scale.unit);
    // The unit beside the field is not that of a text which names its own.
    row.unit.style.visibility = read.inUnit ? "hidden" : "";
    row.named = read.inUnit;
    const objection = read.objection ?? takeTyped(changed(row.control.name, read.value), row);
    if (!objection) return;
    if (!read.inUnit || isAll) refuse(row, objection);
    else row.waiting = setTimeout(() => refuse(row, objection), HALF_TYPED);
  }

  /** The field is left: what stands there is all, and is shown as the value in use. */
  function leave(row) {
    if (row.waiting) type(row, true);
    row.written = null;
    if (!row.said.hasAttribute("data-bad")) show(row, null, row.named);
  }

  /** What is wanted with another value of one of the controls. */
  function changed(name, value) {
    if (name === "N") return { ...wanted, load: value - setting.m * setting.g };
    return { ...wanted, [name]: value };
  }

  function takeTyped(next, from) {
    return take(next, kineticInUse(next.mu_s, next.mu_k), from);
  }

  /** Take what is wanted if it is accepted, and show it; `from` is the row it comes from. */
  function take(next, mu_k, from) {
    // A lighter mass keeps its load, till that would lift it.
    const used = { ...next, mu_k, load: Math.max(next.load, -(next.m * next.g)) };
    const objection = accept(used);
    if (objection) return objection;
    setting = used;
    wanted = next;
    for (const row of rows) show(row, from);
    const [weight, load] = [used.m * used.g, used.load].map((force) => brief(force, "force"));
    setText(byId("N-parts"), `weight ${weight} + load ${load}`);
    return null;
  }

  function refuse(row, objection) {
    row.text.setAttribute("aria-invalid", "true");
    say(row, `${objection} The picture still shows ${inWords(row)}.`, true);
  }

  function valueOf({ control: { name } }) {
    return name === "N" ? numbersOf(setting).N : setting[name];
  }

  /**
   * Show the value in use; in the row that it comes from, what the person holds stays. A fresh
   * value has its unit chosen by its size.
   */
  function show(row, from = null, fresh = from === null) {
    const { control, slider, text, said } = row;
    clearTimeout(row.waiting);
    row.waiting = 0;
    const isKinetic = control.name === "mu_k";
    const value = valueOf(row);
    // The unit of a plain number must not change under the hands of who types it.
    const shown = !fresh && Math.abs(value / row.scale.size);
    const isUnwieldy = shown >= WIELDY.most || (shown > 0 && shown < WIELDY.least);
    if (fresh || (row !== from && isUnwieldy)) row.scale = scaleFor(value, control.kind);
    const note = isKinetic ? clampNote() : "";
    const state = `${value} ${row.scale.unit} ${isKinetic ? setting.mu_s : ""} ${note}`;
    // To set a slider where it stands already would still cost a layout.
    if (state === row.state && text.value === row.written && !said.hasAttribute("data-bad")) return;
    row.state = state;
    const held = row === from ? document.activeElement : null;
    if (slider !== held || isKinetic) place(row, value);
    slider.setAttribute("aria-valuetext", inWords(row));
    if (text !== held) {
      text.value = typedText(value, row.scale);
      setText(row.unit, row.scale.unit);
      row.unit.style.visibility = "";
    }
    row.written = text.value;
    text.removeAttribute("aria-invalid");
    say(row, note, false);
  }

  function place(row, value) {
    const { control, scale } = row;
    const ends = sliderEnds(control, control.name === "mu_k" ? setting.mu_s : value, scale);
    setText(row.ends[0], shortest(ends.low));
    setText(row.ends[1], shortest(ends.high));
    row.shown = ends;
    if (control.name === "mu_k") {
      // The slider is as long as mu_k may be, so that both stand on one scale.
      const stop = kineticStop(setting.mu_s);
      row.track.style.setProperty("--share", stop / ends.high);
      row.shown = { low: 0, high: stop };
    }
    placeSlider(row.slider, control, value / scale.size, row.shown);
  }

  function inWords(row) {
    return `${typedText(valueOf(row), row.scale)} ${row.scale.unit}`.trim();
  }

  function clampNote() {
    if (wanted.mu_k === setting.mu_k) return "";
    const held = Number(setting.mu_k.toPrecision(6));
    return `Held at ${held}: ${wanted.mu_k} is too near to μs = ${setting.mu_s}, or above.`;
  }

  function say(row, text, bad) {
    setText(row.said, text);
    row.said.toggleAttribute("data-bad", bad);
  }

  /** What is wrong with a value of a parameter, SI, or null. */
  function objectionTo(name, value) {
    const parameter = parameters.find((each) => each.name === name);
    if (!parameter) return `There is no parameter ${name}.`;
    const objection = outOfRange(Number(value), parameter);
    return objection ? `${name}: ${value} ${objection}.` : null;
  }

  function set(values) {
    const next = { ...wanted };
    for (const [name, value] of Object.entries(values)) {
      const objection = objectionTo(name, value);
      if (objection) throw new RangeError(objection);
      next[name] = Number(value);
    }
    const lifted = "load" in values && next.m * next.g + next.load < 0;
    const objection = lifted
      ? `load: ${next.load} N would lift the mass, whose weight is ${next.m * next.g} N.`
      : takeTyped(next, null);
    if (objection) throw new RangeError(objection);
  }

  return { setting: () => setting, wanted: () => wanted, objectionTo, set, starts };
}
