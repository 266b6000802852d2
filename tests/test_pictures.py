"""The pictures of the documents: small, and compared by ``make docs-check``."""

import math
import re
import runpy
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from examples.feed_axis import document
from stickslip_design.claims import draw, findings, pages
from stickslip_verification.report.svg import SAME, differences

DOCS = Path(__file__).parents[1] / "docs"
PICTURES = {file.relative_to(DOCS).as_posix(): file for file in sorted(DOCS.rglob("*.svg"))}

CLAIMS = {name for name in PICTURES if name.startswith("claims/")}

MOST_BYTES = 60_000

outdated = runpy.run_path(str(DOCS / "generate.py"))["outdated"]


@pytest.fixture(scope="module")
def claims() -> Mapping[str, str]:
    """Return the plots of the claims as they are drawn now, by their names under docs/."""
    return {name: text for name, text in pages().items() if name.endswith(".svg")}


def moved(picture: Path, folder: Path, by: float) -> Path:
    """Write a picture whose longest line has one corner `by` [pt] beside the line."""
    text = picture.read_text(encoding="utf-8")
    line = max(re.findall(r'd="(M[-\d. ML]*|(?:M[\d. ]+h0)+)"', text), key=len)
    corners = list(re.finditer(r"[ML]([\d.]+) ([\d.]+)", line))
    middle = len(corners) // 2
    before, corner, after = corners[middle - 1 : middle + 2]
    x, y = (float(after[axis]) - float(before[axis]) for axis in (1, 2))
    away = by / math.hypot(x, y)
    there = f"{float(corner[1]) - away * y:.2f} {float(corner[2]) + away * x:.2f}"
    file = folder / picture.name
    other = line[: corner.start(1)] + there + line[corner.end() :]
    file.write_text(text.replace(line, other), encoding="utf-8")
    return file


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_is_small_and_dateless(name: str) -> None:
    """Each picture under docs/ has at most 60 kB and no date."""
    content = PICTURES[name].read_bytes()
    assert len(content) <= MOST_BYTES
    assert not re.search(rb"20\d\d-\d\d", content)


def test_every_picture_is_shown() -> None:
    """The documents show the pictures under docs/, and no others."""
    shown = set()
    for page in DOCS.glob("*.md"):
        shown |= set(re.findall(r"\]\(([\w/-]+\.svg)\)", page.read_text(encoding="utf-8")))
    assert shown == set(PICTURES)


def test_every_picture_is_compared(claims: Mapping[str, str]) -> None:
    """Each picture under docs/ is one that the two commands of ``make docs-check`` draw."""
    feed_axis = {f"feed-axis/{name}.svg" for name in document.PICTURES}
    assert set(PICTURES) == feed_axis | set(claims)


@pytest.mark.parametrize("name", PICTURES)
def test_a_moved_point_is_found(name: str, tmp_path: Path) -> None:
    """A corner of a line that is elsewhere is told, in every picture, and it alone."""
    drawn = PICTURES[name].read_text(encoding="utf-8")
    same = SAME if name in CLAIMS else document.PICTURES[Path(name).stem].same
    assert differences(PICTURES[name], drawn, same) == []
    assert differences(moved(PICTURES[name], tmp_path, 0.5 * same), drawn, same) == []
    (found,) = differences(moved(PICTURES[name], tmp_path, 2.0 * same), drawn, same)
    assert re.search(r", path \d+: off by [\d.]+ pt$", found)


def test_a_number_that_is_off_by_a_percent_is_found(tmp_path: Path) -> None:
    """The plot of a claim, one number of it changed by 1 %, is not the plot of the claim."""
    (finding,) = (each for each in findings() if each.id == "gap")
    (panel,) = finding.panels
    line, *others = panel.series
    middle = len(line.y) // 2
    y = (*line.y[:middle], 1.01 * line.y[middle], *line.y[middle + 1 :])
    changed = replace(finding, panels=(replace(panel, series=(replace(line, y=y), *others)),))
    file = tmp_path / "gap.svg"
    file.write_text(draw(changed), encoding="utf-8")
    assert len(differences(file, draw(finding))) == 1


def test_the_check_of_the_claims_finds_a_changed_plot(
    claims: Mapping[str, str], tmp_path: Path
) -> None:
    """``generate.py --check`` takes the plots as they are, and names one that is changed."""
    assert outdated(DOCS, claims) == []
    (tmp_path / "claims").mkdir()
    for name in claims:
        (tmp_path / name).write_bytes(PICTURES[name].read_bytes())
    changed = moved(PICTURES["claims/jump.svg"], tmp_path / "claims", 0.2)
    (tmp_path / "claims/gap.svg").unlink()
    told = outdated(tmp_path, claims)
    assert [line.split(",")[0].split(" is ")[0] for line in told] == [
        str(changed),
        str(tmp_path / "claims/gap.svg"),
    ]


def test_the_check_of_the_feed_axis_compares_its_pictures(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """``study --check`` compares every picture, and names one that is changed."""
    names = {name: PICTURES[f"feed-axis/{name}.svg"] for name in document.PICTURES}
    drawn = {name: file.read_text(encoding="utf-8") for name, file in names.items()}
    # What is run, other tests show.
    monkeypatch.setattr(document, "check_variants", lambda *_: [])
    monkeypatch.setattr(document, "check_coupling", lambda *_: [])
    monkeypatch.setattr(document, "coupling_errors", lambda _: {})
    monkeypatch.setattr(document, "pictures_of", lambda *_: drawn)
    how_to = DOCS / "feed-axis.md"
    assert document.check_document(how_to, tmp_path, lambda _: None) == []
    drawn["hunting"] = moved(names["hunting"], tmp_path, 6.0).read_text(encoding="utf-8")
    (found,) = document.check_document(how_to, tmp_path, lambda _: None)
    assert found.startswith(f"{names['hunting']}, path ")


def test_lines_that_look_alike_are_alike(tmp_path: Path) -> None:
    """The same line through other points is the same; another colour, word or mark is not."""
    svg = '<svg><title>t</title><path d="M0 0L{} 4L8 8" style="stroke: {}"/>{}</svg>'
    mark = '<path d="M3 3v2" style=""/>'
    kept = tmp_path / "kept.svg"
    kept.write_text(svg.format("4", "red", mark), encoding="utf-8")
    assert differences(kept, svg.format("4.05", "red", mark)) == []
    assert differences(kept, svg.format("4", "red", mark.replace("3 3", "3.07 3"))) == []
    for other in (
        svg.format("4.2", "red", mark),
        svg.format("4", "blue", mark),
        svg.format("4", "red", mark).replace(">t<", ">T<"),
        svg.format("4", "red", mark.replace("v2", "v3")),
        svg.format("4", "red", mark.replace("3 3", "3.1 3")),
        svg.format("4", "red", mark.replace("v2", "v2M5 3v2")),
        svg.format("4", "red", ""),
    ):
        assert len(differences(kept, other)) == 1
    kept.write_text("<svg>", encoding="utf-8")
    assert "is no SVG" in differences(kept, svg)[0]
