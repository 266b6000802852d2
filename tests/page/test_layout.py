"""Where things stand: the story beside the stage, nothing cut off, no cell that touches another."""

import pytest

from tests.page.settings import PRESETS, table
from tests.page.window import Window

_SEEN = """() => {
  const within = element => {
    const range = document.createRange();
    range.selectNodeContents(element);
    return [...range.getClientRects()].filter(each => each.width > 0);
  };
  const seen = all => [...document.querySelectorAll(all)].filter(each => each.checkVisibility());
  const touching = [];
  for (const row of seen("tr")) for (const cell of row.cells) {
    const next = cell.nextElementSibling;
    // Cells of a narrow window stand one below the other.
    if (!next || next.offsetLeft <= cell.offsetLeft) continue;
    const [right, left] = [within(cell).map(a => a.right), within(next).map(b => b.left)];
    if (Math.min(...left) - Math.max(...right) < 6) touching.push(row.textContent.trim());
  }
  const wide = document.scrollingElement.clientWidth + 1;
  const out = seen("main *:not(svg *)").filter(each => each.getBoundingClientRect().right > wide);
  const cut = seen("svg text").filter(text => {
    const [a, b] = [text, text.ownerSVGElement].map(each => each.getBoundingClientRect());
    return a.width && (a.left < b.left - 1 || a.right > b.right + 1 || a.top < b.top - 1);
  });
  const lines = [];
  for (const text of seen("#side :is(p, li, dd, td[colspan])")) {
    const range = document.createRange();
    const walk = document.createTreeWalker(text, NodeFilter.SHOW_TEXT);
    let top = -Infinity, count = 0;
    while (walk.nextNode()) for (let n = 0; n < walk.currentNode.length; n++) {
      range.setStart(walk.currentNode, n);
      range.setEnd(walk.currentNode, n + 1);
      const box = range.getBoundingClientRect();
      if (!box.height) continue;
      if (box.top > top + 9) { lines.push(count); count = 0; top = box.top; }
      count++;
    }
    lines.push(count);
  }
  const named = all => all.map(each => each.id || each.textContent.slice(0, 60));
  return { touching, out: named(out), cut: named(cut), longest: Math.max(...lines) };
}"""


@pytest.mark.parametrize("width", [320, 390, 768, 1024, 1191, 1440, 1920])
def test_nothing_is_cut_off_and_no_cell_touches_another(window: Window, width: int) -> None:
    window.page.set_viewport_size({"width": width, "height": 900})
    window.unfold()
    for name in PRESETS:
        window.preset(name)
        found = window.js(_SEEN)
        assert found.pop("longest") <= 60
        assert found == {"touching": [], "out": [], "cut": []}, name


def test_the_story_stands_beside_the_stage_and_its_sliders(window: Window) -> None:
    window.page.set_viewport_size({"width": 1440, "height": 900})
    window.page.click("#story-start")
    for step, _ in enumerate(table("story", "step"), 1):
        window.drawn()
        stage, story = window.box("#stage"), window.box(f"[id='step={step}']")
        assert stage[0] + stage[2] < story[0]
        assert 0.0 <= story[1] < window.box("#controls")[1]
        for part in ("#stage", "#controls", "#F-chart", "#story-next"):
            _, top, _, height = window.box(part)
            assert 0.0 <= top < top + height <= 900.0, (step, part)
        window.page.evaluate("document.querySelector('#story-next').click()")
    # Beside them, and not over what comes after.
    window.page.evaluate("document.querySelector('#theory').scrollIntoView()")
    assert all(sum(window.box(part)[1::2]) <= 0.0 for part in ("#stage", "#controls", "#charts"))


def test_each_application_keeps_its_drawing_while_a_value_changes(window: Window) -> None:
    seen = []
    for name in PRESETS:
        window.preset(name)
        window.press("v", "ArrowRight")
        window.drawn()
        assert window.part("#schematic", "data-drawing") == name
        seen.append(window.js("[...document.querySelectorAll('use')].map(e => e.getBBox().width)"))
    # The block has none.
    assert sum(seen[0]) == 0.0
    assert len({*map(str, seen)}) == len(PRESETS)
    window.open("step=1")
    assert window.part("#schematic", "data-drawing") == "squeaky-drawer"
