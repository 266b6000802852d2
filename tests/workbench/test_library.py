"""`import stickslip as ss`: what the command does, from Python."""

import inspect
import json
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from stickslip.results import Shown
from tests.needs import needs
from tests.python import python
from tests.workbench.running import Command

WRITTEN = """\
axis = {mass = "500 kg", stiffness = "40 N/um", zeta = "5 %"}
friction = {mu_s = 0.20, mu_k = 0.15}
demand = {feeds = ["2 mm/min", "1 mm/s"]}
"""
AXIS = tomllib.loads(WRITTEN)
TIME = np.arange(0.0, 8.0, 2e-3)
RECORD = {
    "t": TIME,
    "position": 0.02 * np.sin(3.0 * TIME),
    "force": 0.06 * np.cos(3.0 * TIME) * 300.0 - 90.0 * np.sin(3.0 * TIME)
    + 70.0 * np.sign(np.cos(3.0 * TIME)) + np.random.default_rng(0).normal(0.0, 1.0, TIME.size),
}  # fmt: skip
"""500 kg, 300 N s/m, 70 N."""
RESULTS: dict[str, Callable[[], Any]] = {
    "Parameters": lambda: ss.Parameters(v="5 mm/s", law="stribeck", own={"v_s": "1 mm/s"}),
    "cycle": ss.cycle,
    "critical": lambda: ss.critical(ss.Parameters(c=2, v="20 mm/s")),
    "simulate": lambda: ss.simulate(ss.Parameters(c=2), "2 s", engine="reference"),
    "identify": lambda: ss.identify(RECORD, AXIS),
    "design": lambda: ss.design(AXIS),
    "reversal": lambda: ss.reversal(AXIS, feeds=["2 m/min", 0.1], radii=[0.1]),
    "compare": lambda: ss.compare({"slow": AXIS, "fast": AXIS | {"demand": {"feeds": "1 m/s"}}}),
}


def test_texts_with_units_and_numbers_in_si_are_the_same_parameters() -> None:
    typed = ss.Parameters(v="20 mm/s", k="1 N/mm", m="500 g")
    assert typed == ss.Parameters(v=0.02, k=1000.0, m=0.5)
    assert (typed.v, typed.k, typed.mu_s) == (0.02, 1000.0, 0.5)
    assert repr(typed) == "Parameters(m='0.5 kg', k='1000 N/m', v='0.02 m/s')"


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"k": "-1 N/m"}, "k '-1 N/m': k = -1.0 N/m is out of range: it must be finite and above"),
        ({"v": "5 N"}, "v '5 N' is a force; expected a velocity in m/s"),
        ({"load": -20}, "load = -20.0 N is out of range: it must be at least -m g"),
        ({"law": "stribeck", "tau_s": 1}, "tau_s: the friction law stribeck has no tau_s"),
        ({"own": {"v_s": 1}}, "v_s: the friction law has no such parameter; it has tau_s"),
        ({"law": "none"}, "law: 'none' is no friction law"),
    ],
)
def test_parameters_refuse_what_the_block_refuses(given: dict[str, Any], reason: str) -> None:
    with pytest.raises(ss.ParameterError) as refusal:
        ss.Parameters(**given)
    assert str(refusal.value).startswith(reason)


def test_no_other_refusal_is_of_another_kind(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=r"fmi 4: the standard is 2 or 3"):
        ss.build(tmp_path, fmi=4)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"target .*: cannot make the folder"):
        ss.build(tmp_path / "file" / "new")


def test_block_reference_and_closed_form_give_one_cycle() -> None:
    p = ss.Parameters(c=2)
    exact = ss.cycle(p).exact
    for engine in ("block", "reference"):
        run = ss.simulate(p, "3 s", engine=engine)
        # The reference integrates each slip to some 1e-13 of its scale.
        assert run["T"][-1] == pytest.approx(exact.T, rel=1e-11)
        assert run["delta_x"][-1] == pytest.approx(exact.delta_x, rel=1e-11)
        assert np.all(np.diff(run["x"]) >= 0.0)


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_shows_itself_in_few_lines_and_prints_nothing(
    name: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # In a notebook rich would display a table, which the notebook then shows once more.
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    shows_itself(RESULTS[name]())
    assert capfd.readouterr() == ("", "")


def shows_itself(result: Any) -> None:
    assert 0 < len(repr(result).splitlines()) <= 12
    assert len(repr(result)) < 1000
    if isinstance(result, Shown):
        assert "<pre>" in result._repr_html_()
        json.loads(result.to_json())
        assert getattr(result.plot(), "axes", None)


@needs("studies")
def test_a_run_and_a_map_carry_their_units() -> None:
    run = RESULTS["simulate"]()
    frame = run.to_dataframe()
    assert frame.attrs["units"]["x_dot"] == "m/s"
    assert frame["x"].iloc[-1] == run["x"][-1]
    over: dict[str, Any] = {"v": "1..200 mm/s log 4", "k": [1e3, 1e4]}
    found = ss.map(over, ss.Parameters(c=2), workers=1)
    assert found.sizes == {"v": 4, "k": 2}
    assert found.delta_x.attrs["units"] == "m"
    exact = ss.cycle(ss.Parameters(c=2, v=1e-3, k=1e4)).exact
    assert float(found.delta_x.sel(v=1e-3, k=1e4)) == exact.delta_x
    assert found.stickslip.plot().axes[0].get_xlabel() == "v [mm/s]"


def test_an_axis_of_a_dictionary_is_that_of_the_file(tmp_path: Path) -> None:
    (file := tmp_path / "axis.toml").write_text(WRITTEN, encoding="utf-8")
    found = ss.design(AXIS)
    for same in (file, found.verdict.axis):
        assert found.verdict.sentence == ss.design(same).verdict.sentence
    assert found.report(tmp_path / "axis.html").read_bytes().startswith(b"<!doctype html>")


def test_numbers_of_a_record_go_into_an_axis_file_and_a_report(tmp_path: Path) -> None:
    found = ss.identify(RECORD, AXIS)
    assert found.found.number("axis.mass").value == pytest.approx(500.0, rel=0.01)
    assert ss.design(found.axis).verdict.axis.m == pytest.approx(500.0, rel=0.01)
    assert found.sentence in found.report(tmp_path / "record.html").read_text("utf-8")


def test_two_axes_on_a_circle_have_each_a_reversal_value(tmp_path: Path, command: Command) -> None:
    stiff = WRITTEN.replace("0.20", "0.15").replace(
        "= {feeds", '= {acceleration = "0.01 m/s2", feeds'
    )
    soft = stiff.replace("mass", 'name = "soft", mass').replace("40 N/um", "20 N/um")
    for name, text in (("axis", stiff), ("soft", soft)):
        (tmp_path / f"{name}.toml").write_text(text, encoding="utf-8")
    said = command.passes("reversal", "axis.toml", "--with", "soft.toml", "--json")
    found = json.loads(said)
    (name, B), (other, double) = found["B"]
    # Half the stiffness, twice the way; what swings where the command stops takes a part.
    assert (name, other) == ("axis", "soft")
    assert double == pytest.approx(2.0 * B, rel=0.02)
    # On a rigid drive nothing is fed forward.
    (circle,) = found["circles"]
    assert (circle["share"], circle["feed"], circle["radius"]) == (0.0, 1.0 / 60.0, 0.05)
    heights = [each["height"] for each in circle["glitches"]]
    # The second one reverses at 90 degrees.
    assert min(heights[1::2]) > 1.5 * max(heights[::2])
    assert ss.reversal("axis.toml", "soft.toml").circles[0].G_b == circle["G_b"]


def test_the_command_names_design_as_the_next_one(command: Command) -> None:
    table = np.column_stack(list(RECORD.values()))
    np.savetxt("record.csv", table, "%.9g", ",", header=",".join(RECORD), comments="")
    Path("axis.toml").write_text(WRITTEN, encoding="utf-8")
    asked = "identify", "record.csv", "--write"
    full = command.passes(*asked, "full.toml", "--axis", "axis.toml")
    assert "next: stickslip design full.toml" in full
    assert "are not enough for a verdict" in command.passes(*asked, "bare.toml")


def test_an_optimiser_drives_an_axis_by_its_own_numbers() -> None:
    def verdict(gap: float) -> Any:
        friction = {"mu_s": np.float64(0.15 + gap), "mu_k": np.array(0.15)}
        return ss.design(AXIS | {"friction": friction, "demand": {"feeds": ("1 mm/s",)}}).verdict

    gap = brentq(lambda gap: verdict(gap).points[0].margin - 1.0, 0.001, 0.05, xtol=1e-6)
    # On a rigid drive the critical feed goes with the gap, which is off by 1e-6 of 1e-3 at most.
    assert verdict(gap).critical_feed == pytest.approx(1e-3, rel=2e-3)


@pytest.mark.parametrize(
    ("was", "written", "reason"),
    [
        ('"500 kg"', "500.0", "axis.mass = 500.0 has no unit; expected a mass in kg, above 0"),
        ("mass", "masse", 'axis.masse = "500 kg" is an unknown key; nearest: mass'),
        ("0.20", "-0.2", "friction.mu_s = -0.2 is out of range; expected a plain number"),
    ],
)
def test_a_dictionary_is_refused_as_its_file_is(
    was: str, written: str, reason: str, tmp_path: Path
) -> None:
    text = WRITTEN.replace(was, written)
    (file := tmp_path / "axis.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=f": line [12]: {reason}") as of_file:
        ss.design(file)
    with pytest.raises(ValueError, match=f"^second: {reason}") as of_tables:
        ss.compare({"first": AXIS, "second": tomllib.loads(text)})
    assert str(of_file.value).endswith(str(of_tables.value).removeprefix("second: "))


def test_an_fmu_is_built_verified_and_reported(tmp_path: Path) -> None:
    fmu = ss.build(tmp_path)
    found = ss.verify(fmu, cases="one-step")
    assert found.passed
    assert all(row.passed for row in found.rows if row.not_applicable is None)
    assert "passed, 0 failed" in repr(found)
    assert found.report(tmp_path / "report").is_file()
    ss.simulate(stop_time="5 s", engine=fmu).write_csv(tmp_path / "run.csv")
    scored = ss.score(tmp_path / "run.csv")
    assert scored.score.cause == "exact"
    for result in (found, scored):
        shows_itself(result)


@pytest.mark.gate
@needs("studies")
def test_the_script_of_the_readme_does_what_its_commands_do(tmp_path: Path) -> None:
    (tmp_path / "axis.toml").write_text(WRITTEN, encoding="utf-8")
    tour = Path(__file__).parents[2] / "examples" / "tour.py"
    head, *lines = tour.read_text(encoding="utf-8").partition('__main__":\n')[2].splitlines()
    readme = (tour.parents[1] / "README.md").read_text(encoding="utf-8")
    assert all(line.strip() in readme for line in (head, *lines))
    done = python(tour, cwd=tmp_path)
    exact = ss.cycle(ss.Parameters(c=2)).exact.delta_x
    assert done.stdout.startswith(f"{exact!r} (Interval(low=0.0")
    for name in ("run.csv", "run.png", "axis.html", "build/StickSlip.fmu"):
        assert (tmp_path / name).is_file()


def test_a_dash_is_standard_input_and_standard_output(tmp_path: Path) -> None:
    words = ("-m", "stickslip", "design", "-", "-o", "axis.html", "--json", "-")
    done = python(*words, cwd=tmp_path, input=WRITTEN)
    assert json.loads(done.stdout)["format"] == 3
    assert (tmp_path / "axis.html").is_file()


def test_importing_the_library_imports_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "matplotlib", "fmpy", "rich", "typer", "xarray")
    code = f"import sys, stickslip; print([name for name in {heavy!r} if name in sys.modules])"
    assert python("-c", code).stdout == "[]\n"


@pytest.mark.parametrize("modules", ["stickslip, xarray", "xarray, stickslip"])
def test_a_dataset_has_its_plot_in_either_order_of_imports(modules: str) -> None:
    assert "Accessor" in python("-c", f"import {modules}; print(xarray.Dataset.stickslip)").stdout


def test_every_public_name_documents_itself() -> None:
    for name in dir(ss):
        found = getattr(ss, name)
        assert inspect.getdoc(found), name
        if inspect.isfunction(found):
            assert "Raises" in str(inspect.getdoc(found)), name
            assert inspect.signature(found).return_annotation is not inspect.Signature.empty
    assert "stickslip.library" in sys.modules
