"use strict";
(() => {
  const form = document.getElementById("filter");
  const boxes = [...document.querySelectorAll("details.case")];
  const opened = boxes.map((box) => box.open);
  const shownRows = "tbody tr:not(.kind):not([hidden])";

  function apply() {
    const { failed, kind, text } = form.elements;
    const asked = text.value.trim().toLowerCase();
    const active = Boolean(failed.checked || kind.value || asked);
    const has = (part) => part.textContent.toLowerCase().includes(asked);
    const wanted = (kind.value && `.${kind.value}`) + (failed.checked ? ":not(.pass)" : "");
    boxes.forEach((box, n) => {
      const named = [...box.querySelectorAll(".name, .title")].some(has);
      for (const row of box.querySelectorAll("tbody tr:not(.kind)")) {
        row.hidden = !(row.matches(wanted || "*") && (named || has(row)));
      }
      for (const group of box.querySelectorAll("tbody")) {
        group.hidden = !group.querySelector("tr:not(.kind):not([hidden])");
      }
      const shown = box.querySelectorAll(shownRows).length;
      box.hidden = shown === 0;
      box.open = active ? shown > 0 && shown < 60 : opened[n];
    });
    for (const group of document.querySelectorAll("section.group")) {
      group.hidden = active && !group.querySelector("details:not([hidden])");
    }
    const count = (rows) => document.querySelectorAll(`.rows ${rows}`).length;
    form.querySelector("output").textContent = active
      ? `${count(shownRows)} of ${count("tbody tr:not(.kind)")} shown`
      : "";
  }

  function openTarget() {
    const target = location.hash && document.getElementById(location.hash.slice(1));
    for (let box = target; box; box = box.parentElement) {
      if (box.tagName === "DETAILS") box.open = true;
    }
    if (target) target.scrollIntoView();
  }

  let waiting = 0;
  form.addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(apply, 120);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  for (const name of ["open", "close"]) {
    form.elements[name].addEventListener("click", () => {
      for (const box of boxes) box.open = name === "open";
    });
  }
  addEventListener("hashchange", openTarget);
  form.hidden = false;
  openTarget();
})();
