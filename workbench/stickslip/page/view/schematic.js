/** The model as a moving picture: a block on the ground, drawn along through a spring. */

import { draw, put, setText } from "./dom.js";
import { px } from "./frame.js";
import { shortest } from "./typed.js";
import { quantity, scaleFor } from "./units.js";

/** Jumps that one window holds; then it flips on, like the screen of an oscilloscope. */
const JUMPS_SHOWN = 5;

/** Pixels: on the left, width and height of the block, grip with its arrow, below the ground. */
const ROOM = { left: 18, block: 50, tall: 44, pull: 68, below: 36 };

/**
 * Draw the model in an empty SVG element.
 *
 * What is shown depends on the setting and the state alone, so time may run either way.
 *
 * @param {SVGSVGElement} svg
 * @returns {{arrange: function(object, number, number), show: function(object)}}
 *   arrange(motion, width, height): draw a motion of motionOf in this size [px];
 *   show(state): put everything where a state of motion.at has it
 */
export function makeSchematic(svg) {
  let show = () => {};
  return {
    arrange(motion, width, height) {
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      svg.replaceChildren();
      show = drawScene(svg, motion, width, height);
    },
    show: (state) => show(state),
  };
}

function drawScene(svg, motion, width, height) {
  const reach = reachOf(motion);
  const shortest = Math.min(Math.max(width / 18, 34), 54);
  const free = width - ROOM.left - ROOM.block - shortest - ROOM.pull;
  const scale = Math.max(free, 40) / (reach.length + reach.end - reach.low);
  const ground = height - ROOM.below;
  const level = ground - ROOM.tall / 2;
  // So long relaxed that the most compressed spring still has its shortest length.
  const relaxed = shortest - reach.low * scale;

  drawGround(svg, width, ground);
  drawPlaces(svg, motion.cycle, scale, ground);
  const turnRuler = drawRuler(svg, reach.length, scale, width, ground);
  const fill = drawGauge(svg, motion, reach, width);
  const stretch = drawSpring(svg, shortest, level);
  const pull = drawPull(svg, motion.p.v, level);
  const place = drawMass(svg, ground);
  let shownPage = null;

  return ({ mode, x, z }) => {
    // The mass may stand a rounding short of the position that begins a window.
    const page = Math.floor((x / reach.length) * (1 + 2 * Number.EPSILON) + 1e-9);
    const start = page * reach.length;
    if (page !== shownPage) turnRuler(start);
    shownPage = page;
    const left = ROOM.left + (x - start) * scale;
    const right = left + ROOM.block;
    const length = Math.max(relaxed + z * scale, shortest);
    place(left, mode);
    stretch(right, length);
    pull.setAttribute("transform", `translate(${px(right + length)} ${level})`);
    fill(z);
  };
}

/** Lengths [m]: of a window, and of the spring the least, the most, that at a window's end. */
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

function drawGround(svg, width, ground) {
  let hatch = "";
  for (let x = 2; x < width + 8; x += 9) hatch += `M${x} ${ground + 1}l-7 7`;
  const group = draw(svg, "g", { class: "ground" });
  draw(group, "path", { class: "hatch", d: hatch });
  draw(group, "path", { d: `M0 ${ground}H${width}` });
}

/** Lines where the mass sticks, if they stand apart. */
function drawPlaces(svg, { delta_x }, scale, ground) {
  if (!(delta_x * scale > 40)) return;
  const at = (i) => px(ROOM.left + ROOM.block / 2 + i * delta_x * scale);
  let d = "";
  for (let i = 0; i <= JUMPS_SHOWN; i++) d += `M${at(i)} ${ground - ROOM.tall - 6}V${ground}`;
  draw(svg, "path", { class: "places", d });
}

/** Returns what labels the ruler for the window that starts at a position [m]. */
function drawRuler(svg, length, scale, width, ground) {
  const group = draw(svg, "g", { class: "ruler" });
  const { size, unit } = scaleFor(length, "length");
  const step = roundStep(58 / (scale * size));
  const apart = step * size * scale;
  const zero = ROOM.left + ROOM.block / 2;
  const ticks = draw(group, "path");
  const y = ground + 29;
  write(group, unit, { x: width - 6, y, class: "unit" });
  const labels = Array.from({ length: width / apart + 3 }, () => write(group, "", { y }));
  return (start) => {
    const first = Math.floor(start / (step * size) - zero / apart);
    let d = "";
    labels.forEach((label, i) => {
      const at = zero + (first + i - start / (step * size)) * apart;
      for (let j = 0; j < 5; j++) d += `M${px(at + j * apart * 0.2)} ${ground + 11}v${j ? 4 : 7}`;
      const text = String(Number(((first + i) * step).toPrecision(12)));
      const roomy = (first + i) % Math.ceil((text.length * 8) / apart) === 0;
      setText(label, roomy && at > 12 && at < width - 44 ? text : "");
      label.setAttribute("x", px(at));
    });
    ticks.setAttribute("d", d);
  };
}

/** The least of 1, 2, 5, 10, ... that is not below a number. */
function roundStep(least) {
  const decade = 10 ** Math.floor(Math.log10(least));
  return decade * [1, 2, 5, 10].find((factor) => factor * decade >= least * 0.999);
}

/** Returns what fills the gauge for a spring extension [m]. */
function drawGauge(svg, { numbers, z_s }, { low, high }, width) {
  const left = 104;
  const length = Math.max(Math.min(260, width - left - 30), 40);
  const at = (z) => left + ((z - low) / (high - low)) * length;
  const group = draw(svg, "g", { class: "gauge" });
  write(group, "spring force F", { x: 6, y: 17, class: "what" });
  draw(group, "rect", { class: "range", x: left, y: 9, width: length, height: 9 });
  const bar = draw(group, "rect", { class: "force", y: 9, height: 9 });
  if (low < 0) draw(group, "path", { class: "zero", d: `M${px(at(0))} 7v13` });
  draw(group, "path", { class: "limit", d: `M${px(at(z_s))} 5v17` });
  const half = 74;
  const middle = Math.min(Math.max(at(z_s), left + half), width - half - 4);
  const name = write(group, "break-away F", { x: px(middle), y: 33 });
  write(name, "s", { class: "index", dy: 3 }, "tspan");
  write(name, ` = ${quantity(numbers.F_s, "force")}`, { dy: -3 }, "tspan");
  return (z) => {
    put(bar, { x: px(Math.min(at(0), at(z))), width: px(Math.abs(at(z) - at(0))) });
  };
}

/** Returns what stretches the spring from a place to a length [px]. */
function drawSpring(svg, shortest, level) {
  const spring = draw(svg, "polyline", { class: "spring" });
  const lead = 6;
  const bends = 2 * Math.floor((shortest - 2 * lead) / 5.2);
  return (left, length) => {
    const pitch = (length - 2 * lead) / bends;
    let points = `${px(left)},${level} ${px(left + lead)},${level}`;
    for (let i = 0; i < bends; i++) {
      points += ` ${px(left + lead + (i + 0.5) * pitch)},${level + (i % 2 ? 9 : -9)}`;
    }
    points += ` ${px(left + length - lead)},${level} ${px(left + length)},${level}`;
    spring.setAttribute("points", points);
  };
}

function drawPull(svg, v, level) {
  const group = draw(svg, "g", { class: "pull", transform: `translate(0 ${level})` });
  draw(group, "circle", { cx: 4, r: 4 });
  draw(group, "path", { d: "M8 0H44" });
  draw(group, "path", { class: "head", d: "M54 0l-12 -5v10z" });
  const { size, unit } = scaleFor(v, "velocity");
  const speed = shortest(Number((v / size).toPrecision(4)));
  write(group, `${speed}\u00a0${unit}`, { x: 29, y: -13 });
  return group;
}

/** Returns what puts the block with its left edge at a place [px] and tells stick from slip. */
function drawMass(svg, ground) {
  const { block, tall } = ROOM;
  const group = draw(svg, "g", { class: "mass" });
  let teeth = `M4 ${ground}`;
  for (let i = 0; i < 6; i++) teeth += "l3.5 7l3.5 -7";
  draw(group, "path", { class: "teeth solid", d: `${teeth}z` });
  const trail = [12, 22, 32].map((y, i) => `M-5 ${ground - y}h${i === 1 ? -15 : -10}`);
  draw(group, "path", { class: "trail", d: trail.join("") });
  const top = ground - tall;
  draw(group, "rect", { class: "body", x: 1, y: top, width: block - 2, height: tall - 1, rx: 5 });
  const word = write(group, "", { x: block / 2, y: top + tall / 2 + 4 });
  draw(group, "path", { class: "solid", d: `M${block / 2 - 3.5} ${ground + 9}h7l-3.5 5z` });
  let shown = null;
  return (left, mode) => {
    group.setAttribute("transform", `translate(${px(left)} 0)`);
    if (mode === shown) return;
    shown = mode;
    group.setAttribute("class", mode === 0 ? "mass stick" : "mass slip");
    setText(word, mode === 0 ? "STICK" : "SLIP");
  };
}

function write(parent, text, attributes, tag = "text") {
  const written = draw(parent, tag, attributes);
  setText(written, text);
  return written;
}
