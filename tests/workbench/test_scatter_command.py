"""`stickslip scatter`: what it says and writes, and what it refuses."""

import json
from pathlib import Path

import pytest

from tests.needs import needs
from tests.workbench.running import Command

AXIS = """
[axis]
mass = "500 kg ± 5 %"
stiffness = "40 N/um"
zeta = "5 %"
[friction]
mu_s = "0.20 ± 10 %"
mu_k = "0.15 ± 20 %"
[demand]
feeds = ["2 mm/min", "1 mm/s"]
"""


@pytest.fixture
def axis(tmp_path: Path) -> Path:
    """Return an axis file in the working folder."""
    file = tmp_path / "axis.toml"
    file.write_text(AXIS, encoding="utf-8")
    return file


@pytest.mark.usefixtures("axis")
def test_summary_says_how_many_jump_at_each_feed_and_why(command: Command, tmp_path: Path) -> None:
    """Shares with their interval, the clamp, the number that matters, and what was solved for."""
    answer = command(
        "scatter", "axis.toml", "--vary", "friction.mu_s=normal 0.2 0.02", "--samples", "4000",
        "--indices", "256", "--correlation", "friction.mu_s,friction.mu_k=0.5",
        "--hold", "99 % at 1 mm/s", "--solve", "friction.mu_s", "--workers", "1",
    )  # fmt: skip
    assert answer.code == 0, answer.err
    lines = answer.out.splitlines()
    assert lines[0].startswith("At 2 mm/min 9")
    assert " % of machines jump (9" in lines[0]
    assert lines[1].startswith("At 1 mm/s ")
    assert "; of those half by more than " in lines[1]
    assert any(each.startswith("mu_k came above mu_s in ") for each in lines)
    assert any(each.startswith("The critical feed scatters with friction.mu") for each in lines)
    assert any("the correlation is left out" in each for each in lines)
    assert "99 % of machines run evenly at 1 mm/s with a nominal friction.mu_s of at" in lines[-1]
    assert [each.name for each in tmp_path.iterdir()] == ["axis.toml"]


@needs("studies")
@pytest.mark.usefixtures("axis")
def test_folder_has_page_picture_machines_and_summary(command: Command, tmp_path: Path) -> None:
    """The same command writes the same page again, out of the chunks that are there."""
    from stickslip_design.datasets import read_points

    typed = ("scatter", "axis.toml", "-o", "out", "--samples", "400", "--indices", "64",
             "--seed", "5", "--workers", "1")  # fmt: skip
    answer = command(*typed)
    assert answer.code == 0, answer.err
    folder = tmp_path / "out"
    written = {"scatter.html", "scatter.png", "scatter.json", "machines.parquet"}
    assert {each.name for each in folder.iterdir()} == {*written, "chunks"}
    page = (folder / "scatter.html").read_text(encoding="utf-8")
    assert page.count("<svg") == 4
    for linked in ("src=", "<link", "<script", "url(http"):
        assert linked not in page
    summary = json.loads((folder / "scatter.json").read_text(encoding="utf-8"))
    assert summary["seed"] == "5"
    assert [each["feed"] for each in summary["feeds"]] == [2e-3 / 60.0, 1e-3]
    machines = read_points(folder / "machines.parquet")
    assert machines.sizes["sample"] == 400
    assert machines["axis.mass"].attrs["units"] == "kg"
    assert machines["jump_2"].attrs == {"units": "m", "long_name": machines["jump_2"].long_name}
    assert machines.attrs["inputs_digest"] == summary["inputs_digest"]
    assert (machines["regime_1"] == 1).mean() == summary["feeds"][0]["jumps"]["value"]
    assert command(*typed).code == 0
    assert (folder / "scatter.html").read_text(encoding="utf-8") == page


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--vary", "friction.mu=normal 0.2 0.02"), "nearest: friction.mu_s, friction.mu_k"),
        (("--vary", "friction.mu_s=normal 0.2 0"), "a standard deviation that is not above 0"),
        (("--vary", "friction.mu_s=uniform 0.3..0.2"), "is empty or reversed"),
        (("--vary", "friction.mu_s=normal nan 0.02"), "is not a finite number"),
        (("--vary", "friction.mu_s"), "--vary friction.mu_s: write NAME=VALUE"),
        (("--vary", "axis.mass=fixed", "--vary", "axis.mass=± 1 %"), "axis.mass stands twice"),
        (("--correlation", "friction.mu_s,friction.mu_k=1.5"), "it must be -1 to 1"),
        (("--correlation", "friction.mu_s,friction.mu_k=nan"), "it must be -1 to 1"),
        (("--correlation", "friction.mu_s,friction.mu_k=x"), "x is no number from -1 to 1"),
        (("--correlation", "friction.mu_s=0.5"), "write NAME,NAME=VALUE"),
        (("--correlation", "friction.mu_s,axis.zeta=0.5"), "axis.zeta does not vary"),
        (("--feed", "0 mm/s"), "feed 0 mm/s is out of range"),
        (("--indices", "100"), "a power of two is needed"),
        (("--hold", "99 % at 2 mm/min"), "are given together"),
        (("--hold", "2 at 2 mm/min", "--solve", "friction.mu_s"), "a share of 2 is out of range"),
        (("--hold", "9 % at 2 mm/min", "--solve", "friction.mus"), "nearest: friction.mu_s"),
        (
            ("--vary=axis.mass=fixed", "--vary=friction.mu_s=fixed", "--vary=friction.mu_k=fixed"),
            "nothing varies",
        ),
        (("--workers", "0"), "--workers 0: at least 1 is needed"),
    ],
)
@pytest.mark.usefixtures("axis")
def test_wrong_use_is_one_line_and_writes_nothing(
    command: Command, tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    """Exit code 2, before any folder is made."""
    answer = command("scatter", "axis.toml", "-o", "out", *arguments)
    assert answer.code == 2
    assert said in answer.err
    assert answer.err.count("\n") == 1
    assert [each.name for each in tmp_path.iterdir()] == ["axis.toml"]


@needs("studies")
def test_output_that_is_a_file_is_refused(command: Command, axis: Path) -> None:
    """It stays as it is."""
    answer = command("scatter", "axis.toml", "-o", "axis.toml", "--samples", "10")
    assert answer.code == 2
    assert "axis.toml" in answer.err
    assert answer.err.count("\n") == 1
    assert axis.read_text(encoding="utf-8") == AXIS


@needs("studies")
@pytest.mark.usefixtures("axis")
def test_another_question_in_the_folder_is_refused_without_fresh(
    command: Command, tmp_path: Path
) -> None:
    """What is there stays; --fresh throws it away."""
    typed = ("scatter", "axis.toml", "-o", "out", "--samples", "50", "--indices", "0",
             "--workers", "1")  # fmt: skip
    assert command(*typed).code == 0
    before = (tmp_path / "out" / "scatter.json").read_bytes()
    answer = command(*typed, "--seed", "1")
    assert answer.code == 2
    assert "--fresh" in answer.err
    assert (tmp_path / "out" / "scatter.json").read_bytes() == before
    assert command(*typed, "--seed", "1", "--fresh").code == 0
    assert (tmp_path / "out" / "scatter.json").read_bytes() != before
