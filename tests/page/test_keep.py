"""What a person takes along: CSV, SVG, PNG, and the command that repeats the run."""

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from random import Random
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.util import read_csv
from matplotlib.image import imread

from stickslip.commands.quantities import read_values
from tests.page.settings import CORNERS, PRESETS, START, block, wide, with_damping
from tests.page.window import Window
from tests.workbench.running import Command

COLUMNS = ("time", "x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "sticking", "mode")
SVG = "{http://www.w3.org/2000/svg}"
LONG = {"k": 1234.5678901234567, "v": 0.023456789012345678, "mu_s": 0.6000000000000001, "mu_k": 0.1}


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Command:
    """Give the command; no FMU is needed here."""
    return Command(monkeypatch, capsys, tmp_path / "none.fmu")


def test_the_csv_holds_the_doubles_of_the_page_over_what_is_seen_and_each_event(
    window: Window, tmp_path: Path
) -> None:
    for values in ({}, LONG, PRESETS["fault-block"], CORNERS["far above critical damping"]):
        window.set(**{**START, **values})
        rows = read_csv(window.save("save-csv", tmp_path))
        assert rows.dtype.names == COLUMNS
        assert (rows["time"][0], rows["time"][-1]) == window.view
        assert np.all(np.diff(rows["time"]) > 0.0)
        events = [each["t"] for each in window.js("v => stickslip.events(...v)", [*window.view])]
        assert {t for t in events if t >= window.view[0]} <= set(rows["time"].tolist())
        assert 2001 <= len(rows) <= 2001 + len(events)
        states = window.states(rows["time"].tolist())
        for name in ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode"):
            assert rows[name].tolist() == [float(state[name]) for state in states]
        assert set(rows["F_s"]) == {window.cycle["F_s"]}
        assert np.array_equal(rows["sticking"] == 1, rows["mode"] == 0)


def test_stickslip_score_finds_the_csv_exact(
    window: Window, tmp_path: Path, command: Command
) -> None:
    for name in ("default", "machine-slideway"):
        window.set(**PRESETS[name])
        values = [f"--{n.replace('_', '-')}={x!r}" for n, x in PRESETS[name].items()]
        file = window.save("save-csv", tmp_path)
        assert json.loads(command.passes("score", *values, file, "--json"))["cause"] == "exact"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_svg_and_png_are_the_pictures_in_the_colours_of_the_page(
    window: Window, tmp_path: Path, scheme: str
) -> None:
    window.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    values = {"k": 1234.5, "v": 0.025, "mu_s": 0.55, "mu_k": 0.35}
    values |= {"m": 2.5, "g": 1.62, "load": -1.5, "c": 3.25}
    window.set(**values)
    window.js("stickslip.compare({ c: 3.5 })")
    values["c"] = 3.5
    window.drawn()
    likes = ("#x-chart .curve.mass", "#F-chart .curve.force", "#x-chart .curve.ghost")
    colours = [window.style(like, "stroke") for like in likes]
    drawn = [window.part(like, "d") for like in likes]
    paper = window.style("body", "backgroundColor")
    file = window.save("save-svg", tmp_path)
    pixels = (imread(window.save("save-png", tmp_path))[..., :3] * 255).round().astype(int)
    assert window.part("#keep-said", "role") == "status"
    window.until("document.querySelector('#keep-said').textContent.includes('stick-slip.png')")

    root = ElementTree.parse(file).getroot()
    assert "var(" not in file.read_text(encoding="utf-8")
    # Nothing else tells a reader of the report of which setting it is.
    caption = " ".join(each.text or "" for each in root.findall(f"{SVG}text"))
    for name, value in values.items():
        symbol = name.replace("mu_s", "μₛ").replace("mu_k", "μₖ")
        assert re.search(rf"\b{symbol} = {value}(?![\d.])", caption), name
    width, height = (float(root.get(side) or "") for side in ("width", "height"))
    # Opened by itself, as any viewer would.
    window.page.goto(file.as_uri())
    for like, colour, path in zip(likes, colours, drawn, strict=True):
        own = like.split(" ")[1]
        assert window.style(own, "stroke") == colour
        found = window.page.locator(own).all()
        assert path in [each.get_attribute("d") for each in found]
    assert window.style(".sheet", "fill") == paper
    assert window.style(".curve.ghost", "strokeDasharray") != "none"

    # The PNG is twice as fine, on its paper, with many shades: drawn and not blank.
    assert pixels.shape == (round(2 * height), round(2 * width), 3)
    shades, counts = np.unique(pixels @ [1 << 16, 1 << 8, 1], return_counts=True)
    assert len(shades) > 100
    assert counts.max() < 0.9 * counts.sum()
    assert pixels[0, 0].tolist() == pixels[-1, -1].tolist() == rgb(paper)
    for colour in colours[:2]:
        assert (np.abs(pixels - rgb(colour)).max(axis=2) <= 2).sum() > 500


def rgb(colour: str) -> list[int]:
    return [int(each) for each in re.findall(r"\d+", colour)[:3]]


def test_the_command_repeats_the_setting_to_the_last_bit(window: Window) -> None:
    draw = Random("command line")
    kinds: list[Callable[[Random], dict[str, float]]] = [block, with_damping, wide]
    chosen = [make(draw) for make in kinds for _ in range(25)]
    chosen += [LONG, {"v": 0.02 * (1 + 2.0**-52)}, {"v": 1e-9, "k": 1e18, "m": 1e18}]
    chosen += PRESETS.values()
    chosen += [{"m": 2.0, "load": -19.0}, {"v": 1e-9}, {"m": 1.0, "load": 5.0 - 9.81}]
    lines = window.js(
        """all => all.map(values => {
          window.stickslip.set(values);
          const { setting, view } = window.stickslip;
          return [setting, view.to, document.querySelector("#command").textContent];
        })""",
        chosen,
    )
    for setting, end, line in lines:
        program, verb, *rest = shlex.split(line)
        assert (program, verb) == ("stickslip", "simulate")
        options = dict(zip(rest[::2], rest[1::2], strict=True))
        stop = options.pop("--stop-time")
        assert end <= float(stop) <= 1.01 * end
        assert len(stop.partition("e")[0].replace(".", "").strip("0")) <= 3
        values = read_values({n[2:].replace("-", "_"): text for n, text in options.items()})
        assert {name: values[name] for name in setting} == setting


def test_the_command_has_the_digits_and_units_that_a_person_types(window: Window) -> None:
    for name, line in {
        "default": "--k 1000 --v 20mm/s --mu-s 0.5 --mu-k 0.3",
        "machine-slideway": "--k 50N/um --v 1mm/s --mu-s 0.2 --mu-k 0.15 --m 500 --c 10kN.s/m",
        "violin-bow": "--k 2823 --v 200mm/s --mu-s 0.8 --mu-k 0.35 --m 100mg --load 999.019mN",
        "fault-block": "--k 3TN/m --v 31.5576mm/year --mu-s 0.6 --mu-k 0.55 --m 2.7e9t",
    }.items():
        window.set(**PRESETS[name])
        assert window.text("#command").partition(" --stop-time ")[0] == f"stickslip simulate {line}"
    window.set(**START)
    window.look(0.0, 10.0)
    assert window.text("#command").endswith(" --stop-time 10")
    window.page.click("#zoom-in")
    assert window.text("#command").endswith(" --stop-time 7.5")


def test_the_command_runs_the_motion_of_the_page(
    window: Window, tmp_path: Path, command: Command
) -> None:
    window.set(c=2.0, k=1500.0, v=0.03)
    _, *line = shlex.split(window.text("#command"))
    file = tmp_path / "run.csv"
    out = command.passes(*line, "--engine", "reference", "--output-file", file)
    jump = re.search(r"delta_x\s+mm\s+([\d.]+)", out)
    assert jump
    # The command prints six digits.
    assert float(jump[1]) == pytest.approx(1e3 * window.cycle["delta_x"], rel=1e-5)
    rows = read_csv(file)
    states = window.states(rows["time"].tolist())
    for name in ("x", "F"):
        exact = np.array([state[name] for state in states])
        # The reference integrates to 1e-10 of each cycle's scale, some 30 cycles long.
        assert np.abs(rows[name] - exact).max() <= 1e-7 * np.abs(exact).max()


def test_the_command_is_copied_or_selected_where_there_is_no_clipboard(window: Window) -> None:
    window.page.click("#copy")
    window.until("document.querySelector('#keep-said').textContent === 'Copied.'")
    assert window.js("navigator.clipboard.readText()") == window.page.inner_text("#command")
    window.js("() => { navigator.clipboard.writeText = () => Promise.reject(); }")
    window.page.click("#copy")
    window.until("String(getSelection()).startsWith('stickslip simulate')")
    assert "Selected" in window.text("#keep-said")
