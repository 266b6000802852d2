/** A friction curve as a CSV table: a line of speed and coefficient for each point, in rising order. */

import { scaleFor } from "../view/units.js";
import { typedText } from "../controls/values.js";

/** The columns that are looked for, each with its SI unit, which the heading of a speed must name. */
const COLUMNS = [
  { names: "speed|velocity|v|u|x_dot", unit: "m/s" },
  { names: "mu|coefficient|friction[ _]coefficient|cof", unit: "" },
];

/** @type {(curve: Curve) => string} */
export function tableOf(curve) {
  const scale = scaleFor(curve[curve.length - 1][0], "velocity");
  const lines = curve.map(([u, mu]) => `${typedText(u, scale)}, ${mu}`);
  return `speed [${scale.unit.replace("µ", "u")}], mu\n${lines.join("\n")}\n`;
}

/**
 * The curve of a table; throws a RangeError with the line and what is wrong with it.
 * @type {(text: string, reader: Reader) => Curve}
 */
export function curveIn(text, reader) {
  const lines = text.split(/\r?\n/).map((line, n) => ({ line: line.trim(), at: n + 1 }));
  const [header, ...rows] = lines.filter(({ line }) => line && line[0] !== "#");
  const mark = /[;\t]/.exec(header?.line)?.[0] ?? ",";
  const titles = header?.line.split(mark) ?? [];
  const columns = COLUMNS.map(({ names, unit }) => {
    const heading = RegExp(`^\\s*(?:${names})\\s*(?:[[(](.*)[\\])])${unit ? "" : "?"}\\s*$`, "i");
    const place = titles.findIndex((title) => heading.test(title));
    if (place < 0)
      throw RangeError("The first line must name speed and mu, with units: speed [mm/s], mu");
    return { place, unit, shown: heading.exec(titles[place])[1] || unit };
  });
  const points = rows.map(({ line, at }) => {
    const cells = line.split(mark);
    const [u, mu] = columns.map(({ place, unit, shown }) => {
      const cell = cells[place] ?? "";
      const typed = mark === "," ? cell : cell.replace(",", ".");
      const { value, wrong } = reader.read(typed, unit, shown);
      if (wrong) throw RangeError(`Line ${at}: “${cell.trim()}” ${wrong}.`);
      return value;
    });
    return /** @type {[number, number]} */ ([u, mu]);
  });
  // Below its lowest speed the friction stays what it is there.
  if (points[0]?.[0] > 0) points.unshift([0, points[0][1]]);
  return points;
}
