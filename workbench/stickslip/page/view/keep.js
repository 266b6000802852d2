/** What a person takes along: the curve as CSV, the command that repeats it, the picture. */

import { draw, put, setText } from "./dom.js";
import { shifted } from "./units.js";

/** More transitions than this are left out of a file: it would grow without showing more. */
const TRANSITIONS_AT_MOST = 100000;

/**
 * The motion as a CSV file in the format of `stickslip simulate --output-file`, in SI, every
 * number with all its digits.
 *
 * @param {object} motion of motionOf
 * @param {number} from [s]
 * @param {number} to [s]
 * @param {number} [samples] number of even steps; the transitions stand in between
 * @returns {string} the file
 */
export function csvText(motion, from, to, samples = 2000) {
  const rows = ['"time","x","x_dot","x_pull","z","F","F_friction","F_s","sticking","mode"'];
  const { F_s } = motion.numbers;
  for (const t of timesOf(motion, from, to, samples)) {
    const { mode, x, x_dot, x_pull, z, F, F_friction } = motion.at(t);
    rows.push([t, x, x_dot, x_pull, z, F, F_friction, F_s, mode === 0 ? 1 : 0, mode].join(","));
  }
  return `${rows.join("\n")}\n`;
}

/** Even times and those of the transitions, rising, each once. */
function timesOf(motion, from, to, samples) {
  const few = !motion.cycle.exists || (2 * (to - from)) / motion.cycle.T < TRANSITIONS_AT_MOST;
  const times = new Set([to]);
  for (let i = 0; i < samples; i++) times.add(from + ((to - from) * i) / samples);
  if (few) for (const { t } of motion.events(from, to)) times.add(t);
  return Float64Array.from(times).sort();
}

/**
 * The command that repeats a run. Python reads its numbers back as the very same doubles.
 *
 * @param {object} p the setting, SI
 * @param {object} starts start values of the FMU by name, SI: m, g, c are named where they differ
 * @param {number} to end of the run [s]
 * @returns {string} one line for a shell
 */
export function commandLine(p, starts, to) {
  const inMillimetres = shifted(`${p.v}`, 3);
  // Seventeen digits may not survive the rounding of the shifted number; SI always does.
  const v = shifted(`${inMillimetres}`, -3) === p.v ? `${inMillimetres}mm/s` : p.v;
  const others = ["m", "g", "c"].filter((name) => p[name] !== starts[name]);
  return [
    `stickslip simulate --k ${p.k} --v ${v} --mu-s ${p.mu_s} --mu-k ${p.mu_k}`,
    ...others.map((name) => `--${name} ${p[name]}`),
    `--stop-time ${to}`,
  ].join(" ");
}

/** CSS with every var(--name) replaced by its value at an element, for use away from the page. */
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
 * @returns {Promise<Blob>}
 */
export function savePng(text, width, height, scale, background) {
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

/** Hand a file to the person as a download. */
export function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  // The download has begun by then; freed at once, some browsers find nothing to save.
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
