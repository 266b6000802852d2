"""docs/studies.md: its commands run as they stand and print what the page quotes."""

import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from examples.feed_axis.axis import Axis
from examples.feed_axis.run import write_all
from stickslip_ref import Parameters, steady_cycle
from tests.design.chunks.test_cluster import started
from tests.needs import needs
from tests.workbench.running import Command

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "studies.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"Save this as `([^`]+)`:\n\n```toml\n(.+?)```", TEXT, re.DOTALL))
ASKED = re.findall(r"```bash\nstickslip ([^\n]+)\n```(?:\n\n```\n(.+?)```)?", TEXT, re.DOTALL)
OPENED = "\n".join(re.findall(r"```python\n(import xarray.+?)```", TEXT, re.DOTALL))
PORT = "tcp://localhost:8786"

pytestmark = needs("studies")


def test_the_page_holds_what_is_run() -> None:
    """Two files and seven commands, the last of them on a cluster."""
    assert sorted(FILES) == ["plan.toml", "series.toml"]
    assert [line.split()[0] for line, _ in ASKED] == [
        "map", "map", "scatter", "scatter", "scatter", "sweep", "map"
    ]  # fmt: skip
    assert [PORT in line for line, _ in ASKED] == [*[False] * 6, True]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return the working folder of the command, with the files of the page in it."""
    design = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    (sheet,) = re.findall(r"Save this as `sheet.toml`:\n\n```toml\n(.+?)```", design, re.DOTALL)
    for name, text in {**FILES, "sheet.toml": sheet}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(("line", "quoted"), ASKED[:-1])
def test_a_command_prints_what_the_page_quotes(
    line: str, quoted: str, command: Command, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each quoted line is part of the output; the dataset opens as the page says."""
    if "FeedAxis.ssp" in line:
        write_all(folder, Axis())
    answer = command.in_fresh_process(*shlex.split(line))
    assert answer.code == 0, answer.err
    for each in quoted.splitlines():
        assert each in answer.out
    if "-o chart" in line:
        opened: dict[str, Any] = {}
        exec(OPENED, opened)
        near = opened["chart"].delta_x.sel(v=0.02, k=1000.0, method="nearest")
        exact = steady_cycle(Parameters(v=float(near.v), k=float(near.k), c=2.0)).delta_x
        assert capsys.readouterr().out.split()[:2] == [str(exact), "m"]


@needs("cluster")
def test_a_cluster_gives_the_same_chart(command: Command, folder: Path) -> None:
    """Scheduler and worker as on two terminals; the summary is that of one machine."""
    (first, quoted), (line, _) = ASKED[0], ASKED[-1]
    assert line == f"{first} --cluster {PORT}"
    (folder / "dask").mkdir()
    with started(folder / "dask") as dask:
        dask.add_worker()
        answer = command.in_fresh_process(*shlex.split(line.replace(PORT, dask.address)))
    assert answer.code == 0, answer.err
    for each in quoted.splitlines():
        assert each in answer.out
