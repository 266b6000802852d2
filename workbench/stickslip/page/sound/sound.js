/** The velocity of the mass as a sound: a tone of its pitch, or a thud at each slip. */

import { harmonicsOfMotion } from "../model/harmonics.js";
import { byId, on, put, setText } from "../view/dom.js";
import { quantity, scaleFor } from "../view/units.js";

/** What can be heard as a tone [Hz]; below, each slip is a thud, if one comes in time [s]. */
const LOWEST_TONE = 20;
const HIGHEST_TONE = 2e4;
const PATIENCE = 30;

/** Effective value and greatest value of a sound, full scale being 1. */
const LOUDNESS = 0.1;
const PEAK = 0.8;

/** A sound grows and fades in this time, and follows a slider as often [s]. */
const FADE = 0.05;

/** A thud: pitch [Hz], decay and length [s], and the samples [Hz] that are enough for it. */
const THUD = { pitch: 70, decay: 0.025, length: 0.15, rate: 8000 };

const NOTES = ["c", "c♯", "d", "d♯", "e", "f", "f♯", "g", "g♯", "a", "a♯", "b"];

/**
 * Bring the button to life; nothing sounds before it is pressed. show(): let the sound follow;
 * record(seconds): its samples at 48 kHz.
 * @param {Page} page
 */
export function makeSound(page) {
  const button = byId("sound");
  let context = null;
  let fade = null;
  let waiting = 0;
  const isOn = () => button.getAttribute("aria-pressed") === "true";

  function play() {
    waiting = 0;
    fade?.();
    fade = null;
    if (!isOn()) return setText(byId("sound-said"), "");
    const { motion } = page.solution();
    setText(byId("sound-said"), context ? inSound(motion.cycle) : "This browser plays no sound.");
    if (context) fade = sounding(context, motion);
  }

  /** A page that is not seen is not heard. */
  function hush() {
    if (!context) return;
    if (isOn() && !document.hidden) context.resume();
    else context.suspend();
  }

  on(button, "click", () => {
    put(button, { "aria-pressed": !isOn() });
    if (typeof AudioContext === "function") context ??= new AudioContext();
    play();
    // The last of it fades before the device rests.
    if (isOn()) hush();
    else setTimeout(hush, 4000 * FADE);
  });
  on(document, "visibilitychange", hush);
  on(window, "pagehide", () => context?.suspend());

  return {
    show() {
      if (isOn()) waiting ||= setTimeout(play, 1000 * FADE);
    },
    async record(seconds) {
      const offline = new OfflineAudioContext(1, seconds * 48000, 48000);
      sounding(offline, page.solution().motion);
      return (await offline.startRendering()).getChannelData(0);
    },
  };
}

/**
 * Let a motion sound; returns what lets it fade, or null where there is nothing to hear.
 * @type {(context: BaseAudioContext, motion: Motion) => (() => void) | null}
 */
function sounding(context, motion) {
  const { cycle } = motion;
  if (!(cycle.f * PATIENCE >= 1 && cycle.f <= HIGHEST_TONE)) return null;
  const { source, level } = cycle.f < LOWEST_TONE ? thuds(context, cycle) : tone(context, motion);
  const gain = context.createGain();
  const start = context.currentTime;
  gain.gain.setValueAtTime(0, start);
  gain.gain.linearRampToValueAtTime(level, start + FADE);
  source.connect(gain).connect(context.destination);
  source.start(start);
  return () => {
    const now = context.currentTime;
    gain.gain.setTargetAtTime(0, now, FADE / 4);
    source.stop(now + 2 * FADE);
  };
}

/** The velocity as a periodic wave. */
function tone(context, motion) {
  const { f, x_dot_peak } = motion.cycle;
  const { cosines, sines } = harmonicsOfMotion(motion, Math.floor(HIGHEST_TONE / f));
  const source = context.createOscillator();
  source.frequency.value = f;
  source.setPeriodicWave(
    context.createPeriodicWave(cosines, sines, { disableNormalization: true }),
  );
  const square = cosines.reduce((sum, each, n) => sum + (n && each ** 2 + sines[n] ** 2), 0);
  const peak = Math.max(x_dot_peak - motion.p.v, motion.p.v);
  return { source, level: Math.min(LOUDNESS / Math.sqrt(square / 2), PEAK / peak) };
}

/** A period of silence with a thud at its start, again and again. */
function thuds(context, { T }) {
  const { pitch, decay, length, rate } = THUD;
  const buffer = context.createBuffer(1, Math.round(T * rate), rate);
  const samples = buffer.getChannelData(0);
  const end = Math.min(length * rate, samples.length);
  for (let n = 0; n < end; n++) {
    const t = n / rate;
    samples[n] = Math.sin(2 * Math.PI * pitch * t) * Math.exp(-t / decay) * (1 - n / end);
  }
  const source = context.createBufferSource();
  source.buffer = buffer;
  source.loop = true;
  // The period is no whole number of samples.
  source.playbackRate.value = buffer.duration / T;
  return { source, level: PEAK };
}

/** @type {(cycle: Cycle) => string} what is heard of a cycle, in words */
function inSound({ exists, f, T }) {
  if (!exists) return "Steady sliding makes no periodic sound.";
  if (f > HIGHEST_TONE) return `Silent: ${quantity(f, "frequency")} is above hearing.`;
  if (f * PATIENCE < 1) {
    const { size, unit } = scaleFor(T, "time");
    return `Silent: one slip in ${Number((T / size).toPrecision(2))} ${unit}.`;
  }
  if (f < LOWEST_TONE) return `A thud at each slip, every ${quantity(T, "time")}.`;
  return `A tone of ${quantity(f, "frequency")}, close to ${noteOf(f)}.`;
}

/** The nearest note of equal temperament, a′ being 440 Hz, in both ways of writing it. */
function noteOf(f) {
  const key = Math.round(12 * Math.log2(f / 440)) + 57;
  const octave = Math.floor(key / 12);
  const name = NOTES[key - 12 * octave];
  const upper = name[0].toUpperCase() + name.slice(1);
  const old = octave < 3 ? upper + ",".repeat(2 - octave) : name + "′".repeat(octave - 3);
  return `${old} (${upper}${octave})`;
}
