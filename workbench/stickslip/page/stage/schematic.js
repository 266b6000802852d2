/** The model as a moving picture: a mass on the ground, drawn along through a spring. */

import { draw, put, setText } from "../view/dom.js";
import { px } from "../view/frame.js";
import { brief } from "../view/units.js";
import { makeBlock, makeGround, makePlaces } from "./contact.js";
import { makeGauge, makeRuler } from "./scales.js";
import { makeScene } from "./scene.js";

/** Pixels: left of the block, for the grip with its arrow, below the ground, for gauge and caption. */
const ROOM = { left: 22, pull: 74, below: 34, gauge: 56, caption: 18 };

/** A jump is seen as one where it is this long, in heights of the drawing. */
const SEEN = 1.5;
/** How near to the end of a window a mass stands at it, in windows. */
const ROUNDING = 1e-6;

/**
 * Draw the model in an empty SVG element. What is shown depends on the setting, the stretch of time
 * and the state alone, so time may run either way. All is drawn once, and then moved.
 *
 * @returns dress(id, words): take the drawing of an application, described in words; resize(): the
 *   element has another size; arrange(motion, seen): draw a motion over a stretch of time;
 *   mark(state): put everything where a state of motion.at has it
 */
export function makeSchematic(svg) {
  const layPlaces = makePlaces(svg);
  const layGround = makeGround(svg);
  const layRuler = makeRuler(svg);
  const layGauge = makeGauge(svg);
  const laySpring = makeSpring(svg);
  const layBlock = makeBlock(svg);
  const scene = makeScene(svg);
  let mark = null;
  // The size [px]; asking the browser at every redraw would cost a layout.
  let [width, height] = [0, 0];

  function resize() {
    [width, height] = [svg.clientWidth, svg.clientHeight];
    put(svg, { viewBox: `0 0 ${width} ${height}` });
  }

  function arrange(motion, seen) {
    const layout = layoutOf(motion, seen, width, height, scene.shape());
    const { left, block, scale, shortest, base, way } = layout;
    const origin = motion.at(seen.from).x;
    layGround(layout);
    const placeMarks = layPlaces(layout, motion);
    const turnRuler = layRuler(layout, way);
    const fill = layGauge(layout, motion);
    const placeBlock = layBlock(layout, motion);
    const stretch = laySpring(layout, motion);
    scene.lay(layout);

    mark = (state) => {
      // A new window begins with a stick, but for the one that ends the view.
      const late = state.t < seen.to ? ROUNDING : -ROUNDING;
      const window = Math.max(Math.floor((state.x - origin) / way + late), 0);
      const start = origin + window * way;
      turnRuler(start);
      const at = left + (state.x - start) * scale;
      const right = at + block;
      const length = shortest + Math.max((state.z - base) * scale, 0);
      placeMarks(state, start);
      placeBlock(state, at);
      stretch(right, length);
      fill(state.z, right);
    };
  }

  return { dress: scene.dress, resize, arrange, mark: (state) => mark(state) };
}

/**
 * What the parts are placed by [px]; base, most and way are the least and the largest extension that
 * is drawn and the length of a window [m], scale is in px/m, round a part of the body's height.
 * @type {(motion: Motion, seen: Stretch, width: number, height: number, shape: DOMStringMap) => any}
 */
export function layoutOf(motion, seen, width, height, shape) {
  const [wide, high, round] = [shape.wide, shape.high, shape.round].map(Number);
  const ground = height - ROOM.below;
  const room = ground - ROOM.gauge - (width > 620 ? ROOM.caption : 0);
  const tall = Math.min(Math.max(Math.min(0.4 * height, room, width / 6 / wide), 34), 96);
  const [block, body] = [wide * tall, high * tall];
  const shortest = Math.min(Math.max(width / 22, 30), 54);
  const free = Math.max(width - ROOM.left - block - shortest - ROOM.pull, 40);
  let way = seen.way();
  let { base, most, end } = reachOf(motion, seen, way);
  // Where the picture is narrow it holds fewer jumps, so that each is seen as one.
  const stride = motion.cycle.exists ? motion.cycle.delta_x : way;
  while (way > 2.5 * stride && (free * stride) / (way + end - base) < SEEN * tall) {
    way -= stride;
    ({ base, most, end } = reachOf(motion, seen, way));
  }
  const [level, scale] = [ground - 0.5 * tall, free / (way + end - base)];
  const { left } = ROOM;
  return { width, ground, left, block, body, round, tall, level, shortest, base, most, way, scale };
}

/**
 * Extensions of the spring [m]: the least that is drawn, the most, and the one that has to find
 * room where the mass is at the end of a window, whose length is `way` [m].
 * @type {(motion: Motion, seen: Seen, way: number) => {base: number, most: number, end: number}}
 */
function reachOf({ curve, numbers, cycle, slip, z_s, z_even, first }, seen, way) {
  // Under a friction curve a slip without end may grow for some swings.
  const swings = !cycle.exists && curve ? 6 : 1;
  const duration = cycle.exists ? cycle.t_slip : (2 * Math.PI * swings) / numbers.w;
  const count = 60 * swings;
  const lengths = [z_s];
  for (let i = 1; i <= count; i++) lengths.push(z_s + slip.at((duration * i) / count).growth);
  if (!cycle.exists) lengths.push(z_even);
  const low = Math.min(...lengths);
  const most = Math.max(...lengths);
  // A spring that is always far from relaxed is drawn from somewhat below its least extension.
  const fromZero = seen.from < first || low < 0.4 * most;
  const base = fromZero ? Math.min(0, low) : low - 0.3 * (most - low);
  const jumps = way / cycle.delta_x;
  const whole = Math.abs(jumps - Math.round(jumps)) < ROUNDING;
  const end = whole ? Math.max(z_s - cycle.spring_drop, most - cycle.delta_x) : most;
  return { base, most, end };
}

/** Returns what names the speed of the pull; that returns what stretches the spring up to it [px]. */
function makeSpring(svg) {
  const spring = draw(svg, "polyline", { class: "spring force" });
  const lead = 8;
  const pull = draw(svg, "g", { class: "pull" });
  draw(pull, "use", { "data-part": "pull" });
  draw(pull, "circle", { r: 5 });
  draw(pull, "path", { d: "M5 0H48" });
  draw(pull, "path", { class: "head", d: "M60 0l-14 -6v12z" });
  const name = draw(pull, "text", { x: 31, y: -10 });
  return ({ level, shortest, tall }, { p }) => {
    setText(name, brief(p.v, "velocity"));
    const bends = 2 * Math.floor((shortest - 2 * lead) / 4.4);
    const wide = Math.min(0.2 * tall, 12);
    return (left, length) => {
      const pitch = (length - 2 * lead) / bends;
      const places = [[0, 0], [lead, 0]];
      for (let i = 0; i < bends; i++) places.push([lead + (i + 0.5) * pitch, i % 2 ? wide : -wide]);
      places.push([length - lead, 0], [length, 0]);
      put(spring, { points: places.map(([x, y]) => `${px(left + x)},${level + y}`).join(" ") });
      put(pull, { transform: `translate(${px(left + length)} ${px(level)})` });
    };
  };
}
