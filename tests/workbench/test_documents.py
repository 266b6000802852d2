"""How-tos: their commands run as they stand and print what the page quotes."""

import re
import shlex
import tomllib
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from examples.feed_axis.__main__ import build_all
from stickslip import reversal
from stickslip.systems import Move
from stickslip_design.axis import Axis, axis_file_of, example, read_axis_file
from stickslip_design.axis.keys import KEYS
from stickslip_design.loop.critical import critical_feed
from stickslip_design.report.tables import standing
from stickslip_design.study import design
from stickslip_ref import Parameters, steady_cycle
from tests.design.chunks.test_cluster import started
from tests.needs import needs
from tests.python import python

pytestmark = pytest.mark.gate
ROOT = Path(__file__).parents[2]
DOORS = [f"start/{door}" for door in ("simulator", "axis", "judge", "learn")]
PAGES = {
    name: (ROOT / "docs" / f"{name}.md").read_text("utf-8")
    for name in ("identify", "design", "reversal", "cures", "seal", "friction", "studies", *DOORS)
}
SAVED = re.compile(r"ave this as `([^`]+)`:\n\n```(?:toml)?\n(.+?)```", re.DOTALL)
FILES = {name: text for page in PAGES.values() for name, text in SAVED.findall(page)}
COMMANDS = re.compile(r"```bash\n((?:(?:stickslip|fmpy) [^\n]+\n)+)```(?:\n\n```\n(.+?)```)?", re.S)
ASKED = [asked for text in PAGES.values() for asked in COMMANDS.findall(text)]
CLUSTER = "tcp://localhost:8786"
SECTION = {key.name: key.section for key in KEYS.values() if key.section != "drive.filter"}


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")


def test_the_pages_hold_what_is_run() -> None:
    assert len(FILES) == 8
    assert len(ASKED) == 24


@needs("cluster", "studies")
@pytest.mark.parametrize(("lines", "quoted"), ASKED, ids=[lines for lines, _ in ASKED])
def test_commands_print_what_their_page_quotes(
    lines: str, quoted: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if "FeedAxis.ssp" in lines:
        build_all(tmp_path, axis_file_of(example()).axis(), Move(5e-4))
    if "record.csv" in lines:
        python("-c", re.findall(r"```python\n(.+?)```", PAGES["identify"], re.S)[0])
    with ExitStack() as stack:
        if CLUSTER in lines:
            quoted = next(text for first, text in ASKED if lines.startswith(f"{first[:-1]} --cl"))
            (tmp_path / "dask").mkdir()
            dask = stack.enter_context(started(tmp_path / "dask"))
            dask.add_worker()
            lines = lines.replace(CLUSTER, dask.address)
        printed = [
            python("-m", *shlex.split(line), timeout=600).stdout for line in lines.splitlines()
        ]
    assert printed[-1].strip()
    if "--write measured.toml" in lines:
        printed.append((tmp_path / "measured.toml").read_text("utf-8"))
    assert all(part in "".join(printed) for part in quoted.splitlines())
    if "-o chart" in lines:
        opened: dict[str, Any] = {}
        code = re.findall(r"```python\n(import xarray.+?)```", PAGES["studies"], re.S)
        exec("\n".join(code), opened)
        near = opened["chart"].delta_x.sel(v=0.02, k=1000.0, method="nearest")
        exact = steady_cycle(Parameters(v=float(near.v), k=float(near.k), c=2.0)).delta_x
        assert capsys.readouterr().out.split()[:2] == [str(exact), "m"]


def changed(text: str, spans: str) -> Axis:
    """Return the axis of a file with other keys: `mu_s = 0.06`, `c = "20 kN s/m"`."""
    data: dict[str, dict[str, Any]] = tomllib.loads(text)
    for key, value in tomllib.loads("\n".join(re.findall(r"`([^`]+)`", spans))).items():
        data[SECTION[key]].pop({"F_s": "mu_s", "F_k": "mu_k", "zeta": "c"}.get(key, ""), None)
        data[SECTION[key]][key] = value
    return axis_file_of("".join(_sections(data))).axis()


def _sections(data: dict[str, dict[str, Any]]) -> Iterator[str]:
    for name, table in data.items():
        yield f"[{name}]\n"
        for key, value in table.items():
            yield f"{key} = {value!r}\n"


def rows(page: str, heading: str) -> list[list[str]]:
    _, _, rest = PAGES[page].partition(f"| {heading} |")
    body = rest.partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip("| ") for cell in line.strip("|").split(" | ")] for line in body]


@pytest.mark.parametrize("row", rows("design", "not on the sheet")[:-1], ids=lambda row: row[0])
def test_what_an_assumption_matters(row: list[str]) -> None:
    assert row[3] == f"{critical_feed(changed(FILES['sheet.toml'], row[2])) * 1e3:#.3g}"


@pytest.mark.parametrize("row", rows("reversal", "changed"), ids=lambda row: row[0])
def test_what_moves_the_glitch(row: list[str]) -> None:
    data: dict[str, dict[str, Any]] = tomllib.loads(FILES["circle.toml"])
    for key, value in tomllib.loads("\n".join(re.findall(r"`([^`]+)`", row[0]))).items():
        next(table for table in data.values() if key in table)[key] = value
    without, with_it = reversal(data).circles
    found = without.glitch.height * 1e6, without.glitch.width * 1e3, with_it.G_b * 1e6
    # As the page rounds them.
    assert [float(cell) for cell in row[1:]] == pytest.approx(found, rel=5e-3)


@pytest.mark.parametrize(
    ("name", "found"),
    [
        pytest.param("lined_guide", "judders", marks=pytest.mark.soak),
        ("hydrostatic_guide", "clean"),
    ],
)
def test_the_axes_of_the_examples_are_judged(name: str, found: str) -> None:
    verdict = design(read_axis_file(ROOT / "examples" / "axes" / f"{name}.toml"))
    assert standing(verdict).word == found
    assert (verdict.hunting is None) == (found == "clean")
