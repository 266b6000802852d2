"""How-tos: their commands run as they stand and print what the page quotes."""

import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from examples.feed_axis.system import Move, build_all
from stickslip_design.axis import Axis, axis_of, example, read_axis_file
from stickslip_design.axis.keys import KEYS
from stickslip_design.critical import critical_feed
from stickslip_design.loop.rest import hunting
from stickslip_design.report.tables import standing
from stickslip_design.study import design
from stickslip_ref import Parameters, steady_cycle
from tests.design.chunks.test_cluster import started
from tests.needs import needs
from tests.workbench.running import Command

pytestmark = pytest.mark.gate
ROOT = Path(__file__).parents[2]
PAGES = {
    name: (ROOT / "docs" / f"{name}.md").read_text("utf-8")
    for name in ("design", "cures", "seal", "friction", "studies")
}
SAVED = re.compile(r"ave this as `([^`]+)`:\n\n```(?:toml)?\n(.+?)```", re.DOTALL)
FILES = {name: text for page in PAGES.values() for name, text in SAVED.findall(page)}
COMMANDS = re.compile(r"```bash\nstickslip ([^\n]+)\n```(?:\n\n```\n(.+?)```)?", re.DOTALL)
ASKED = [asked for text in PAGES.values() for asked in COMMANDS.findall(text)]
CLUSTER = "tcp://localhost:8786"
SECTION = {key.name: key.section for key in KEYS.values() if key.section != "drive.filter"}


@pytest.fixture(autouse=True)
def files(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")


def test_the_pages_hold_what_is_run() -> None:
    assert len(FILES) == 7
    assert len(ASKED) == 16


@needs("cluster", "studies")
@pytest.mark.parametrize(("line", "quoted"), ASKED, ids=[line for line, _ in ASKED])
def test_a_command_prints_what_its_page_quotes(
    line: str, quoted: str, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if "FeedAxis.ssp" in line:
        build_all(tmp_path, axis_of(example()), Move(5e-4))
    if CLUSTER in line:
        quoted = next(text for first, text in ASKED if line.startswith(f"{first} --cluster"))
        (tmp_path / "dask").mkdir()
        with started(tmp_path / "dask") as dask:
            dask.add_worker()
            line = line.replace(CLUSTER, dask.address)
            answer = command.in_fresh_process(*shlex.split(line))
    else:
        answer = command.in_fresh_process(*shlex.split(line))
    assert answer.code == 0, answer.err
    assert answer.out.strip()
    for part in quoted.splitlines():
        assert part in answer.out
    if "-o chart" in line:
        opened: dict[str, Any] = {}
        exec(
            "\n".join(re.findall(r"```python\n(import xarray.+?)```", PAGES["studies"], re.S)),
            opened,
        )
        near = opened["chart"].delta_x.sel(v=0.02, k=1000.0, method="nearest")
        exact = steady_cycle(Parameters(v=float(near.v), k=float(near.k), c=2.0)).delta_x
        assert capsys.readouterr().out.split()[:2] == [str(exact), "m"]


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
    _, _, rest = PAGES[page].partition(f"| {heading} |")
    body = rest.partition("\n\n")[0].splitlines()[2:]
    return [[cell.strip("| ") for cell in line.strip("|").split(" | ")] for line in body]


@pytest.mark.parametrize("row", rows("cures", "cure"), ids=lambda row: row[0])
def test_a_cure_does_what_the_catalogue_says(row: list[str]) -> None:
    *_, tried, limit, hunts = row
    axis = changed(example(), tried)
    feed = critical_feed(axis)
    assert limit == (f"{feed * 1e3:#.3g}" if feed else "never")
    cycle = hunting(axis)
    assert axis.drive is not None
    ended = cycle is None or axis.drive.dead_band > cycle.dead_band
    assert hunts == ("no" if ended or cycle is None else f"{cycle.jump * 1e6:.1f}")


@pytest.mark.parametrize("row", rows("design", "not on the sheet")[:-1], ids=lambda row: row[0])
def test_what_an_assumption_matters(row: list[str]) -> None:
    assert row[3] == f"{critical_feed(changed(FILES['sheet.toml'], row[2])) * 1e3:#.3g}"


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
