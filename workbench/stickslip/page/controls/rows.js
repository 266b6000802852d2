/** Rows of parameters: a slider and a typed value each, and what is refused. */

import { byId, on, setText } from "../view/dom.js";
import { scaleFor, shortest } from "../view/units.js";
import { numberAt, placeSlider, readTyped, sliderEnds, typedText } from "./values.js";

/** A unit may be half typed: what is wrong with it is told when nothing more comes [ms]. */
const HALF_TYPED = 900;

/** A number beyond these is too long for its field, in the unit that is shown. */
const WIELDY = { least: 1e-3, most: 1e6 };

/**
 * Bring rows of the markup to life. valueOf(name): the value in use [SI]; take(name, value, row, slid):
 * use another one, which a slider or a text in this row asks for, and show it, or return why not;
 * stop(name): a slider that ends before its scale does has the value of the end of its scale, and its
 * own; note(name): what is said below a value.
 *
 * @param {Control[]} table the rows
 * @param {Reader} reader of the typed quantities
 * @returns show(from): show the values in use; in the row that they come from what the person holds stays
 */
export function makeRows(table, reader, { valueOf, take, stop = (_) => null, note = (_) => "" }) {
  const rows = table.map(makeRow);

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
    const value = reader.valueOf(numberAt(row.slider, row.control, row.shown), row.scale.unit);
    take(row.control.name, value, row, true);
  }

  function type(row, isAll = false) {
    clearTimeout(row.waiting);
    row.waiting = 0;
    const read = readTyped(row.text.value, row.control, reader, row.scale.unit);
    // The unit beside the field is not that of a text which names its own.
    row.unit.style.visibility = read.inUnit ? "hidden" : "";
    row.named = read.inUnit;
    const objection = read.objection ?? take(row.control.name, read.value, row, false);
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

  function refuse(row, objection) {
    row.text.setAttribute("aria-invalid", "true");
    say(row, `${objection} The picture still shows ${inWords(row)}.`, true);
  }

  /**
   * Show the value in use; in the row that it comes from, what the person holds stays. A fresh
   * value has its unit chosen by its size.
   */
  function show(row, from = null, fresh = from === null) {
    const { control, slider, text, said } = row;
    clearTimeout(row.waiting);
    row.waiting = 0;
    const value = valueOf(control.name);
    const end = stop(control.name);
    // The unit of a plain number must not change under the hands of who types it.
    const shown = !fresh && Math.abs(value / row.scale.size);
    const isUnwieldy = shown >= WIELDY.most || (shown > 0 && shown < WIELDY.least);
    if (fresh || (row !== from && isUnwieldy)) row.scale = scaleFor(value, control.kind);
    const words = note(control.name);
    const state = `${value} ${row.scale.unit} ${end} ${words}`;
    // To set a slider where it stands already would still cost a layout.
    if (state === row.state && text.value === row.written && !said.hasAttribute("data-bad")) return;
    row.state = state;
    const held = row === from ? document.activeElement : null;
    if (slider !== held || end) place(row, value, end);
    slider.setAttribute("aria-valuetext", inWords(row));
    if (text !== held) {
      text.value = typedText(value, row.scale);
      setText(row.unit, row.scale.unit);
      row.unit.style.visibility = "";
    }
    row.written = text.value;
    text.removeAttribute("aria-invalid");
    say(row, words, false);
  }

  function place(row, value, end) {
    const { control, scale } = row;
    const ends = sliderEnds(control, end ? end[0] : value, scale);
    setText(row.ends[0], shortest(ends.low));
    setText(row.ends[1], shortest(ends.high));
    row.shown = ends;
    if (end) {
      // The slider is as long as the value may be, so that both stand on one scale.
      row.track.style.setProperty("--share", end[1] / ends.high);
      row.shown = { low: 0, high: end[1] };
    }
    placeSlider(row.slider, control, value / scale.size, row.shown);
  }

  function inWords(row) {
    return `${typedText(valueOf(row.control.name), row.scale)} ${row.scale.unit}`.trim();
  }

  function say(row, text, bad) {
    setText(row.said, text);
    row.said.toggleAttribute("data-bad", bad);
  }

  return (from = null) => {
    for (const row of rows) show(row, from);
  };
}
