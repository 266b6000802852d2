/** LuGre's friction in the cycle of the setting, beside the exact block: computed once unfolded. */

import { makeRows } from "../controls/rows.js";
import { objectionIn } from "../controls/values.js";
import { givesEnergy, lugreCycle, presliding } from "../model/lugre.js";
import { zeroBetween } from "../model/root.js";
import { axisOf } from "../view/axis.js";
import { byId, paths, put, setText } from "../view/dom.js";
import { makeFrame, polyline } from "../view/frame.js";
import { whenSeen } from "../view/seen.js";
import { brief, quantity, scaleFor } from "../view/units.js";

/** A cycle is computed once its setting has been still this long [ms]. */
const DRAG_STILL = 120;
/** The loop is shown from the first to the second, in v_s. */
const LOOP_SPEEDS = [-2, 10];
/** Ways of the loops from a reversal, in F_s/sigma_0. */
const REVERSALS = [6, 1.5];
/** Points of a slip of the exact block. */
const EXACT_POINTS = 400;

/**
 * Bring the section to life. show(solution); starts: the values of the FMU; wanted(): those in use that
 * differ; set(values): take these [SI], the others as they start; objectionTo(name, value): why not.
 * @type {(page: Page, table: Control[], reader: Reader, changed: () => void) => any}
 */
export function makeBristles(page, table, reader, changed) {
  const starts = Object.fromEntries(table.map(({ name, start }) => [name, start]));
  /** @type {any} Bristles, by the names of the table */
  let own = starts;
  const showRows = makeRows(table, reader, {
    valueOf: (name) => own[name],
    take(name, value, row) {
      own = { ...own, [name]: value };
      showRows(row);
      changed();
      show(page.solution());
      return null;
    },
  });
  const frames = ["loop", "force", "reversal"].map((id) => makeFrame(byId(`bristles-${id}`)));
  const looks = ["threshold", "curve mass", "curve mass faint"];
  const lines = frames.map((frame) => paths(frame.curves, ...looks));
  /** @type {any[]} */
  const rows = [...document.querySelectorAll("#bristles [data-name]")];
  let key = "";
  let waiting = 0;
  /** @type {LugreCycle} */
  let cycle = null;

  function show({ motion }) {
    clearTimeout(waiting);
    if (!byId("bristles-more").open) return;
    if (JSON.stringify([motion.p, own]) === key) showMotion(motion);
    else waiting = setTimeout(() => showMotion(motion), DRAG_STILL);
  }

  function showMotion(motion) {
    const { p, numbers } = motion;
    const now = JSON.stringify([p, own]);
    if (now !== key) cycle = lugreCycle(p, own);
    key = now;
    const exact = motion.cycle.exists ? exactCycle(motion) : null;
    setText(byId("bristles-said"), bristlesInWords(p, own, cycle, exact));
    byId("bristles-cycle").hidden = cycle.outcome !== "cycle";
    if (cycle.outcome === "cycle") showCycle(p, exact);
    byId("bristles-slow").hidden = cycle.outcome === "none";
    if (cycle.outcome !== "none") showReversal(numbers.F_s);
  }

  /** @type {(at: number, x: Axis, y: Axis, ...curves: number[][][]) => void} points [SI] in a frame */
  function drawIn(at, x, y, ...curves) {
    // It may just have come into sight.
    frames[at].resize();
    frames[at].scale(x, y);
    curves.forEach((points, n) => {
      const places = points.map(([a, b]) => [frames[at].x(a), frames[at].y(b)]);
      put(lines[at][n], { d: polyline(places) });
    });
  }

  function showCycle({ k, c }, exact) {
    for (const row of rows) {
      const { name, kind } = row.dataset;
      row.querySelectorAll("data").forEach((cell, n) => {
        const value = (n ? exact?.[name] : cycle[name]) ?? NaN;
        put(cell, { value });
        setText(cell, quantity(value, kind, scaleFor(cycle[name], kind)));
      });
    }
    const { states, T, x_dot_peak } = cycle;
    const [back, most] = LOOP_SPEEDS.map((times) => times * own.v_s);
    const least = Math.max(Math.min(...states.map(({ x_dot }) => x_dot), 0), back);
    const highest = Math.min(x_dot_peak, most);
    const loop = states.map(({ x_dot, friction }) => [x_dot, friction]);
    const { low, F_s, F_k, x_dot_peak: peak } = exact ?? {};
    const steady = exact ? [[0, low], [0, F_s], [0, F_k], [peak, F_k + c * peak]] : [];
    const seen = [...loop, ...steady].filter(([u]) => u <= highest);
    const speeds = axisOf([least, highest], "velocity", "velocity", 0.04);
    drawIn(0, speeds, forceAxis(seen, "friction"), steady, loop);
    const beyond = `Up to ${brief(highest, "velocity")}; the slip goes on to`;
    const words = highest < x_dot_peak ? `${beyond} ${quantity(x_dot_peak, "velocity")}.` : "";
    setText(byId("bristles-loop-said"), words);
    const course = states.map(({ t, z }) => [t, k * z]);
    const forces = exact?.forces ?? [];
    const times = axisOf([0, Math.max(T, exact?.T ?? 0)], "time", "time", 0);
    drawIn(1, times, forceAxis([...course, ...forces], "spring force"), forces, course);
  }

  function showReversal(F_s) {
    const [long, short] = REVERSALS.map((times) => (times * F_s) / own.sigma_0);
    const box = [[0, -F_s], [0, F_s], [long, F_s], [long, -F_s], [0, -F_s]];
    const loops = [long, short].map((way) => presliding(F_s, own.sigma_0, way));
    const ways = axisOf([0, long], "length", "displacement", 0.04);
    drawIn(2, ways, forceAxis(box, "friction"), box, ...loops);
    const [one, other, bend] = [long, short, F_s / own.sigma_0].map((way) => brief(way, "length"));
    const words = `Slowly to and fro by ${one} and ${other}. Bristles bend by Fₛ/σ₀ = ${bend}.`;
    setText(byId("bristles-slow-said"), words);
  }

  const shown = whenSeen("bristles", page, frames, show);
  showRows();
  return {
    show: shown,
    starts,
    wanted: () => Object.fromEntries(Object.entries(own).filter(([name, x]) => x !== starts[name])),
    set(values) {
      own = { ...starts, ...values };
      showRows();
    },
    objectionTo: (name, value) => objectionIn(table, name, value),
  };
}

/** The axis of the forces of some points, with room for its title. */
const forceAxis = (points, name) => {
  const forces = points.map(([, force]) => force);
  return axisOf(forces, "force", name, 0.06, 0.15);
};

/** The cycle of the exact block from its spring's maximum: numbers, and force over time. */
function exactCycle({ p, slip, numbers, cycle, z_s }) {
  const { T, t_slip, x_dot_peak } = cycle;
  const top = slip.overshoot.tau;
  const end = zeroBetween((tau) => slip.at(tau).x_dot - p.v, 0.5 * (top + t_slip), t_slip);
  const delta_x = slip.at(end).displacement - slip.at(top).displacement;
  const forceAt = (tau) => p.k * (z_s + slip.at(tau).growth);
  const taus = Array.from({ length: EXACT_POINTS + 1 }, (_, n) => (n * t_slip) / EXACT_POINTS);
  const forces = taus.map((tau) => [(tau - top + T) % T, forceAt(tau)]);
  forces.push([0, forceAt(top)], [T, forceAt(top)]);
  forces.sort(([one], [other]) => one - other);
  const friction_max = Math.max(numbers.F_s, numbers.F_k + p.c * x_dot_peak);
  const [F_max, low] = [forceAt(top), forceAt(t_slip)];
  return { ...numbers, T, delta_x, x_dot_peak, friction_max, F_max, low, forces };
}

/** @type {(p: Setting, own: Bristles, cycle: LugreCycle, exact: object | null) => string} */
function bristlesInWords(p, own, { outcome, calm, falls }, exact) {
  const v = brief(p.v, "velocity");
  const several = falls > 1 ? ` The spring falls ${falls} times: the largest fall counts.` : "";
  const also = calm ? " Even sliding is stable, too: the start decides." : "";
  const but = exact ? ", though the exact block has one" : "";
  const words = {
    cycle: `From rest LuGre’s block comes to this cycle.${several}${also}`,
    even: `From rest LuGre’s block comes to slide evenly at ${v}: it has no cycle${but}.`,
    creep: `From rest LuGre’s block slides evenly at ${v}: swings grow too slowly, if at all.`,
    unsettled:
      "LuGre’s block repeats no period within the work that this page does: its swings change " +
      "too slowly or never repeat, or its bristles ring too long, which a larger σ₁ ends.",
    none: "There is no friction: no bristles bend.",
  }[outcome];
  if (outcome === "none" || !givesEnergy(p, own)) return words;
  const needed = brief((own.sigma_1 * (p.mu_s - p.mu_k)) / p.mu_k, "damping");
  const is = `${p.mu_k > 0 ? `= ${needed} ` : ""}is above c = ${brief(p.c, "damping")}`;
  return `${words} σ₁(μₛ − μₖ)/μₖ ${is}: this friction may give energy, it is not passive.`;
}
