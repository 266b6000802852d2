/** Drawings of the page as a picture that stands alone. */

import { draw, put, setText } from "../view/dom.js";

/** Pixels between two drawings of the picture, and above them for its caption. */
const GAP = 8;
const TITLE = 40;
/** Pixels of the PNG to one of the page. */
const FINENESS = 2;

/**
 * CSS with every var(--name) replaced by its value at an element, for use away from the page.
 * @type {(cssText: string, element: Element) => string}
 */
export function resolvedStyle(cssText, element) {
  const values = getComputedStyle(element);
  const chosen = matchMedia("(prefers-color-scheme: dark)").matches ? "$2" : "$1";
  const valueOf = (name) => values.getPropertyValue(name).trim();
  return cssText.replace(/var\((--[\w-]+)\)/g, (_, name) =>
    valueOf(name).replace(/light-dark\((.*), (.*)\)/, chosen),
  );
}

/** @typedef {{text: string, width: number, height: number}} Picture an SVG document of a size [px] */

/**
 * Drawings of the page one above the other, under the lines of a title, as a document that stands
 * alone; in the style, without custom properties, `.sheet` is the background.
 * @type {(svgs: SVGSVGElement[], style: string, title: string[]) => Picture}
 */
export function pictureOf(svgs, style, title) {
  const width = Math.max(...svgs.map((svg) => svg.clientWidth));
  const height = svgs.reduce((sum, svg) => sum + svg.clientHeight + GAP, TITLE - GAP);
  const [size, viewBox] = [{ width, height }, `0 0 ${width} ${height}`];
  const family = { "font-family": "system-ui, sans-serif" };
  const whole = draw(document.createDocumentFragment(), "svg", { ...size, viewBox, ...family });
  setText(draw(whole, "title"), title.join(", "));
  setText(draw(whole, "style"), style);
  draw(whole, "rect", { class: "sheet", ...size, fill: "white" });
  title.forEach((line, n) => {
    setText(draw(whole, "text", { class: "axis", x: 8, y: 15 + 16 * n }), line);
  });
  let y = TITLE;
  for (const svg of svgs) {
    const copy = /** @type {Element} */ (svg.cloneNode(true));
    put(copy, { x: 0, y, width: svg.clientWidth, height: svg.clientHeight });
    whole.append(copy);
    y += svg.clientHeight + GAP;
  }
  const text = new XMLSerializer().serializeToString(whole);
  return { text: `<?xml version="1.0" encoding="UTF-8"?>\n${text}`, ...size };
}

/** @type {(picture: Picture, background: string) => Promise<Blob>} on a background [CSS colour] */
export async function pngOf({ text, width, height }, background) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(width * FINENESS);
  canvas.height = Math.round(height * FINENESS);
  await image.decode();
  const context = canvas.getContext("2d");
  context.fillStyle = background;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  const blob = await new Promise((done) => canvas.toBlob(done, "image/png"));
  if (!blob) throw new Error(`no picture can have ${canvas.width} x ${canvas.height} pixels`);
  return blob;
}
