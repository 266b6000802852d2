/** The model as a moving picture: a block on the ground, drawn along through a spring. */

import { draw, put, setText } from "../view/dom.js";
import { px } from "../view/frame.js";
import { quantity, scaleFor, shortest } from "../view/units.js";

/** @import { Motion, State } from "../model/motion.js" */

/** Jumps that one window holds; then it flips on, like the screen of an oscilloscope. */
const JUMPS_SHOWN = 5;

/** Pixels: on the left, width and height of the block, grip with its arrow, below the ground. */
const ROOM = { left: 18, block: 50, tall: 44, pull: 68, below: 36 };

/**
 * Draw the model in an empty SVG element.
 *
 * What is shown depends on the setting and the state alone, so time may run either way. All is
 * drawn once; a setting or a state only moves it.
 *
 * @param {SVGSVGElement} svg
 * @returns arrange(motion, width, height): draw a motion of motionOf in this size [px];
 *   show(state): put everything where a state of motion.at has it
 */
export function makeSchematic(svg) {
  const layGround = makeGround(svg);
  const layPlaces = makePlaces(svg);
  const layRuler = makeRuler(svg);
  const layGauge = makeGauge(svg);
  const stretch = makeSpring(svg);
  const pull = makePull(svg);
  const place = makeMass(svg);
  /** @type {(state: State) => void} */
  let show = () => {};

  /**
   * @param {Motion} motion
   * @param {number} width [px]
   * @param {number} height [px]
   */
  function arrange(motion, width, height) {
    put(svg, { viewBox: `0 0 ${width} ${height}` });
    const reach = reachOf(motion);
    const shortest = Math.min(Math.max(width / 18, 34), 54);
    const free = width - ROOM.left - ROOM.block - shortest - ROOM.pull;
    const scale = Math.max(free, 40) / (reach.length + reach.end - reach.low);
    const ground = height - ROOM.below;
    const level = ground - ROOM.tall / 2;
    // So long relaxed that the most compressed spring still has its shortest length.
    const relaxed = shortest - reach.low * scale;
    layGround(width, ground);
    layPlaces(motion.cycle, scale, ground);
    const turnRuler = layRuler(reach.length, scale, width, ground);
    const fill = layGauge(motion, reach, width);
    pull.name(motion.p.v);
    let shownPage = null;

    show = ({ mode, x, z }) => {
      // The mass may stand a rounding short of the position that begins a window.
      const page = Math.floor((x / reach.length) * (1 + 2 * Number.EPSILON) + 1e-9);
      const start = page * reach.length;
      if (page !== shownPage) turnRuler(start);
      shownPage = page;
      const left = ROOM.left + (x - start) * scale;
      const right = left + ROOM.block;
      const length = Math.max(relaxed + z * scale, shortest);
      place(left, ground, mode);
      stretch(right, length, level, shortest);
      pull.place(right + length, level);
      fill(z);
    };
  }

  return { arrange, show: (/** @type {State} */ state) => show(state) };
}

/**
 * Lengths [m]: of a window, and of the spring the least, the most, that at a window's end.
 *
 * @param {Motion} motion
 */
function reachOf({ p, numbers, cycle, slip, z_s }) {
  const turn = (2 * Math.PI) / numbers.w;
  const duration = cycle.exists ? cycle.t_slip : turn;
  const lengths = [0, z_s];
  for (let i = 1; i <= 100; i++) lengths.push(z_s + slip.at((duration * i) / 100).growth);
  if (!cycle.exists) lengths.push((numbers.F_k + p.c * p.v) / p.k);
  const low = Math.min(...lengths);
  const high = Math.max(...lengths);
  const stride = cycle.exists ? cycle.delta_x : Math.max(high, p.v * turn);
  const end = cycle.exists ? z_s - cycle.spring_drop : high;
  return { low, high, end, length: JUMPS_SHOWN * stride };
}

/** Returns what lays the ground at a height in a width [px]. */
function makeGround(svg) {
  const group = draw(svg, "g", { class: "ground" });
  const hatch = draw(group, "path", { class: "hatch" });
  const line = draw(group, "path");
  return (width, ground) => {
    let d = "";
    for (let x = 2; x < width + 8; x += 9) d += `M${x} ${ground + 1}l-7 7`;
    put(hatch, { d });
    put(line, { d: `M0 ${ground}H${width}` });
  };
}

/** Returns what marks where the mass sticks, if these places stand apart. */
function makePlaces(svg) {
  const places = draw(svg, "path", { class: "places" });
  return ({ delta_x }, scale, ground) => {
    const at = (i) => px(ROOM.left + ROOM.block / 2 + i * delta_x * scale);
    let d = "";
    for (let i = 0; i <= JUMPS_SHOWN && delta_x * scale > 40; i++) {
      d += `M${at(i)} ${ground - ROOM.tall - 6}V${ground}`;
    }
    put(places, { d });
  };
}

/**
 * Returns what scales the ruler for a window's length [m]; that returns what labels it for the
 * window that starts at a position [m].
 */
function makeRuler(svg) {
  const group = draw(svg, "g", { class: "ruler" });
  const marks = draw(group, "path");
  const name = draw(group, "text", { class: "unit" });
  const labels = [];
  return (length, scale, width, ground) => {
    const { size, unit } = scaleFor(length, "length");
    const step = roundStep(58 / (scale * size));
    const apart = step * size * scale;
    const zero = ROOM.left + ROOM.block / 2;
    const y = ground + 29;
    setText(name, unit);
    put(name, { x: width - 6, y });
    const count = Math.floor(width / apart + 3);
    while (labels.length < count) labels.push(draw(group, "text"));
    for (const label of labels.splice(count)) label.remove();
    return (start) => {
      const first = Math.floor(start / (step * size) - zero / apart);
      let d = "";
      labels.forEach((label, i) => {
        const at = zero + (first + i - start / (step * size)) * apart;
        for (let j = 0; j < 5; j++) d += `M${px(at + j * apart * 0.2)} ${ground + 11}v${j ? 4 : 7}`;
        const text = String(Number(((first + i) * step).toPrecision(12)));
        const roomy = (first + i) % Math.ceil((text.length * 8) / apart) === 0;
        setText(label, roomy && at > 12 && at < width - 44 ? text : "");
        put(label, { x: px(at), y });
      });
      put(marks, { d });
    };
  };
}

/** The least of 1, 2, 5, 10, ... that is not below a number. */
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= least * 0.999);
}

/** Returns what scales the gauge for a motion; that returns what fills it for an extension [m]. */
function makeGauge(svg) {
  const left = 104;
  const group = draw(svg, "g", { class: "gauge" });
  write(group, "spring force F", { x: 6, y: 17, class: "what" });
  const range = draw(group, "rect", { class: "range", x: left, y: 9, height: 9 });
  const bar = draw(group, "rect", { class: "force", y: 9, height: 9 });
  const zero = draw(group, "path", { class: "zero" });
  const limit = draw(group, "path", { class: "limit" });
  const name = write(group, "break-away F", { y: 33 });
  write(name, "s", { class: "index", dy: 3 }, "tspan");
  const force = write(name, "", { dy: -3 }, "tspan");
  return ({ numbers, z_s }, { low, high }, width) => {
    const length = Math.max(Math.min(260, width - left - 30), 40);
    const at = (z) => left + ((z - low) / (high - low)) * length;
    const half = 74;
    put(range, { width: length });
    put(zero, { d: low < 0 ? `M${px(at(0))} 7v13` : "" });
    put(limit, { d: `M${px(at(z_s))} 5v17` });
    put(name, { x: px(Math.min(Math.max(at(z_s), left + half), width - half - 4)) });
    setText(force, ` = ${quantity(numbers.F_s, "force")}`);
    return (z) => {
      put(bar, { x: px(Math.min(at(0), at(z))), width: px(Math.abs(at(z) - at(0))) });
    };
  };
}

/** Returns what stretches the spring from a place to a length at a level [px]. */
function makeSpring(svg) {
  const spring = draw(svg, "polyline", { class: "spring" });
  const lead = 6;
  return (left, length, level, shortest) => {
    const bends = 2 * Math.floor((shortest - 2 * lead) / 5.2);
    const pitch = (length - 2 * lead) / bends;
    let points = `${px(left)},${level} ${px(left + lead)},${level}`;
    for (let i = 0; i < bends; i++) {
      points += ` ${px(left + lead + (i + 0.5) * pitch)},${level + (i % 2 ? 9 : -9)}`;
    }
    points += ` ${px(left + length - lead)},${level} ${px(left + length)},${level}`;
    put(spring, { points });
  };
}

/** Returns what names the speed of the pulled end [m/s], and what puts it at a place [px]. */
function makePull(svg) {
  const group = draw(svg, "g", { class: "pull" });
  draw(group, "circle", { cx: 4, r: 4 });
  draw(group, "path", { d: "M8 0H44" });
  draw(group, "path", { class: "head", d: "M54 0l-12 -5v10z" });
  const name = write(group, "", { x: 29, y: -13 });
  return {
    name(v) {
      const { size, unit } = scaleFor(v, "velocity");
      setText(name, `${shortest(Number((v / size).toPrecision(4)))}\u00a0${unit}`);
    },
    place(left, level) {
      put(group, { transform: `translate(${px(left)} ${level})` });
    },
  };
}

/** Returns what puts the block with its left edge at a place on the ground [px]. */
function makeMass(svg) {
  const { block, tall } = ROOM;
  const group = draw(svg, "g");
  draw(group, "path", { class: "teeth solid", d: `M4 0${"l3.5 7l3.5 -7".repeat(6)}z` });
  draw(group, "path", { class: "trail", d: "M-5 -12h-10M-5 -22h-15M-5 -32h-10" });
  draw(group, "rect", { class: "body", x: 1, y: -tall, width: block - 2, height: tall - 1, rx: 5 });
  const word = write(group, "", { x: block / 2, y: 4 - tall / 2 });
  draw(group, "path", { class: "solid", d: `M${block / 2 - 3.5} 9h7l-3.5 5z` });
  let shown = null;
  return (left, ground, mode) => {
    put(group, { transform: `translate(${px(left)} ${ground})` });
    if (mode === shown) return;
    shown = mode;
    put(group, { class: mode === 0 ? "mass stick" : "mass slip" });
    setText(word, mode === 0 ? "STICK" : "SLIP");
  };
}

function write(parent, text, attributes, tag = "text") {
  const written = draw(parent, tag, attributes);
  setText(written, text);
  return written;
}
