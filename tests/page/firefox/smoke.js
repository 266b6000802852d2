/**
 * The page in Firefox: it is opened as a file and used, and what was found is printed as JSON.
 *
 * node smoke.js FIREFOX [PAGE], with puppeteer-core beside the folder of the PATH that npx adds.
 * Without a page the browser is started, and nothing else. A check whose element is not in the page
 * gives null.
 */
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { pathToFileURL } = require("node:url");

const beside = process.env.PATH.split(path.delimiter)
  .map((folder) => path.join(folder, "..", "puppeteer-core"))
  .find((folder) => fs.existsSync(folder));
const puppeteer = require(beside);

const TYPED = [
  ["k", "2 kN/m"],
  ["v", "2 mm/min"],
  ["v", "31 mm/year"],
  ["v", "1.2345678901234567"],
  ["mu_s", "60 %"],
  ["m", "500 g"],
  ["c", "2 N.s/m"],
  ["N", "5 kN"],
  ["k", "40 N"],
];

/** What is asked for is drawn with the next frame. */
const frames = () =>
  new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));

async function setting(page) {
  await page.evaluate(frames);
  return page.evaluate("({ ...stickslip.setting })");
}

async function typeIn(page, name, text) {
  await page.focus(`#${name}`);
  await page.$eval(`#${name}`, (field) => field.select());
  await page.keyboard.type(text);
  await page.keyboard.press("Enter");
}

/** The parts of a drawing: how many, and those whose geometry is no number. */
const drawing = (svg) => {
  const parts = [...svg.querySelectorAll("*")];
  const texts = parts.flatMap((part) => [...part.attributes].map(({ value }) => value));
  const lines = [...svg.querySelectorAll("path")].map((line) => line.getAttribute("d") ?? "");
  return {
    parts: parts.length,
    longest: Math.max(0, ...lines.map((line) => line.length)),
    wrong: texts.filter((text) => /NaN|Infinity|undefined/.test(text)),
    width: svg.clientWidth,
    height: svg.clientHeight,
  };
};

/** Press every button that can be pressed, one after the other, and give what they set. */
async function pressAll(page, buttons, least = 2) {
  const set = [];
  let pressed = 0;
  await page.evaluate(() => {
    for (const fold of document.querySelectorAll("details")) fold.open = true;
  });
  // What comes into sight by that is drawn anew, with other buttons; on a busy machine later.
  const able = (wanted, count) =>
    [...document.querySelectorAll(wanted)].filter((e) => !e.disabled && e.checkVisibility()).length >=
    count;
  await page.waitForFunction(able, { timeout: 10000 }, buttons, least).catch(() => null);
  await page.evaluate(frames);
  for (const button of await page.$$(buttons)) {
    if (!(await button.evaluate((each) => !each.disabled && each.checkVisibility()))) continue;
    await button.press("Enter");
    pressed += 1;
    set.push(JSON.stringify(await setting(page)));
  }
  const text = await page.evaluate("document.body.innerText");
  return { pressed, settings: new Set(set).size, text };
}

/** Name, the element that the check is about, and what it finds. */
const CHECKS = [
  ["jump", "#readout-delta_x", (page) => page.$eval("#readout-delta_x data", (e) => e.textContent)],
  [
    "drawings",
    "#schematic",
    async (page) => [
      await page.$eval("#schematic", drawing),
      await page.$eval("#x-chart", drawing),
      await page.$eval("#F-chart", drawing),
      await page.$eval("#phase-chart", drawing),
    ],
  ],
  [
    "play",
    "#play",
    async (page) => {
      const cursor = async () => Number(await page.$eval("#scrub", (each) => each.value));
      const plays = await page.$eval("#play", (each) => each.textContent === "Pause");
      if (!plays) await page.click("#play");
      const before = await cursor();
      await page.waitForFunction(`document.querySelector("#scrub").value != ${before}`);
      await page.click("#play");
      await page.evaluate(frames);
      const stopped = await cursor();
      await new Promise((done) => setTimeout(done, 200));
      return { before, stopped, later: await cursor() };
    },
  ],
  [
    "sliders",
    "#k-slider",
    async (page) => {
      const found = {};
      for (const slider of await page.$$("#controls input[type=range]")) {
        const name = (await slider.evaluate((each) => each.id)).replace("-slider", "");
        const text = () => page.$eval("main", (each) => each.innerText);
        const [before, read] = [JSON.stringify(await setting(page)), await text()];
        await slider.focus();
        for (let n = 0; n < 5; n += 1) await page.keyboard.press("ArrowRight");
        const after = JSON.stringify(await setting(page));
        found[name] = { moved: before !== after, read: read !== (await text()) };
      }
      return found;
    },
  ],
  [
    "typed",
    "#k",
    async (page) => {
      const found = [];
      for (const [name, text] of TYPED) {
        const unit = await page.$eval(`#${name}-unit`, (each) => each.textContent);
        await typeIn(page, name, text);
        const said = await page.$eval(`#${name}-said`, (each) => each.textContent);
        found.push({ name, text, unit, said, setting: await setting(page) });
      }
      return found;
    },
  ],
  [
    "presets",
    "[data-preset]",
    async (page) => {
      const found = {};
      for (const button of await page.$$("[data-preset]")) {
        await button.click();
        const name = await button.evaluate((each) => each.dataset.preset);
        const used = await setting(page);
        found[name] = { setting: used, text: await page.evaluate("document.body.innerText") };
      }
      return found;
    },
  ],
  [
    "exports",
    "#save-csv",
    async (page) => {
      // The download itself is the browser's; what it is given is kept.
      await page.evaluate(() => {
        window.given = [];
        const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => {
          window.given.push(blob);
          return make.call(URL, blob);
        };
        HTMLAnchorElement.prototype.click = function () {
          window.given.at(-1).file = this.download;
        };
      });
      const found = [];
      for (const kind of ["csv", "svg", "png"]) {
        await page.click(`#save-${kind}`);
        await page.waitForFunction((n) => window.given[n]?.file, {}, found.length);
        found.push(
          await page.evaluate(async (n) => {
            const blob = window.given[n];
            const start = [...new Uint8Array(await blob.slice(0, 40).arrayBuffer())];
            const begins = String.fromCharCode(...start);
            return { file: blob.file, type: blob.type, size: blob.size, begins };
          }, found.length),
        );
      }
      return found;
    },
  ],
  [
    "formulas",
    "math",
    (page) =>
      page.$$eval("mfrac, mover, msub, msup", (all) =>
        all.map((each) => each.children.length).filter((count) => count !== 2),
      ),
  ],
  ["story", "#story button", (page) => pressAll(page, "#story button", 1)],
  ["said", "#said button", (page) => pressAll(page, "#said button")],
  ["cures", "#cures td button", (page) => pressAll(page, "#cures td button")],
  ["applications", "#applications button", (page) => pressAll(page, "#applications button")],
  [
    "sound",
    "#sound",
    async (page) => {
      const state = async () => page.$eval("#sound", (each) => each.getAttribute("aria-pressed"));
      const states = [await state()];
      await page.click("#sound");
      states.push(await state());
      const said = await page.$eval("#sound-said", (each) => each.textContent);
      await page.click("#sound");
      return { states: [...states, await state()], said };
    },
  ],
];

// Nobody listens there: what is asked of it shows that requests are seen.
const PLANTED = "http://127.0.0.1:47809/planted";

async function main([executablePath, file]) {
  const browser = await puppeteer.launch({
    browser: "firefox",
    executablePath,
    headless: true,
    // What moves by itself is drawn again and again.
    extraPrefsFirefox: { "ui.prefersReducedMotion": 1 },
    defaultViewport: { width: 1280, height: 800 },
  });
  const found = { errors: [], requests: [], checks: {}, version: await browser.version() };
  const open = async (name) => {
    const page = await browser.newPage();
    page.on("console", (said) => {
      if (said.type() === "error") found.errors.push(`${name}: ${said.text()}`);
    });
    page.on("pageerror", (error) => found.errors.push(`${name}: ${error.message}`));
    page.on("request", (request) => found.requests.push(request.url().slice(0, 200)));
    await page.goto(pathToFileURL(file).href);
    await page.waitForFunction("window.stickslip !== undefined");
    await page.evaluate(frames);
    return page;
  };
  try {
    for (const [name, selector, check] of file ? CHECKS : []) {
      const page = await open(name);
      found.checks[name] = (await page.$(selector)) ? await check(page) : null;
      await page.close();
    }
    if (file) {
      // Errors and requests are seen here, for these are.
      const page = await open("planted");
      await page.evaluate((url) => fetch(url).catch(() => console.error("planted")), PLANTED);
      await page.evaluate(frames);
      await page.close();
    }
  } finally {
    await browser.close();
  }
  console.log(JSON.stringify(found));
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error.message);
  process.exitCode = 1;
});
