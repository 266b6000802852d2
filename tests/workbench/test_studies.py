"""`stickslip map`, `scatter`, `sweep`, `design`, `page`, `score`: what they write and say."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.util import write_csv

import stickslip as ss
from stickslip.commands.expanded import Computing
from stickslip.commands.shared import computed
from stickslip.page.assemble import card, page
from stickslip_design import chunks
from stickslip_design.axis import example, template
from stickslip_design.datasets import need, read_grid
from stickslip_design.report import html
from stickslip_ref import Parameters, steady_cycle
from stickslip_units import number, told
from tests.design import verdicts
from tests.design.chunks.toy import Toy
from tests.needs import needs
from tests.workbench.running import Command
from tests.workbench.test_refusals import AXIS, PLAN

VK = ("--over", "v=1..900 mm/s log 12", "--over", "k=0.1..10 kN/m log 8", "--workers", "1")
SWEEP = PLAN.replace("[outputs]", "mu_s = [0.4, -1.0]\n[outputs]") + 'T = "last"\n'


@pytest.fixture(autouse=True)
def files(tmp_path: Path) -> None:
    (tmp_path / "axis.toml").write_text(AXIS, encoding="utf-8")
    (tmp_path / "plan.toml").write_text(SWEEP, encoding="utf-8")


@needs("studies")
def test_a_map_is_a_folder_of_its_own_until_thrown_away(command: Command) -> None:
    answer = command("map", *VK, "--c", "3")
    assert (answer.code, answer.err) == (0, "")
    summed, largest, names = answer.out.splitlines()
    assert summed.startswith("96 points: sticks and slips at ")
    assert largest.startswith("largest jump ")
    assert names == "files: coulomb-map/map.zarr, coulomb-map/map.png, coulomb-map/index.html"
    written = Path("coulomb-map", "index.html")
    before = written.read_text(encoding="utf-8")
    assert "c = 3 N·s/m" in before
    assert 'now "c": 4' in command.refuses("map", *VK, "--c", "4")
    command.passes("map", *VK, "--c", "4", "--fresh")
    assert written.read_text(encoding="utf-8") != before


@needs("studies")
def test_an_axis_file_is_mapped_over_its_numbers(command: Command) -> None:
    # Without a feed the map is of the critical feed.
    Path("axis.toml").write_text(AXIS.partition("[demand]")[0], encoding="utf-8")
    over = ("--over", "axis.stiffness=5..200 N/um log 6", "--over", "axis.mass=100..900 kg 4")
    assert "largest critical feed " in command.passes("map", "axis.toml", *over, "--workers", "1")
    assert Path("axis-map", "map.zarr").is_dir()
    fed = (*over, "--workers", "1", "--feed", "1 mm/s", "-o", "fed")
    assert "largest jump " in command.passes("map", "axis.toml", *fed)


@needs("studies")
@pytest.mark.filterwarnings("default::stickslip_design.points.slips.SlowCoreWarning")
def test_slowness_without_a_compiler_is_told_once_where_slips_are_followed(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    from stickslip_design.points import slips

    monkeypatch.setattr(slips, "native_problem", lambda: "there is no compiler")
    slips._warn_once.cache_clear()
    few = ("--over", "v=1..9 mm/s 2", "--over", "k=1..2 kN/m 2", "--no-limit", "--workers", "1")
    answer = command("map", *few, "--law", "stribeck")
    assert answer.code == 0
    warning = "there is no compiler; the Python block computes, some hundred times slower"
    assert answer.err == f"stickslip: warning: {warning}\n"
    assert command("map", *few).err == ""


def test_a_scatter_says_how_many_jump_at_each_feed_and_why(
    command: Command, tmp_path: Path
) -> None:
    lines = command.passes(
        "scatter", "axis.toml", "--vary", "friction.mu_s=normal 0.2 0.02", "--samples", "4000",
        "--indices", "256", "--correlation", "friction.mu_s,friction.mu_k=0.5",
        "--hold", "99 % at 1 mm/s", "--solve", "friction.mu_s", "--workers", "1",
    ).splitlines()  # fmt: skip
    assert lines[0].startswith("At 2 mm/min 9")
    assert " % of machines jump (9" in lines[0]
    assert lines[1].startswith("At 1 mm/s ")
    assert "; of those half by more than " in lines[1]
    assert any(line.startswith("mu_k came above mu_s in ") for line in lines)
    assert any(line.startswith("The critical feed scatters with friction.mu") for line in lines)
    assert any("the correlation is left out" in line for line in lines)
    assert "99 % of machines run evenly at 1 mm/s with a nominal friction.mu_s of at" in lines[-1]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["axis.toml", "plan.toml"]


@pytest.mark.gate
@needs("studies")
def test_a_scatter_writes_page_picture_machines_and_summary_once(command: Command) -> None:
    typed = ("scatter", "axis.toml", "-o", "out", "--samples", "400", "--indices", "64",
             "--seed", "5", "--workers", "1")  # fmt: skip
    command.passes(*typed)
    folder = Path("out")
    written = {"scatter.html", "scatter.png", "scatter.json", "machines.parquet", "chunks"}
    assert {file.name for file in folder.iterdir()} == written
    text = (folder / "scatter.html").read_text(encoding="utf-8")
    assert text.count("<svg") == 4
    assert not any(linked in text for linked in ("src=", "<link", "<script", "url(http"))
    summary = json.loads((folder / "scatter.json").read_text(encoding="utf-8"))
    assert summary["seed"] == "5"
    assert [entry["feed"] for entry in summary["feeds"]] == [2e-3 / 60.0, 1e-3]
    machines = need("pandas").read_parquet(folder / "machines.parquet")
    assert len(machines) == 400
    assert machines.attrs["units"].items() >= {"axis.mass": "kg", "jump_2": "m"}.items()
    assert machines.attrs["inputs_digest"] == summary["inputs_digest"]
    assert (machines["regime_1"] == 1).mean() == summary["feeds"][0]["jumps"]["value"]
    command.passes(*typed)
    assert (folder / "scatter.html").read_text(encoding="utf-8") == text
    assert "--fresh" in command.refuses(*typed[:-3], "1", "--workers", "1")
    command.passes(*typed[:-3], "1", "--workers", "1", "--fresh")
    assert json.loads((folder / "scatter.json").read_text(encoding="utf-8"))["seed"] == "1"


@needs("studies")
def test_a_swept_grid_is_zarr_with_its_failures(command: Command, fmu_path: Path) -> None:
    sweep = ("sweep", fmu_path, "plan.toml", "-o", "out", "--workers", 1)
    answer = command(*sweep)
    assert (answer.code, answer.err) == (0, "stickslip: written: out/sweep.zarr\n")
    assert all(part in answer.out for part in ("6 runs, 3 failed", "3 x ", "mu_s = -1.0"))
    found = read_grid("out/sweep.zarr").load()
    exact = steady_cycle(Parameters(k=found["k"].values, mu_s=0.4))
    # Rounding of a few cycles.
    assert found["delta_x"].sel(mu_s=0.4).values == pytest.approx(exact.delta_x, rel=1e-12)
    assert found["delta_x"].attrs["units"] == "m"
    assert found["delta_x"].sel(mu_s=-1.0).isnull().all()
    assert "mu_s" in str(found["failure"].sel(mu_s=-1.0).values[0])
    assert "sweep" in found.attrs["command"]
    assert command(*sweep).code == 0
    Path("plan.toml").write_text(SWEEP.replace("0.4", "0.45"), encoding="utf-8")
    assert "--fresh" in command.refuses(*sweep)
    assert command(*sweep, "--fresh").code == 0


@needs("studies")
def test_swept_points_are_parquet_in_the_order_of_their_table(
    command: Command, fmu_path: Path
) -> None:
    Path("points.csv").write_text("k [N/mm], mu_s\n1, 0.5\n2, 0.6\n", encoding="utf-8")
    head, _, outputs = SWEEP.partition("[parameters]")
    text = head + 'points = "points.csv"\n' + outputs[outputs.index("[outputs]") :]
    Path("plan.toml").write_text(text, encoding="utf-8")
    command.passes("sweep", fmu_path, "plan.toml", "-o", "out", "--workers", 1)
    found = need("pandas").read_parquet("out/sweep.parquet")
    assert found["k"].values.tolist() == [1000.0, 2000.0]
    exact = steady_cycle(Parameters(k=found["k"].values, mu_s=found["mu_s"].values))
    assert found["T"].values == pytest.approx(exact.T, rel=1e-12)
    assert found.attrs["units"]["T"] == "s"


def test_a_template_of_a_sweep_is_printed_or_written(command: Command, fmu_path: Path) -> None:
    answer = command("sweep", fmu_path, "new.toml", "--template")
    assert (answer.code, answer.out) == (0, "written: new.toml\n")
    text = Path("new.toml").read_text(encoding="utf-8")
    assert 'x = "last"' in text
    assert command.passes("sweep", fmu_path, "--template") == text


def test_more_than_a_billion_points_are_computed_if_that_is_meant_and_a_note_is_told_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = []

    def run(study: Toy, *_: object, progress: Any, **__: object) -> None:
        asked.append(study.count)
        for done in range(3):
            progress(chunks.Progress(done, 9, 0, 1.0, note="no workers: waiting"))

    monkeypatch.setattr(chunks, "run", run)
    computed(Toy(10**9 + 1), None, Computing(yes=True), "Computing")
    assert asked == [10**9 + 1]
    assert capsys.readouterr().err == "stickslip: no workers: waiting\n"


@pytest.fixture
def studied(monkeypatch: pytest.MonkeyPatch) -> None:
    one, *_ = verdicts.rigid().cures
    cures = (
        replace(one, name="stiffer", held="c held"),
        replace(one, name="stiffer", held="zeta held"),
        replace(one, name="lighter", held="", then=None, note="not by a factor of 30"),
    )
    verdict = replace(verdicts.rigid(), cures=cures)
    monkeypatch.setattr("stickslip_design.study.design", lambda _, **named: verdict)


@pytest.mark.usefixtures("studied")
def test_a_design_is_a_summary_a_report_and_json(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = command.passes("design", "axis.toml", "--json", "axis.json")
    lines = out.splitlines()
    assert lines[:2] == ["rigid: judders", verdicts.rigid().sentence]
    assert "critical feed: 3.41 mm/s (204 mm/min)" in out
    assert lines[-1] == "report: axis.html, axis.json"
    written = Path("axis.html").read_text(encoding="utf-8")
    assert all(words in written for words in ("c held", "zeta held", "not by a factor of 30"))
    assert written[:500] == html(verdicts.rigid())[:500]
    found = json.loads(Path("axis.json").read_text(encoding="utf-8"), parse_constant=str)
    expected = ("judders", verdicts.rigid().critical_feed)
    assert (found["standing"], found["critical_feed"]) == expected
    # A report that cannot be made leaves the old one.
    monkeypatch.setattr("stickslip_design.report.page.plain", lambda verdict: 1 / 0)
    assert command("design", "axis.toml", "--json", "other.json").code == 70
    assert Path("axis.html").read_text(encoding="utf-8") == written
    assert not Path("other.json").exists()


def test_variants_side_by_side_are_what_differs_then_the_verdict_on_each(command: Command) -> None:
    text = example().partition("[drive]")[0] + '[demand]\nfeeds = ["30 mm/min", "4 mm/s"]\n'
    Path("a.toml").write_text(text, encoding="utf-8")
    text = text.replace('"500 kg"', '"0.25 t"').replace('"4 mm/s"', '"40 mm/s"')
    Path("b.toml").write_text(text.replace("mu_s = 0.20", "mu_s = 0.15"), encoding="utf-8")
    out = command.passes("design", "--compare", "a.toml", "b.toml", "--json", "both.json")
    head, *rows = [re.split(r" {2,}", line.strip()) for line in out.splitlines() if line.strip()]
    assert head == ["a.toml", "b.toml"]
    shown = {row[0]: row[1:] for row in rows if len(row) == 3}
    derived = ("damping ratio, drive held fast", "break-away force, kinetic friction")
    asked = [f"margin at {feed}" for feed in ("30 mm/min", "4 mm/s", "40 mm/s")]
    answers = ["verdict", "critical feed", *asked, "at a target", "measure"]
    assert [*shown] == ["mass", derived[0], "mu_s", derived[1], *answers]
    assert shown["mass"] == ["500 kg", "250 kg"]
    assert shown["verdict"] == ["judders", "clean"]
    verdict = ss.design("a.toml").verdict
    assert shown["critical feed"] == [told(verdict.critical_feed, "m/s"), "never jumps"]
    assert shown[asked[1]] == [number(verdict.points[1].margin), "–"]
    assert verdict.best is not None
    assert shown["measure"] == [f"{verdict.best.name} ({verdict.best.effort})", "–"]
    found = json.loads(Path("both.json").read_text(encoding="utf-8"))
    assert found["a.toml"]["critical_feed"] == verdict.critical_feed
    assert not Path("a.html").exists()


@pytest.mark.parametrize(
    ("which", "text"),
    [
        (("--template",), template()), (("--template", "--kind", "belt"), template("belt")),
        (("--template", "--kind", "rotary"), template("rotary")), (("--example",), example()),
    ],
)  # fmt: skip
def test_an_axis_file_to_begin_with(command: Command, which: tuple[str, ...], text: str) -> None:
    assert command.passes("design", *which) == text
    told = command.passes("design", *which, "new.toml")
    assert told == "written: new.toml; next: stickslip design new.toml\n"
    assert Path("new.toml").read_text(encoding="utf-8") == text


def test_the_page_is_one_file_that_begins_where_the_person_says(
    command: Command, tmp_path: Path
) -> None:
    told = command.passes("page", "-o", "a.html")
    content = Path("a.html").read_bytes()
    assert (told.split(), content.decode()) == (["a.html", str(len(content)), "bytes"], page())
    where = "https://a.org/b/stick-slip.html"
    command.passes("page", "--v", "5mm/s", "--k", "2 kN/m", "--address", where)
    text = Path("stick-slip.html").read_text(encoding="utf-8")
    assert '"setting":{"k":2000.0,"v":0.005}' in text
    assert 'content="https://a.org/b/card.png"' in text
    assert Path("card.png").read_bytes() == card()


@pytest.mark.parametrize("opens", [True, False])
def test_explore_opens_the_page_or_says_where_it_is(
    command: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, opens: bool
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    opened: list[str] = []

    def open_(address: str) -> bool:
        opened.append(address)
        return opens

    monkeypatch.setattr("webbrowser.open", open_)
    answer = command("explore", "--v", "5mm/s")
    file = Path(answer.out.strip())
    assert answer.code == (0 if opens else 1)
    assert opened == [file.as_uri()]
    assert '"setting":{"v":0.005}' in file.read_text(encoding="utf-8")
    assert opens or "no browser" in answer.err


def test_an_exact_curve_is_scored_exact_and_not_against_other_parameters(
    command: Command, fmu_path: Path
) -> None:
    result = fmpy.simulate_fmu(
        str(fmu_path), stop_time=3.0, output_interval=0.01, output=["x", "x_dot", "F"]
    )
    write_csv("curve.csv", result)
    told = command.passes("score", "curve.csv", "--k", "1000", "--v", "20mm/s")
    assert all(word in told for word in ("period", "stick", "slip", "jump", "resolution", "exact"))
    score = json.loads(command.passes("score", "curve.csv", "--json"))
    assert score["cause"] == "exact"
    for name in ("period", "t_stick", "t_slip", "delta_x"):
        assert abs(score[name]["error"]) <= score[name]["resolution"]
    assert score["period"]["exact"] == pytest.approx(0.3152, abs=1e-4)
    other = json.loads(command.passes("score", "curve.csv", "--k", "1010", "--json"))
    assert other["cause"] != "exact"
