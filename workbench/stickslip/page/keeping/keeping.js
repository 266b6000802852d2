/** What a person takes along: data, pictures, the command line. */

import { byId, on, setText } from "../view/dom.js";
import { pictureOf, pngOf, resolvedStyle } from "./picture.js";
import { commandLine, csvText } from "./texts.js";

/** How long a button says what it has done [ms]. */
const CONFIRMED = 3000;

/** @type {(p: Setting, curve: Curve | null) => string[]} the lines of a caption, SI */
function settingInWords({ k, v, mu_s, mu_k, m, g, load, c }, curve) {
  const kinetic = curve ? `μ(u) by ${curve.length} points` : `μₖ = ${mu_k}`;
  return [
    `k = ${k} N/m, v = ${v} m/s, μₛ = ${mu_s}, ${kinetic}`,
    `m = ${m} kg, g = ${g} m/s², load = ${load} N, c = ${c} N·s/m`,
  ];
}

/**
 * Returns refresh(): after another setting or stretch of time.
 * @type {(page: Page, stretch: Stretch, reader: Reader) => {refresh: () => void}}
 */
export function makeKeeping(page, stretch, reader) {
  const command = byId("command");
  const said = byId("keep-said");

  function atClick(id, act) {
    on(byId(id), "click", async () => {
      try {
        setText(said, await act());
      } catch (error) {
        setText(said, `That did not work: ${error.message}.`);
      }
    });
  }

  atClick("save-csv", () => {
    const { motion } = page.solution();
    save("stick-slip.csv", csvText(motion, stretch.from, stretch.to), "text/csv");
    return "stick-slip.csv: SI units, events at their exact times.";
  });
  atClick("save-svg", () => {
    save("stick-slip.svg", picture().text, "image/svg+xml");
    return "stick-slip.svg: charts and portrait.";
  });
  atClick("save-png", async () => {
    save("stick-slip.png", await png(), "image/png");
    return "stick-slip.png: charts and portrait.";
  });
  atClick("copy", async () => {
    try {
      await navigator.clipboard.writeText(command.textContent);
      return "Copied.";
    } catch {
      getSelection().selectAllChildren(command);
      return "Selected: copy it with the keyboard.";
    }
  });

  const share = byId("share");
  const name = share.textContent;
  on(share, "click", async () => {
    const url = page.link();
    const text = { title: document.title, text: byId("lead").textContent, url };
    try {
      const file = new File([await png()], "stick-slip.png", { type: "image/png" });
      const shared = [{ ...text, files: [file] }, text].find((each) => navigator.canShare?.(each));
      if (shared) return await navigator.share(shared);
      await navigator.clipboard.writeText(url);
      setText(share, "Link copied");
    } catch (error) {
      // The menu was closed.
      if (error.name === "AbortError") return;
      setText(share, "Copy the address");
    }
    setTimeout(() => setText(share, name), CONFIRMED);
  });

  function picture() {
    const svgs = ["x-chart", "F-chart", "phase-chart"].map(byId);
    const style = resolvedStyle(byId("chart-style").textContent, document.body);
    const { p, curve } = page.solution().motion;
    return pictureOf(svgs, style, settingInWords(p, curve));
  }

  const png = () => pngOf(picture(), getComputedStyle(document.body).backgroundColor);

  return {
    refresh() {
      const { p, curve } = page.solution().motion;
      setText(command, commandLine(p, stretch.to, reader, curve !== null));
    },
  };
}

/** @type {(name: string, content: BlobPart, type: string) => void} hand a file to the person */
export function save(name, content, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  // The download has begun by then; freed at once, some browsers find nothing to save.
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
