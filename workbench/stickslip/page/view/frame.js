/** The frame of a chart: its place, axes, grid and layers. */

import { shareAlong, ticks, valueAlong } from "./axis.js";
import { draw, put, setText } from "./dom.js";

/** Pixels beside the plot: for the texts of the axes. */
const MARGIN = { left: 54, right: 12, top: 8, bottom: 34 };
/** A letter of a mark is about this wide [px]. */
const WIDE = 7.7;
/** Pixels between two marks, about; the texts along a logarithmic axis are short. */
const APART = { x: 90, y: 38, log: 52 };

/** @type {(value: number) => number} a coordinate, to a fiftieth of a pixel */
export function px(value) {
  return Math.round(value * 50) / 50;
}

/** @type {(points: number[][]) => string} straight lines through points (x, y) [px] as path data */
export function polyline(points) {
  const far = (value) => px(Math.min(Math.max(value, -1e4), 1e4));
  return points.map(([x, y], n) => `${n ? "L" : "M"}${far(x)} ${far(y)}`).join("");
}

/** The pattern of lines at 45 degrees that fills by `url(#id)`, each so many pixels from the next. */
export function hatched(svg, id, apart) {
  const look = { patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" };
  return draw(svg.querySelector("defs"), "pattern", { id, width: apart, height: apart, ...look });
}

/**
 * Make a chart's frame in an empty svg element. under, curves, over: groups to draw in; resize(): the
 * element has another size; scale(x, y): the axes, each of `axisOf` or `logAxis`; x(value), y(value):
 * pixels; valueAtX(x), valueAtY(y): back; upright(value), level(value): a line across the plot as path
 * data; area: the plot's rectangle [px].
 *
 * @param {SVGSVGElement} svg
 */
export function makeFrame(svg) {
  const clip = draw(draw(draw(svg, "defs"), "clipPath", { id: `${svg.id}-clip` }), "rect");
  const under = draw(svg, "g", { "clip-path": `url(#${svg.id}-clip)` });
  const grid = draw(svg, "path", { class: "grid" });
  const label = makeTexts(draw(svg, "g", { class: "ticks" }));
  const curves = draw(svg, "g", { "clip-path": `url(#${svg.id}-clip)` });
  const over = draw(svg, "g");
  const name = makeTexts(svg, { class: "axis" });
  const area = { left: MARGIN.left, top: MARGIN.top, right: 0, bottom: 0, width: 0, height: 0 };
  /** @type {{x: Axis, y: Axis}} */
  let axes = null;

  function resize() {
    const { clientWidth: width, clientHeight: height } = svg;
    put(svg, { viewBox: `0 0 ${width} ${height}` });
    area.right = Math.max(width - MARGIN.right, area.left + 10);
    area.bottom = Math.max(height - MARGIN.bottom, area.top + 10);
    area.width = area.right - area.left;
    area.height = area.bottom - area.top;
    put(clip, { x: area.left, y: area.top, width: area.width, height: area.height });
  }

  const x = (/** @type {number} */ value) => area.left + shareAlong(axes.x, value) * area.width;
  const y = (/** @type {number} */ value) => area.bottom - shareAlong(axes.y, value) * area.height;

  function scale(horizontal, vertical) {
    axes = { x: horizontal, y: vertical };
    let path = "";
    const labels = [];
    const apart = horizontal.log ? APART.log : APART.x;
    for (const { value, text } of ticks(horizontal, Math.max(area.width / apart, 2))) {
      path += upright(value);
      const edge = area.right + MARGIN.right;
      const cut = x(value) + 0.5 * WIDE * text.length > edge;
      labels.push([text, cut ? edge : x(value), area.bottom + 15, cut ? "end" : "middle"]);
    }
    for (const { value, text } of ticks(vertical, Math.max(area.height / APART.y, 2))) {
      path += level(value);
      // What the margin cannot hold stands inside, above its line.
      const inside = WIDE * text.length > MARGIN.left - 5;
      const [beside, below, anchor] = inside ? [4, -3, "start"] : [-5, 4, "end"];
      labels.push([text, area.left + beside, y(value) + below, anchor]);
    }
    label(labels);
    put(grid, { d: path });
    name([
      [horizontal.title, area.right, area.bottom + 30, "end"],
      [vertical.title, area.left + 5, area.top + 11, "start"],
    ]);
  }

  const upright = (/** @type {number} */ value) => `M${px(x(value))} ${area.top}V${area.bottom}`;
  const level = (/** @type {number} */ value) => `M${area.left} ${px(y(value))}H${area.right}`;
  const valueAtX = (/** @type {number} */ left) => valueAlong(axes.x, (left - area.left) / area.width);
  const valueAtY = (/** @type {number} */ top) => valueAlong(axes.y, (area.bottom - top) / area.height);
  return { svg, under, curves, over, area, resize, scale, x, y, upright, level, valueAtX, valueAtY };
}

/** @type {(element: Element, text: string, left: number, top: number) => void} at a place [px] */
export function write(element, text, left, top) {
  setText(element, text);
  put(element, { x: px(left), y: px(top) });
}

/**
 * What writes as many texts as are given, each with its place [px] and, but for the middle, its anchor.
 * @type {(parent: Element, look?: object) => (texts: any[][]) => void}
 */
export function makeTexts(parent, look) {
  const elements = [];
  return (texts) => {
    for (const element of elements.splice(texts.length)) element.remove();
    texts.forEach(([text, left, top, anchor = "middle"], n) => {
      elements[n] ??= draw(parent, "text", look);
      write(elements[n], text, left, top);
      put(elements[n], { "text-anchor": anchor });
    });
  };
}
