/** The page put together: a setting is solved at once and drawn at the next frame. */

import { makeAddress, valuesIn } from "./controls/address.js";
import { makeControls } from "./controls/controls.js";
import { makeCures } from "./cures/cures.js";
import { byId, on, setText } from "./view/dom.js";
import { makeKeeping } from "./keeping/keeping.js";
import { makeMaps } from "./maps/maps.js";
import { makePlayer } from "./stage/player.js";
import { listen } from "./stage/pointer.js";
import { makePortrait } from "./stage/portrait.js";
import { makeApplications } from "./applications/applications.js";
import { makeReadouts } from "./stage/readouts.js";
import { makeResults } from "./results/results.js";
import { makeReader } from "./view/spelled.js";
import { makeSaid } from "./said/said.js";
import { makeSound } from "./sound/sound.js";
import { makeSchematic } from "./stage/schematic.js";
import { claimed } from "./model/claims.js";
import { harmonicsOf } from "./model/harmonics.js";
import { curesOf } from "./model/cures.js";
import { criticalCurve, equalJump, jumpOverSpeed, slowJump } from "./model/maps.js";
import { flawOf, solve } from "./view/solution.js";
import { makeStory } from "./story/story.js";
import { makeStretch } from "./stage/stretch.js";
import { makeTimeCharts } from "./stage/timecharts.js";

/**
 * @import { Setting } from "./model/friction.js"
 * @import { Motion } from "./model/motion.js"
 * @import { Solution } from "./view/solution.js"
 */

/**
 * What a section asks of the page.
 *
 * @typedef {object} Page
 * @property {(values: Partial<Setting>, look?: Look) => void} set take these values [SI], the
 *   others stay; throws a RangeError with the reason if they are refused
 * @property {() => Setting} setting the values in use
 * @property {() => Solution} solution the setting solved
 */

/**
 * How a new setting is looked at.
 *
 * @typedef {object} Look
 * @property {boolean} [ghost] the curves of the setting before stay as a ghost
 * @property {"cycles" | "start"} [from] steady cycles, or the first load-up too
 */

const data = JSON.parse(byId("page-data").textContent);

const seen = makeStretch();
const charts = makeTimeCharts(byId("x-chart"), byId("F-chart"));
const portrait = makePortrait(byId("phase-chart"));
const schematic = makeSchematic(byId("schematic"));
const readouts = makeReadouts();
const showResults = makeResults();
const address = makeAddress();
const reader = makeReader(data.units);

/** @type {Solution} */
let solution = null;
let waiting = false;
// Whether a setting comes from a link.
let linked = false;
/** @type {Motion | null} the setting before, for comparison */
let ghost = null;
// The size of the schematic [px]; asking the browser at every redraw would cost a layout.
let scene = { width: 0, height: 0 };

const player = makePlayer(
  seen,
  (t) => {
    const state = solution.motion.at(t);
    charts.mark(state);
    portrait.mark(state);
    schematic.show(state);
    readouts.show(state);
  },
  (t) => readouts.tell(solution.motion.at(t)),
);

const controls = makeControls(data.controls, reader, (p) => {
  const next = solve(p);
  const flaw = flawOf(next);
  if (flaw) return flaw;
  solution = next;
  setText(byId("address-said"), "");
  redrawSoon();
  return null;
});

/** @type {Page} */
const page = {
  set(values, { ghost: keep = false, from = /** @type {Look["from"]} */ ("cycles") } = {}) {
    // An address may ask for a step of the story before anything is solved.
    const before = solution?.motion ?? null;
    const left = before && (story.address() ?? controls.wanted);
    controls.set(values);
    // A link to a step of the story has its own place in the history.
    if (left && !linked) address.step(left, controls.wanted);
    ghost = keep ? before : null;
    seen.release(from);
    redrawSoon();
  },
  setting: () => controls.setting,
  solution: () => solution,
};

const story = makeStory(page, data.steps);

/** @type {((solution: Solution) => void)[]} each shows a solution in its section of the page */
const sections = [];
sections.push(makeApplications(page, data.applications));
const sound = makeSound(page);
sections.push(sound.show, makeSaid(page, data.sentences, controls.starts));
sections.push(makeCures(page), makeMaps(page));

const keeping = makeKeeping({
  motion: () => solution.motion,
  stretch: seen,
  starts: controls.starts,
  reader,
});

function redrawSoon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => waiting && redraw());
}

function redraw() {
  waiting = false;
  const { motion } = solution;
  seen.fit(motion, ghost);
  showResults(solution);
  portrait.show(motion, ghost);
  byId("forget").hidden = !ghost;
  redrawTime();
  address.write(story.address() ?? controls.wanted);
  for (const show of sections) show(solution);
}

/** Draw what depends on the stretch of time. */
function redrawTime() {
  charts.show(solution.motion, seen, ghost);
  schematic.arrange(solution.motion, seen, scene.width, scene.height);
  readouts.fit(solution.motion, seen);
  keeping.refresh();
  player.refresh();
}

function resize() {
  const { clientWidth, clientHeight } = byId("schematic");
  scene = { width: clientWidth, height: clientHeight };
  cover();
  charts.resize();
  portrait.resize();
  redraw();
}

/** Tell the style how much of the window the stage covers. */
function cover() {
  document.documentElement.style.setProperty("--covered", `${byId("stage").offsetHeight}px`);
}

/** @param {HashChangeEvent} [event] what led here; none at the start */
function takeAddress(event) {
  linked = true;
  const taken = story.take(location.hash, Boolean(event));
  linked = false;
  if (taken) return;
  // A jump to a place in the page asks for nothing, and must not cost the setting.
  if (byId(location.hash.slice(1))) return address.write(story.address() ?? controls.wanted);
  const { values, bad } = valuesIn(location.hash);
  const problems = bad.map((part) => `${part} is no number.`);
  for (const [name, value] of Object.entries(values)) {
    const objection = controls.objectionTo(name, value);
    if (!objection) continue;
    problems.push(name === "step" ? `The story has no step ${value}.` : objection);
    delete values[name];
  }
  seen.release();
  ghost = null;
  // What the address leaves out is as at the start, whatever was shown before.
  for (const asked of [controls.starts, data.setting, values]) {
    try {
      controls.set(asked);
    } catch (error) {
      problems.push(error.message);
    }
  }
  const complaint = `The address asks for what cannot be: ${problems.join(" ")}`;
  setText(byId("address-said"), problems.length ? complaint : "");
}

cover();
takeAddress();
resize();

// The drawings alone: what else changes its size is none of their business.
const resizes = new ResizeObserver(resize);
for (const svg of document.querySelectorAll("svg")) resizes.observe(svg);
on(window, "hashchange", takeAddress);
for (const chart of charts.charts) {
  listen(chart, seen, { read: player.point, changed: redrawTime });
}
for (const [id, act] of [
  ["zoom-in", () => seen.zoom(0.5)],
  ["zoom-out", () => seen.zoom(2)],
  ["earlier", () => seen.move(-0.25)],
  ["later", () => seen.move(0.25)],
  ["zoom-auto", () => seen.reset()],
  ["from-start", () => seen.fromStart()],
]) {
  // @ts-expect-error The compiler takes each pair for a list, whose items are both.
  on(byId(id), "click", () => {
    // @ts-expect-error
    act();
    redrawTime();
  });
}
on(byId("forget"), "click", () => {
  ghost = null;
  redraw();
});
if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

/** For scripts and tests: the page's unrounded values, SI. */
// @ts-expect-error A property that the page adds to its window.
window.stickslip = {
  set(values) {
    controls.set(values);
    redraw();
  },
  compare: (values) => page.set(values, { ghost: true }),
  get setting() {
    return controls.setting;
  },
  get cycle() {
    return solution.motion.cycle;
  },
  get simplified() {
    return solution.simple;
  },
  get criticalVelocity() {
    return solution.v_c;
  },
  /** A text as a quantity of this SI unit, or what is wrong with it. */
  read: (text, unit) => reader.read(text, unit, unit),
  said: (id, setting) => claimed(id, { ...controls.starts, ...setting }),
  harmonics: (count) => harmonicsOf(solution.motion.p, count),
  record: sound.record,
  cures: (p) => curesOf(p),
  curves: { criticalCurve, equalJump, jumpOverSpeed, slowJump },
  at: (t) => solution.motion.at(t),
  events: (from, to) => [...solution.motion.events(from, to)],
  get view() {
    return { from: seen.from, to: seen.to };
  },
  set view({ from, to }) {
    seen.choose(from, to);
    redrawTime();
  },
};
