/** The bar over the speed of the pull: where it sticks, swings or slides evenly. */

import { draw, put, setText } from "../view/dom.js";
import { px } from "../view/frame.js";
import { quantity } from "../view/units.js";

/** Height of the bar, and a letter of its names [px]. */
const TALL = 22;
const NAME_LETTER = 6.4;

/** @type {(regime: Pick<Regime, "sticks" | "even">) => string} what a regime is called */
export function nameOfRegime({ sticks, even }) {
  return sticks ? (even ? "sticks or even" : "sticks") : even ? "even" : "swings";
}

/** What fills a regime: the hatches of the charts and of the plane. */
const FILLS = { swings: "url(#x-chart-hatch)", "sticks or even": "url(#plane-hatch)" };

/** @type {(svg: SVGSVGElement, regimes: Regime[], frame: Frame) => void} draw them under a frame */
export function drawBar(svg, regimes, { area, x }) {
  svg.textContent = "";
  put(svg, { viewBox: `0 0 ${svg.clientWidth} ${svg.clientHeight}` });
  for (const regime of regimes) {
    const [left, right] = [regime.low, regime.high].map((v) => px(Math.max(x(v), area.left)));
    const name = nameOfRegime(regime);
    const place = { x: left, y: 2, width: right - left, height: TALL };
    if (regime.sticks) draw(svg, "rect", { class: "stick-band", ...place });
    draw(svg, "rect", { class: "edge", fill: FILLS[name] ?? "none", ...place });
    if (place.width < NAME_LETTER * name.length) continue;
    const middle = { "text-anchor": "middle", x: 0.5 * (left + right), y: 17 };
    setText(draw(svg, "text", { class: "band-name", ...middle }), name);
  }
}

/**
 * The regimes in words at a speed of the pull [m/s]; `calms`: whether a slip without stick calms
 * down, and does not swing for ever.
 * @type {(regimes: Regime[], v: number, calms: boolean) => string}
 */
export function regimesInWords(regimes, v, calms) {
  const here = regimes.find(({ low, high }) => v >= low && v <= high) ?? regimes[0];
  const [least, most] = [regimes[0].low, regimes[regimes.length - 1].high];
  /** @type {(is: (regime: Regime) => boolean) => string} */
  const where = (is) => {
    // What ends where the next begins is one range with it.
    const found = regimes.filter(is);
    const lows = found.filter(({ low }) => !found.some(({ high }) => high === low));
    const highs = found.filter(({ high }) => !found.some(({ low }) => low === high));
    const words = lows.map(({ low }, n) => {
      const { high } = highs[n];
      const [from, to] = [low, high].map((end) => quantity(end, "velocity"));
      if (low === least) return high === most ? "at every speed shown" : `up to ${to}`;
      return high === most ? `from ${from} on` : `from ${from} to ${to}`;
    });
    return words.join(" and ") || "at no speed shown";
  };
  const now = {
    sticks: "it sticks",
    "sticks or even": "it sticks or slides evenly, by its start",
    swings: "it swings without sticking",
    even: calms ? "it slides evenly" : "it swings or slides evenly, by its start",
  }[nameOfRegime(here)];
  return (
    `At ${quantity(v, "velocity")} ${now}. It sticks ${where(({ sticks }) => sticks)}; ` +
    `steady sliding is unstable ${where(({ even }) => !even)}.`
  );
}
