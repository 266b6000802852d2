/** Drawings of the page as a picture that stands alone. */

import { draw, put, setText } from "../view/dom.js";

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

/**
 * Drawings of the page as one SVG document that stands alone, {svg, x, y, width, height} [px], under the
 * lines of a title; in the style, without custom properties, `.sheet` is the background.
 * @type {(parts: any[], style: string, title: string[]) => string}
 */
export function svgText(parts, style, title) {
  const width = Math.max(...parts.map((part) => part.x + part.width));
  const height = Math.max(...parts.map((part) => part.y + part.height));
  const whole = draw(document.createDocumentFragment(), "svg", {
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
    "font-family": "system-ui, sans-serif",
  });
  setText(draw(whole, "title"), title.join(", "));
  setText(draw(whole, "style"), style);
  draw(whole, "rect", { class: "sheet", width, height, fill: "white" });
  title.forEach((line, n) => {
    setText(draw(whole, "text", { class: "axis", x: 8, y: 15 + 16 * n }), line);
  });
  for (const { svg, ...place } of parts) {
    const copy = svg.cloneNode(true);
    // What placed it on the page must not place it here.
    copy.removeAttribute("style");
    put(copy, place);
    whole.append(copy);
  }
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(whole)}`;
}

/**
 * An SVG document of this size [px] as a PNG, `scale` pixels of it to one of the document, on a
 * background [CSS colour].
 * @type {(text: string, width: number, height: number, scale: number, background: string) =>
 *   Promise<Blob>}
 */
export async function pngOf(text, width, height, scale, background) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  await image.decode();
  const context = canvas.getContext("2d");
  context.fillStyle = background;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  const blob = await new Promise((done) => canvas.toBlob(done, "image/png"));
  if (!blob) throw new Error(`no picture can have ${canvas.width} x ${canvas.height} pixels`);
  return blob;
}
