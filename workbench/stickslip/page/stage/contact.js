/** Block and ground with the teeth between them, and the places where the block stood. */

import { draw, paths, put, setText } from "../view/dom.js";
import { px, write } from "../view/frame.js";
import { quantity } from "../view/units.js";

/** Width and depth of a tooth, and how far the block is lifted while it slips [px]. */
const TOOTH = { wide: 8, deep: 5, lift: 3 };
/** The places where the block stood are outlined where they are this far apart, in its widths. */
const OUTLINES_APART = 1.05;
/** What a jump measures is shown from this length on, and written where a whole jump has room [px]. */
const MEASURED = 14;
const ROOM_FOR_LENGTH = 64;
/** The streak behind a block at its largest speed [px]. */
const STREAK = 34;

/** Teeth from left to right [px] as a path, down from a height. */
function teeth(left, right, height) {
  const { wide, deep } = TOOTH;
  const count = Math.max(Math.floor((right - left) / wide), 1);
  const tooth = `l${0.5 * wide} ${deep}l${0.5 * wide} ${-deep}`;
  return `M${px(left)} ${px(height)}${tooth.repeat(count)}`;
}

/** @type {(svg: SVGSVGElement) => (layout: Layout) => void} returns what lays the ground */
export function makeGround(svg) {
  const ground = draw(svg, "path", { class: "ground" });
  return ({ width, ground: height }) => {
    put(ground, { d: `${teeth(0, width + TOOTH.wide, height)}V${height + 10}H0Z` });
  };
}

/**
 * Returns what draws the block in a layout; that returns what puts it where a state has it, its
 * left edge at a place [px].
 * @type {(svg: SVGSVGElement) => (layout: Layout, motion: Motion) => (state: State, left: number) => void}
 */
export function makeBlock(svg) {
  const group = draw(svg, "g", { class: "mass" });
  const streaks = draw(group, "path", { class: "streaks" });
  const lifted = draw(group, "g");
  const teethBelow = draw(lifted, "path", { class: "body" });
  const rect = draw(lifted, "rect", { class: "body" });
  draw(lifted, "use", { "data-part": "mass" });
  const word = draw(lifted, "text");
  const pointer = draw(group, "path", { class: "pointer" });
  return ({ ground, block, body, round }, { cycle, p }) => {
    const size = { width: px(block), height: px(body), rx: px(round * body) };
    put(rect, { x: 0, y: px(-body), ...size });
    put(word, { x: px(0.5 * block), y: px(5 - 0.5 * body) });
    // A round body has teeth in its middle alone.
    const inset = TOOTH.wide * Math.floor((0.6 * round * block) / TOOTH.wide);
    put(pointer, { d: `M${px(0.5 * block - 4)} 9h8l-4 6z` });
    const fastest = cycle.exists ? cycle.x_dot_peak : 2 * p.v;
    return ({ mode, x_dot }, left) => {
      put(group, { transform: `translate(${px(left)} ${px(ground)})` });
      // In stick the teeth stand in those of the ground, wherever the block stopped.
      const phase = mode === 0 ? (Math.ceil(left / TOOTH.wide) * TOOTH.wide - left) : 0;
      const from = phase + inset;
      put(teethBelow, { d: `${teeth(from, block - inset, 0)}v${px(-0.1 * body)}H${px(from)}Z` });
      const long = STREAK * Math.min(Math.max(x_dot, 0) / fastest, 1);
      const lines = [0.25, 0.5, 0.75].map((h) => `M-5 ${px(-h * body)}h${px(-long)}`);
      put(streaks, { d: mode === 0 ? "" : lines.join("") });
      put(group, { class: mode === 0 ? "mass stick" : "mass slip" });
      put(lifted, { transform: `translate(0 ${mode === 0 ? 0 : -TOOTH.deep - TOOTH.lift})` });
      setText(word, mode === 0 ? "STICK" : "SLIP");
    };
  };
}

/**
 * Returns what draws in a layout where the block stuck before; that returns what shows it for a
 * state in the window that starts at a position [m].
 * @type {(svg: SVGSVGElement) => (layout: Layout, motion: Motion) => (state: State, start: number) => void}
 */
export function makePlaces(svg) {
  const [outlines, length] = paths(svg, "places", "length");
  const words = draw(svg, "text");
  return ({ left, block, body, tall, ground, scale }, { cycle }) => {
    const jump = cycle.exists ? cycle.delta_x : Infinity;
    const apart = jump * scale;
    const text = quantity(jump, "length");
    const top = ground - tall - 17;
    const middle = left + 0.5 * block;
    return ({ x, mode }, start) => {
      let d = "";
      // Places of stick are whole jumps from the start; those before the mass are marked.
      const last = Math.ceil(x / jump - 1e-6) - 1;
      const first = Math.max(Math.ceil(start / jump - 1e-6), 0);
      const at = (/** @type {number} */ n) => (n * jump - start) * scale;
      if (apart >= OUTLINES_APART * block && apart < Infinity) {
        for (let n = first; n <= last; n++) {
          d += `M${px(left + at(n))} ${ground}v${px(-body)}h${px(block)}v${px(body)}`;
        }
      }
      put(outlines, { d });
      const measured = last >= first && apart >= ROOM_FOR_LENGTH && apart < Infinity;
      // A place before any is out of sight.
      const [a, b] = measured ? [middle + at(last), middle + (x - start) * scale] : [0, 0];
      put(length, { d: b - a > MEASURED ? `M${px(a)} ${px(top)}v6m0 -3H${px(b)}m0 -3v6` : "" });
      write(words, measured && mode === 0 ? text : "", 0.5 * (a + b), top - 3);
    };
  };
}
