/** The parameters of the block: the clamp of mu_k, and the load that a lighter mass keeps. */

import { kineticInUse, kineticStop, numbersOf } from "../model/friction.js";
import { byId, setText } from "../view/dom.js";
import { brief } from "../view/units.js";
import { makeRows } from "./rows.js";
import { objectionIn } from "./values.js";

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
  const show = makeRows(
    table.filter(({ label }) => label),
    reader,
    { valueOf, take: takeFrom, stop, note: (name) => (name === "mu_k" ? clampNote() : "") },
  );
  /** @type {Setting} */
  let setting = { ...starts };
  // What the person asked for; mu_k in use may be less, and the load more.
  let wanted = setting;

  /** Take a value of one of the controls, slid or typed in a row. */
  function takeFrom(name, value, row, slid) {
    const next = changed(name, value);
    if (!slid) return takeTyped(next, row);
    // A slider keeps the gap; what is typed needs only to be no more than mu_s.
    const stop = name === "mu_s" ? Math.min(next.mu_k, kineticStop(value)) : setting.mu_k;
    return take(next, name === "mu_k" ? value : stop, row);
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
    show(from);
    const [weight, load] = [used.m * used.g, used.load].map((force) => brief(force, "force"));
    setText(byId("N-parts"), `weight ${weight} + load ${load}`);
    return null;
  }

  function valueOf(name) {
    return name === "N" ? numbersOf(setting).N : setting[name];
  }

  /** The slider of mu_k stands on the scale of that of mu_s. */
  function stop(name) {
    return name === "mu_k" ? [setting.mu_s, kineticStop(setting.mu_s)] : null;
  }

  function clampNote() {
    if (wanted.mu_k === setting.mu_k) return "";
    const held = Number(setting.mu_k.toPrecision(6));
    return `Held at ${held}: ${wanted.mu_k} is too near to μs = ${setting.mu_s}, or above.`;
  }

  /** @type {(name: string, value: any) => string | null} */
  const objectionTo = (name, value) => objectionIn(parameters, name, value);

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
