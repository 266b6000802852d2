"""docs/design.md, cures.md and seal.md: their axis files are judged as they stand there.

What a page quotes is what the command prints, and the numbers of its tables are those of the tool.
"""

import math
import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from stickslip_design.axis import Axis, axis_of, example, read_axis_file
from stickslip_design.axis.keys import KEYS
from stickslip_design.critical import critical_feed
from stickslip_design.loop.hunting import hunting
from stickslip_design.report.tables import standing
from stickslip_design.study import design
from tests.workbench.running import Command

ROOT = Path(__file__).parents[2]
AXES = ROOT / "examples" / "axes"
PAGES = {
    name: (ROOT / "docs" / f"{name}.md").read_text("utf-8") for name in ("design", "cures", "seal")
}
SAVED = re.compile(r"Save this as `([^`]+)`:\n\n```(?:toml)?\n(.+?)```", re.DOTALL)
FILES = {name: text for page in PAGES.values() for name, text in SAVED.findall(page)}
ASKED = [
    (page, command, quoted)
    for page, text in PAGES.items()
    for command, quoted in re.findall(
        r"```bash\nstickslip ([^\n]+)\n```\n\n```\n(.+?)```", text, re.DOTALL
    )
]
SECTION = {key.name: key.section for key in KEYS if key.section in ("axis", "friction", "drive")}


def test_the_pages_hold_what_is_run() -> None:
    """Three axis files and a curve, and four commands with what they print."""
    assert sorted(FILES) == ["cured.toml", "rod.toml", "seal.csv", "sheet.toml"]
    assert [command.split()[:2] for _, command, _ in ASKED] == [
        ["design", "sheet.toml"], ["design", "cured.toml"], ["design", "rod.toml"],
        ["critical", "--curve"],
    ]  # fmt: skip


@pytest.mark.parametrize(("page", "line", "quoted"), ASKED)
def test_a_command_prints_what_the_page_quotes(
    page: str, line: str, quoted: str, command: Command, tmp_path: Path
) -> None:
    """Each quoted line is part of a line of the output."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    answer = command(*shlex.split(line))
    assert answer.code == 0, answer.err
    for each in quoted.splitlines():
        assert each in answer.out, page


def changed(text: str, spans: str) -> Axis:
    """Return the axis of a file with other keys: `mu_s = 0.06`, `c = "20 kN s/m"`."""
    data: dict[str, dict[str, Any]] = tomllib.loads(text)
    for key, value in tomllib.loads("\n".join(re.findall(r"`([^`]+)`", spans))).items():
        data[SECTION[key]].pop({"F_s": "mu_s", "F_k": "mu_k", "zeta": "c"}.get(key, ""), None)
        data[SECTION[key]][key] = value
    return axis_of("".join(_sections(data)))


def _sections(data: dict[str, dict[str, Any]]) -> Iterator[str]:
    for name, table in data.items():
        yield f"[{name}]\n"
        for key, value in table.items():
            yield f"{key} = {value!r}\n"


def rows(page: str, heading: str) -> list[list[str]]:
    """Return the cells of the table of a page whose head begins with a text."""
    _, _, rest = PAGES[page].partition(f"| {heading} |")
    body = rest.partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in body]


@pytest.mark.parametrize("row", rows("cures", "cure"), ids=lambda row: row[0].strip("| "))
def test_a_cure_does_what_the_catalogue_says(row: list[str]) -> None:
    """Critical feed and hunting of the example with that cure."""
    *_, tried, limit, hunts = (cell.strip("| ") for cell in row)
    axis = changed(example(), tried)
    feed = critical_feed(axis)
    assert limit == (f"{feed * 1e3:#.3g}" if feed else "never")
    cycle = hunting(axis)
    assert axis.drive is not None
    ended = cycle is None or axis.drive.dead_band > cycle.dead_band
    assert hunts == ("no" if ended or cycle is None else f"{cycle.jump * 1e6:.1f}")


@pytest.mark.parametrize(
    "row", rows("design", "not on the sheet")[:-1], ids=lambda row: row[0].strip("| ")
)
def test_what_an_assumption_matters(row: list[str]) -> None:
    """Critical feed of the data-sheet axis with the number that was not stated."""
    feed = critical_feed(changed(FILES["sheet.toml"], row[2]))
    assert row[3] == f"{feed * 1e3:#.3g}"


def test_the_lined_guideway_behind_a_stiff_screw() -> None:
    """A table of 80 to 120 Hz on its locked motor, and screw, nut, bearings, brackets in series."""
    axis = read_axis_file(AXES / "lined_guide.toml").axis()
    assert 80.0 < math.sqrt(axis.k / axis.m) / (2.0 * math.pi) < 120.0
    in_series = 1.0 / (1.0 / 839e6 + 1.0 / 800e6 + 1.0 / 1500e6 + 1.0 / 500e6)
    assert axis.k == pytest.approx(in_series, abs=0.5e6)
    assert f"jumps up to {critical_feed(axis) * 1e3:.3g} mm/s" in PAGES["design"]


@pytest.mark.parametrize(
    ("name", "found"),
    [
        pytest.param("lined_guide", "judders", marks=pytest.mark.soak),
        ("hydrostatic_guide", "clean"),
    ],
)
def test_the_axes_of_the_examples_are_judged(name: str, found: str) -> None:
    """The lined guideway judders and hunts; the hydrostatic one does neither."""
    verdict = design(read_axis_file(AXES / f"{name}.toml"))
    assert standing(verdict).word == found
    assert (verdict.hunting is None) == (found == "clean")
