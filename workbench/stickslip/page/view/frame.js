/** The frame of a chart: its place, axes, grid and layers. */

import { shareAlong, ticks } from "./axis.js";
import { draw, put, setText } from "./dom.js";

/** @import { Axis } from "./axis.js" */

/** @typedef {ReturnType<typeof makeFrame>} Frame */

/** Pixels beside the plot: for the texts of the axes. */
const MARGIN = { left: 54, right: 12, top: 8, bottom: 34 };
/** A letter of a mark is about this wide [px]. */
const WIDE = 7.7;
/** Pixels between two marks, about. */
const APART = { x: 90, y: 38 };
/** The same along a logarithmic axis, whose texts are short. */
const APART_IN_LOG = { x: 52, y: 38 };

/**
 * A coordinate, to a fiftieth of a pixel.
 *
 * @param {number} value [px]
 */
export function px(value) {
  return Math.round(value * 50) / 50;
}

/**
 * Straight lines through points as path data.
 *
 * @param {[x: number, y: number][]} points [px]
 */
export function polyline(points) {
  const far = (value) => px(Math.min(Math.max(value, -1e4), 1e4));
  return points.map(([x, y], n) => `${n ? "L" : "M"}${far(x)} ${far(y)}`).join("");
}

/**
 * Make a chart's frame in an empty svg element.
 *
 * @param {SVGSVGElement} svg
 * @returns svg; under, curves, over: groups to draw in; resize(width, height);
 *   scale(x, y): the axes, each of `axisOf` or `logAxis`;
 *   x(value), y(value): pixels; area: the plot's rectangle in pixels
 */
export function makeFrame(svg) {
  const clip = draw(draw(draw(svg, "defs"), "clipPath", { id: `${svg.id}-clip` }), "rect");
  const under = draw(svg, "g", { "clip-path": `url(#${svg.id}-clip)` });
  const grid = draw(svg, "path", { class: "grid" });
  const labels = draw(svg, "g", { class: "ticks" });
  const curves = draw(svg, "g", { "clip-path": `url(#${svg.id}-clip)` });
  const over = draw(svg, "g");
  const titles = [
    draw(svg, "text", { class: "axis", "text-anchor": "end" }),
    draw(svg, "text", { class: "axis", "text-anchor": "start" }),
  ];
  /** @type {Element[]} */
  const pool = [];
  const area = { left: MARGIN.left, top: MARGIN.top, right: 0, bottom: 0, width: 0, height: 0 };
  /** @type {{x: Axis, y: Axis}} */
  let axes = null;

  /**
   * @param {number} width [px]
   * @param {number} height [px]
   */
  function resize(width, height) {
    put(svg, { viewBox: `0 0 ${width} ${height}` });
    area.right = Math.max(width - MARGIN.right, area.left + 10);
    area.bottom = Math.max(height - MARGIN.bottom, area.top + 10);
    area.width = area.right - area.left;
    area.height = area.bottom - area.top;
    put(clip, { x: area.left, y: area.top, width: area.width, height: area.height });
  }

  /** @type {(value: number) => number} from SI to [px] */
  const x = (value) => area.left + shareAlong(axes.x, value) * area.width;
  /** @type {(value: number) => number} from SI to [px] */
  const y = (value) => area.bottom - shareAlong(axes.y, value) * area.height;

  /**
   * @param {Axis} horizontal
   * @param {Axis} vertical
   */
  function scale(horizontal, vertical) {
    axes = { x: horizontal, y: vertical };
    let path = "";
    let used = 0;
    const label = (text, left, top, anchor) => {
      pool[used] ??= draw(labels, "text");
      const element = pool[used++];
      setText(element, text);
      put(element, { x: px(left), y: px(top), "text-anchor": anchor });
    };
    for (const { value, text } of ticks(horizontal, markCount(horizontal, "x", area.width))) {
      path += `M${px(x(value))} ${px(area.top)}V${px(area.bottom)}`;
      const edge = area.right + MARGIN.right;
      const cut = x(value) + 0.5 * WIDE * text.length > edge;
      label(text, cut ? edge : x(value), area.bottom + 15, cut ? "end" : "middle");
    }
    for (const { value, text } of ticks(vertical, markCount(vertical, "y", area.height))) {
      path += `M${px(area.left)} ${px(y(value))}H${px(area.right)}`;
      // What the margin cannot hold stands inside, above its line.
      if (WIDE * text.length > MARGIN.left - 5) label(text, area.left + 4, y(value) - 3, "start");
      else label(text, area.left - 5, y(value) + 4, "end");
    }
    for (const element of pool.splice(used)) element.remove();
    put(grid, { d: path });
    place(titles[0], horizontal.title, area.right, area.bottom + 30);
    place(titles[1], vertical.title, area.left + 5, area.top + 11);
  }

  return { svg, under, curves, over, area, resize, scale, x, y };
}

/** @type {(axis: Axis, way: "x" | "y", length: number) => number} how many marks have room */
function markCount({ log }, way, length) {
  return Math.max(length / (log ? APART_IN_LOG : APART)[way], 2);
}

function place(element, text, left, top) {
  setText(element, text);
  put(element, { x: px(left), y: px(top) });
}
