/** Drawings of the page as a picture that stands alone. */

import { draw, put, setText } from "../view/dom.js";

/**
 * CSS with every var(--name) replaced by its value at an element, for use away from the page.
 *
 * @param {string} cssText
 * @param {Element} element
 */
export function resolvedStyle(cssText, element) {
  const values = getComputedStyle(element);
  return cssText.replace(
    /var\(\s*(--[\w-]+)\s*(?:,\s*([^()]*))?\)/g,
    (_, name, otherwise = "") => values.getPropertyValue(name).trim() || otherwise.trim(),
  );
}

/**
 * Drawings of the page as one SVG document that stands alone.
 *
 * @param {Array<{svg: SVGSVGElement, x: number, y: number, width: number, height: number}>} parts
 *   the drawings and where each is put [px]
 * @param {string} style CSS without custom properties; its `.sheet` is the background
 * @param {string[]} title what it shows: lines that are written on top
 * @returns {string} the document
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
    /** @type {any} an SVGSVGElement, which cloneNode calls a Node */
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
 *
 * @param {string} text
 * @param {number} width [px]
 * @param {number} height [px]
 * @param {number} scale
 * @param {string} background
 * @returns {Promise<Blob>}
 */
export function pngOf(text, width, height, scale, background) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  return image.decode().then(() => {
    const context = canvas.getContext("2d");
    context.fillStyle = background;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    const tooLarge = new Error(`no picture can have ${canvas.width} x ${canvas.height} pixels`);
    return new Promise((done, failed) => {
      canvas.toBlob((blob) => (blob ? done(blob) : failed(tooLarge)), "image/png");
    });
  });
}
