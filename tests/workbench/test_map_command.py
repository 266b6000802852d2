"""`stickslip map`: what it writes and says, and what it refuses."""

from pathlib import Path

import pytest

from tests.needs import needs
from tests.workbench.running import Command

V, K = ("--over", "v=1..900 mm/s log 12"), ("--over", "k=0.1..10 kN/m log 8")
F = ("--over", "feed=1..9 mm/s 4")
AXIS = """
[axis]
mass = "500 kg"
stiffness = "40 N/um"
c = "4 kN s/m"
[friction]
mu_s = 0.20
mu_k = 0.15
"""


@needs("studies")
def test_a_map_is_a_folder_of_dataset_picture_and_page(command: Command, tmp_path: Path) -> None:
    """Named after the friction law, and summed up in three lines."""
    answer = command("map", *V, *K, "--c", "3", "--workers", "1")
    assert (answer.code, answer.err) == (0, "")
    summed, largest, files = answer.out.splitlines()
    assert summed.startswith("96 points: sticks and slips at ")
    assert largest.startswith("largest jump ")
    assert files == ("files: coulomb-map/map.zarr, coulomb-map/map.png, coulomb-map/index.html")
    folder = tmp_path / "coulomb-map"
    assert (folder / "map.png").read_bytes().startswith(b"\x89PNG")
    assert "c = 3 N·s/m" in (folder / "index.html").read_text(encoding="utf-8")


@needs("studies")
def test_a_folder_of_another_map_is_refused_until_told(command: Command, tmp_path: Path) -> None:
    """What is there stays; --fresh throws it away."""
    again = ("map", *V, *K, "--workers", "1", "-o", "there")
    assert command(*again, "--c", "3").code == 0
    page = (tmp_path / "there" / "index.html").read_bytes()
    answer = command(*again, "--c", "4")
    assert (answer.code, answer.out) == (2, "")
    assert len(answer.err.splitlines()) == 1
    assert "c is 4" in answer.err
    assert (tmp_path / "there" / "index.html").read_bytes() == page
    assert command(*again, "--c", "4", "--fresh").code == 0
    assert (tmp_path / "there" / "index.html").read_bytes() != page


@needs("studies")
def test_an_axis_file_is_mapped_over_its_numbers(command: Command, tmp_path: Path) -> None:
    """In a folder of its name; without a feed its critical feed is the map."""
    (tmp_path / "x.toml").write_text(AXIS, encoding="utf-8")
    over = ("--over", "axis.stiffness=5..200 N/um log 6", "--over", "axis.mass=100..900 kg 4")
    answer = command("map", "x.toml", *over, "--workers", "1")
    assert (answer.code, answer.err) == (0, "")
    assert "largest critical feed " in answer.out
    assert (tmp_path / "x-map" / "map.zarr").is_dir()
    answer = command("map", "x.toml", *over, "--workers", "1", "--feed", "1 mm/s", "-o", "fed")
    assert "largest jump " in answer.out


@needs("studies")
def test_without_a_compiler_slowness_is_told_where_slips_are_followed(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once, in one line; closed forms need none."""
    from stickslip_design.points import slips

    monkeypatch.setattr(slips, "native_problem", lambda: "there is no compiler")
    monkeypatch.setattr(slips, "_warn_once", lambda: None)
    few = ("map", "--over", "v=1..9 mm/s 2", "--over", "k=1..2 kN/m 2", "--no-limit", "--workers")
    answer = command(*few, "1", "--law", "stribeck")
    assert answer.code == 0
    assert answer.err == (
        "stickslip: warning: there is no compiler; the Python block computes, some hundred times "
        "slower\n"
    )
    assert command(*few, "1").err == ""


@needs("studies", "cc")
@pytest.mark.parametrize(
    ("typed", "reason"),
    [
        ((), "--over: a map is over two parameters or more, not 0"),
        (V, "--over: a map is over two parameters or more, not 1"),
        ((*V, *V), "--over: v is given twice"),
        ((*V, "--over", "kk=1..2"), "--over: 'kk' is no parameter that can be mapped"),
        ((*V, "--over", "k=2..1 N/m"), "--over: 'k=2..1 N/m' is reversed"),
        ((*V, "--over", "k=2..2 N/m"), "--over: 'k=2..2 N/m' is empty"),
        ((*V, *K, "--v", "3 mm/s"), "--over: v is set by --v too"),
        ((*V, "--over", "v_s=1..9 mm/s", "--law", "stribeck", "--law-parameter", "v_s=3mm/s"),
         "--over: v_s is set by --law-parameter too"),
        (("x.toml", *F, "--over", "axis.mass=1..2 kg", "--feed", "1 mm/s"),
         "--over: feed is set by --feed too"),
        ((*V, "--over", "load=-20..1 N"), "load = -20.0 N is out of range"),
        ((*V, "--over", "mu_1=0.1..0.9", "--law", "stribeck", "--law-parameter", "shape=3"),
         "mu_1 = 0.9 is out of range: it must be at most mu_s = 0.5"),
        ((*V, *K, "--feed", "1 mm/s"), "--feed goes with an axis file"),
        ((*V, *K, "--law", "elsewhere:LAW"), "--law: the friction law 'elsewhere:LAW' was"),
        (("none.toml", *V, *K), "none.toml: cannot be read: no such file or directory"),
        (("x.toml", *V, *K, "--k", "3"), "--k goes with a map of the block; x.toml"),
        (("x.toml", *V, "--over", "feed=1..2"), "--over: 'v' is no parameter that can be mapped"),
        ((*V, *K, "--workers", "0"), "--workers 0: at least 1 is needed"),
        ((*V, *K, "-o", "x.toml"), "-o x.toml: it is a file; name a folder"),
        (("--over", "v=1..2 100000", "--over", "k=1..2 100000"),
         "1e+10 points are more than 10^9; --yes computes them"),
    ],
)  # fmt: skip
def test_what_cannot_be_mapped_is_refused_in_one_line(
    command: Command, tmp_path: Path, typed: tuple[str, ...], reason: str
) -> None:
    """And nothing is written."""
    (tmp_path / "x.toml").write_text(AXIS, encoding="utf-8")
    answer = command("map", *typed)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith(f"stickslip: {reason}")
    assert len(answer.err.splitlines()) == 1
    assert [each.name for each in tmp_path.iterdir()] == ["x.toml"]


def test_without_the_packages_of_studies_the_extra_is_named(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before anything is computed."""
    import sys

    monkeypatch.setitem(sys.modules, "xarray", None)
    answer = command("map", *V, *K)
    assert answer.code == 2
    assert "pip install 'stickslip[studies]'" in answer.err
    assert not list(tmp_path.iterdir())
