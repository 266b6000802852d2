/** The page put together: a setting is solved at once and drawn at the next frame. */

import { makeBristles } from "./bristles/bristles.js";
import { hashOf, makeAddress, valuesIn } from "./controls/address.js";
import { makeControls } from "./controls/controls.js";
import { makeCures } from "./cures/cures.js";
import { byId, data, on, setText } from "./view/dom.js";
import { makeKeeping } from "./keeping/keeping.js";
import { makeJumpMap } from "./maps/jumpmap.js";
import { makePlane } from "./maps/plane.js";
import { makePlayer } from "./stage/player.js";
import { listen } from "./stage/pointer.js";
import { makePortrait } from "./stage/portrait.js";
import { likest, makeApplications } from "./applications/applications.js";
import { makeFriction } from "./friction/friction.js";
import { makeResults } from "./results/results.js";
import { makeReader } from "./view/spelled.js";
import { makeSaid } from "./said/said.js";
import { makeSound } from "./sound/sound.js";
import { makeSchematic } from "./stage/schematic.js";
import { curveFlaw } from "./model/friction.js";
import { regimesOf } from "./model/regimes.js";
import { harmonicsOfMotion } from "./model/harmonics.js";
import { curesOf } from "./model/cures.js";
import { lugreCycle } from "./model/lugre.js";
import { slowJump } from "./model/cycle.js";
import { criticalCurve, equalJump, jumpOverSpeed } from "./model/maps.js";
import { flawOf, solve } from "./view/solution.js";
import { makeStory } from "./story/story.js";
import { makeStretch } from "./stage/stretch.js";
import { makeTimeCharts } from "./stage/timecharts.js";

const seen = makeStretch(redrawTime);
const charts = makeTimeCharts(byId("x-chart"), byId("F-chart"));
const portrait = makePortrait(byId("phase-chart"));
const schematic = makeSchematic(byId("schematic"));
const showResults = makeResults();
const address = makeAddress(place);
const reader = makeReader(data.units);

/** @type {Solution} */
let solution = null;
/** @type {Curve | null} */
let curve = null;
// Whether a redraw waits for the next frame.
let isDue = false;
// Whether a setting comes from a link.
let linked = false;
/** @type {Motion | null} the setting before, for comparison */
let ghost = null;

const player = makePlayer(seen, [charts, portrait, schematic]);

const controls = makeControls(data.controls, reader, (p) => {
  const wrong = curve && curveFlaw(curve, p.mu_s);
  if (wrong) return wrong;
  const next = solve(p, curve);
  const flaw = flawOf(next) ?? flawOf(next.constant);
  if (flaw) return flaw;
  solution = next;
  setText(byId("address-said"), "");
  redrawSoon();
  return null;
});

/** Take values [SI] and a friction curve, or nothing at all: throws a RangeError with the reason. */
function setAll(values, next = curve) {
  const before = curve;
  curve = next;
  try {
    controls.set(values);
  } catch (error) {
    curve = before;
    throw error;
  }
}

/** What brings the setting back, for the address. */
const asked = () => ({
  ...controls.wanted(),
  ...bristles.wanted(),
  ...(curve && { curve: curve.flat().slice(1) }),
});
function place() {
  const step = story.address();
  return step ? { ...step, ...bristles.wanted() } : asked();
}

/** @type {Page} */
const page = {
  set(values, { over, from, curve, still } = {}) {
    // An address may ask for a step of the story before anything is solved.
    const left = solution && place();
    if (over) setAll(over, curve);
    const before = over ? solution.motion : null;
    setAll(values, curve);
    if (still) return;
    // A link to a step of the story has its own place in the history.
    if (left && !linked) address.step(left, asked());
    ghost = before;
    seen.release(from);
    redrawSoon();
  },
  setting: controls.setting,
  isUsed(values, points = null) {
    const wanted = Object.entries(controls.wanted());
    const isSet = wanted.every(([name, value]) => (values[name] ?? value) === value);
    return isSet && `${points}` === `${curve}`;
  },
  solution: () => solution,
  link: () => `${location.href.split("#")[0]}${hashOf(place())}`,
};
/** What a section sees that is about constant friction. @type {Page} */
const constantPage = { ...page, solution: () => solution.constant };

const story = makeStory(page, data.steps);

const sound = makeSound(page);
/** @type {((solution: Solution) => void)[]} each shows a solution in its section of the page */
const sections = [
  makeApplications(page, data.applications),
  sound.show,
  makeSaid(page, data.sentences, controls.starts),
  makeFriction(page, data.curves, controls.starts, reader),
];
const ofConstant = [makeCures, makeJumpMap, makePlane].map((make) => make(constantPage));
const bristles = makeBristles(constantPage, data.bristles, reader, address.write);
ofConstant.push(bristles.show);
const keeping = makeKeeping(page, seen, reader);

function redrawSoon() {
  if (!isDue) requestAnimationFrame(() => isDue && redraw());
  isDue = true;
}

function redraw() {
  isDue = false;
  const { motion } = solution;
  seen.fit(motion, ghost);
  showResults(solution);
  portrait.show(motion, ghost);
  byId("forget").hidden = !ghost;
  const id = likest(data.applications, motion.p);
  schematic.dress(id, byId(`application-${id}`).querySelector(".drawn").textContent);
  redrawTime();
  address.write();
  for (const show of sections) show(solution);
  for (const show of ofConstant) show(solution.constant);
}

/** Draw what depends on the stretch of time. */
function redrawTime() {
  charts.show(solution.motion, seen, ghost);
  schematic.arrange(solution.motion, seen);
  keeping.refresh();
  player.show(solution.motion);
}

function resize() {
  // Tell the style how much of the window the stage covers.
  document.documentElement.style.setProperty("--covered", `${byId("stage").offsetHeight}px`);
  for (const drawing of [schematic, charts, portrait]) drawing.resize();
  redraw();
}

/** @param {HashChangeEvent} [event] what led here; none at the start */
function takeAddress(event) {
  // The address bar may have been written since.
  const { hash } = event ? new URL(event.newURL) : location;
  const [step, ...rest] = hash.split("&");
  linked = true;
  const taken = story.take(step, Boolean(event));
  linked = false;
  if (taken && !rest.length) return;
  // A jump to a place in the page asks for nothing, and must not cost the setting.
  if (byId(hash.slice(1))) return address.write();
  const { values, bad, points } = valuesIn(taken ? `#${rest.join("&")}` : hash);
  const problems = bad.map((part) => `${part} is no number in SI, such as v=0.02.`);
  const own = {};
  for (const [name, value] of Object.entries(values)) {
    const isBristle = name in bristles.starts;
    const objection = (isBristle ? bristles : controls).objectionTo(name, value);
    if (objection) problems.push(name === "step" ? `The story has no step ${value}.` : objection);
    else if (isBristle) own[name] = value;
    if (objection || isBristle) delete values[name];
  }
  bristles.set(own);
  seen.release();
  ghost = null;
  // What the address leaves out is as in its step, or at the start, whatever was shown before.
  const before = taken ? [] : [[controls.starts, null], [data.setting]];
  for (const [wanted, bent] of [...before, [values, points]]) {
    try {
      setAll(wanted, bent);
    } catch (error) {
      problems.push(error.message);
    }
  }
  if (taken) setTimeout(() => byId(step.slice(1)).scrollIntoView());
  const complaint = `The address asks for what cannot be: ${problems.join(" ")}`;
  setText(byId("address-said"), problems.length ? complaint : "");
}

takeAddress();
resize();

// The drawings, and the stage, which grows by a line of its sentence.
const resizes = new ResizeObserver(resize);
for (const element of document.querySelectorAll("svg, #stage")) resizes.observe(element);
on(window, "hashchange", takeAddress);
for (const chart of charts.charts) listen(chart, seen, player.point);
const moves = {
  "zoom-in": () => seen.zoom(0.5),
  "zoom-out": () => seen.zoom(2),
  earlier: () => seen.move(-0.25),
  later: () => seen.move(0.25),
  "zoom-auto": seen.reset,
  "from-start": () => {
    seen.fromStart();
    player.rewind();
  },
  forget: () => {
    ghost = null;
    redraw();
  },
};
for (const [id, move] of Object.entries(moves)) on(byId(id), "click", move);
if (!matchMedia("(prefers-reduced-motion: reduce)").matches) player.play();

/** For scripts and tests: the page's unrounded values, SI. */
window["stickslip"] = {
  set(values, next) {
    setAll(values, next);
    redraw();
  },
  regimes: (points, low, high, step) => regimesOf(controls.setting(), points, low, high, step),
  compare: (values) => page.set(values, { over: {} }),
  /** A text as a quantity of this SI unit, or what is wrong with it. */
  read: (text, unit) => reader.read(text, unit, unit),
  harmonics: (count) => harmonicsOfMotion(solution.motion, count),
  record: sound.record,
  cures: (p) => curesOf(p),
  lugre: lugreCycle,
  curves: { criticalCurve, equalJump, jumpOverSpeed, slowJump },
  at: (t) => solution.motion.at(t),
  events: (from, to) => [...solution.motion.events(from, to)],
  get view() {
    return { from: seen.from, to: seen.to };
  },
  set view({ from, to }) {
    seen.choose(from, to);
  },
};
const shown = {
  setting: controls.setting,
  curve: () => curve,
  cycle: () => solution.motion.cycle,
  simplified: () => solution.simple,
  criticalVelocity: () => solution.v_c,
};
for (const [name, get] of Object.entries(shown)) {
  Object.defineProperty(window["stickslip"], name, { get });
}
