"""The numbers in the page's texts: those of its own model, in the digits and units it shows."""

from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from stickslip.page.texts import filled
from tests.page.settings import PRESETS, START, table
from tests.page.window import Window

NUMBERS_OF_THE_PAGE = """
settings => settings.map(([each, curve]) => {
  const page = window.stickslip;
  page.set(each, curve);
  const { cycle, simplified, criticalVelocity, setting } = page;
  // The force is largest in the second slip, well after the load-up.
  const slip = page.events(0, 3 * (simplified.t_stick + cycle.T)).filter(e => e.t > 0)[2]?.t ?? 0;
  let F_max = 0;
  for (let at = 0; at <= 20000; at++) {
    F_max = Math.max(F_max, page.at(slip + (at / 20000) * (cycle.t_slip || 0)).F);
  }
  const v_c_simple = Number(document.querySelectorAll("#readout-v_c data")[1].value);
  const N = setting.m * setting.g + setting.load;
  return { ...setting, ...cycle, simple: simplified, v_c: criticalVelocity, v_c_simple, N, F_max };
})
"""

Curve = Sequence[Sequence[float]] | None
Known = Mapping[str, Mapping[str, float]]


def texts() -> Iterator[tuple[str, Known, str, Curve]]:
    """Give each text with a number, the settings it speaks of, its place in the page, its curve."""
    rows = table("story", "step")
    steps = [complete(row) for row in rows]
    for n, (row, now) in enumerate(zip(rows, steps, strict=True), 1):
        known = {"now": now, "tried": now | row.get("tried", {})}
        if "over" in row:
            known["over"] = steps[row["over"] - 1]
        for name in ("text", "try", "see"):
            yield row[name], known, f"[id='step={n}']", row.get("curve")
    for row in table("applications", "application"):
        own, entry = PRESETS[row["id"]], f"#application-{row['id']}"
        for text in (row["about"], row["source"], *row["noticed"], *row["stands"].values()):
            yield text, {"now": own}, entry, None
        for cure in row.get("cures", ()):
            known = {"now": own | cure.get("set", {}), "over": own}
            yield cure["what"], known, entry, None
            yield cure.get("button", ""), known, entry, None
    for row in table("said", "sentence"):
        now = {**START, **row["set"]}
        others = {"before": row.get("before", {}), **row.get("others", {})}
        known = {"now": now} | {name: {**now, **values} for name, values in others.items()}
        numbers = {"known": row["known"]} if "known" in row else {}
        yield row["truth"], known | numbers, f"#said-{row['id']}", row.get("curve")
    for row in table("questions", "question"):
        yield row["answer"], {"now": complete(row)}, "#questions", None


def complete(row: Mapping[str, Any]) -> dict[str, float]:
    return {**PRESETS[row.get("preset", "default")], **row.get("set", {})}


def from_page(numbers: Mapping[str, Any]) -> SimpleNamespace:
    """Make what the page computes look like the reference's numbers."""
    return SimpleNamespace(**{**numbers, "simple": SimpleNamespace(**numbers["simple"])})


def test_every_number_in_a_text_is_the_one_that_the_page_computes(window: Window) -> None:
    # The reference fills the texts when the page is assembled, the page solves each setting.
    asked = [each for each in texts() if "{" in each[0]]
    assert len(asked) > 60
    settings = [[p, curve] for _, each, _, curve in asked for n, p in each.items() if n != "known"]
    found = iter(window.js(NUMBERS_OF_THE_PAGE, settings))
    expected = []
    for text, each, where, _ in asked:
        numbers = {n: p if n == "known" else from_page(next(found)) for n, p in each.items()}
        expected.append([where, filled(text, numbers)])
    missing = window.js(
        """texts => texts.filter(([where, text]) => {
          const own = document.createElement("p");
          own.innerHTML = text;
          return !document.querySelector(where).textContent.includes(own.textContent);
        })""",
        expected,
    )
    assert missing == []
