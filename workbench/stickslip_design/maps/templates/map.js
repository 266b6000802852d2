"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const form = document.getElementById("controls");
const sliders = [...form.querySelectorAll("input[type=range]")];

/** Show the slice that the sliders choose. */
function show() {
  const place = sliders.reduce((before, each, n) => before * data.counts[n] + Number(each.value), 0);
  const variable = form.elements.namedItem("variable");
  const name = "value" in variable ? variable.value : variable[0].value;
  document.getElementById("picture").setAttribute("href", data.pictures[name][place]);
  document.getElementById("limit").setAttribute("d", data.limits[place]);
  document.getElementById("valid").setAttribute("d", data.valid[place]);
  const held = [];
  for (const each of sliders) {
    const label = JSON.parse(each.dataset.labels)[Number(each.value)];
    each.setAttribute("aria-valuetext", label);
    each.nextElementSibling.textContent = label;
    held.push(`${each.previousElementSibling.firstChild.textContent.trim()} = ${label}`);
  }
  for (const bar of document.querySelectorAll(".bar")) bar.hidden = bar.dataset.of !== name;
  for (const key of document.querySelectorAll(".of-value")) key.hidden = name === "regime";
  const told = data.told[place];
  document.getElementById("told").textContent = held.length ? `${held.join(", ")}: ${told}` : told;
}

form.addEventListener("input", show);
form.addEventListener("submit", (event) => event.preventDefault());
show();
