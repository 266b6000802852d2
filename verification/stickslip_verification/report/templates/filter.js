"use strict";
(() => {
  const form = document.getElementById("filter");
  const cases = [...document.querySelectorAll("details.case")].map((box) => ({
    box,
    name: ["name", "title"]
      .map((part) => box.querySelector(`summary .${part}`).textContent.toLowerCase())
      .join(" "),
    groups: [...box.querySelectorAll("tbody")],
    rows: [...box.querySelectorAll("tbody tr:not(.kind)")].map((row) => ({
      row,
      text: row.textContent.toLowerCase(),
    })),
  }));
  const headings = [...document.querySelectorAll("section.group")];
  const opened = cases.map(({ box }) => box.open);

  function apply() {
    const { failed, kind, text } = form.elements;
    const wanted = text.value.trim().toLowerCase();
    const active = failed.checked || kind.value || wanted;
    let shown = 0;
    let all = 0;
    cases.forEach(({ box, name, rows, groups }, n) => {
      let here = 0;
      for (const { row, text: words } of rows) {
        const fits =
          (!failed.checked || !row.classList.contains("pass")) &&
          (!kind.value || row.classList.contains(kind.value)) &&
          (!wanted || name.includes(wanted) || words.includes(wanted));
        row.hidden = !fits;
        here += fits ? 1 : 0;
      }
      for (const group of groups) {
        group.hidden = !group.querySelector("tr:not(.kind):not([hidden])");
      }
      box.hidden = here === 0;
      box.open = active ? here > 0 && here < 60 : opened[n];
      shown += here;
      all += rows.length;
    });
    for (const heading of headings) {
      heading.hidden = Boolean(active) && !heading.querySelector("details.case:not([hidden])");
    }
    form.querySelector("output").textContent = active ? `${shown} of ${all} shown` : "";
  }

  function openTarget() {
    const target = location.hash && document.getElementById(location.hash.slice(1));
    for (let box = target; box; box = box.parentElement) {
      if (box.tagName === "DETAILS") box.open = true;
    }
    if (target) target.scrollIntoView();
  }

  const setAll = (open) => cases.forEach(({ box }) => (box.open = open));
  let waiting = 0;
  form.addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(apply, 120);
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  form.elements.open.addEventListener("click", () => setAll(true));
  form.elements.close.addEventListener("click", () => setAll(false));
  addEventListener("hashchange", openTarget);
  form.hidden = false;
  openTarget();
})();
