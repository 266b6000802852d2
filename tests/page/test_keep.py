"""What a person takes along: CSV, SVG, PNG, and the command that repeats the run."""

from __future__ import annotations

import json
import re
import shlex
import struct
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.util import read_csv
from matplotlib.image import imread
from numpy.typing import NDArray

from stickslip.commands.quantities import read_values
from tests.page.browser import opened
from tests.page.settings import block, corner, presets, wide, with_damping
from tests.page.using import drawn, look, pause, set_values, setting, text_of
from tests.workbench.running import Command

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

COLUMNS = ("time", "x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "sticking", "mode")
SVG = "{http://www.w3.org/2000/svg}"
LONG = {"k": 1234.5678901234567, "v": 0.023456789012345678, "mu_s": 0.6000000000000001, "mu_k": 0.1}


@pytest.fixture
def command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Command:
    """Give the command in an empty folder; no FMU is needed here."""
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys, tmp_path / "none.fmu")


def saved(page: Page, kind: str, folder: Path) -> Path:
    """Press a button of Keep and give the file that arrives."""
    drawn(page)
    with page.expect_download() as download:
        page.click(f"#save-{kind}")
    assert download.value.suggested_filename == f"stick-slip.{kind}"
    file = folder / download.value.suggested_filename
    download.value.save_as(file)
    return file


def table(page: Page, folder: Path) -> NDArray[Any]:
    """Give the CSV file as fmpy reads it."""
    found: NDArray[Any] = read_csv(saved(page, "csv", folder))
    return found


def test_the_csv_is_what_the_charts_show(page: Page, tmp_path: Path) -> None:
    """Readable by fmpy; every number is the page's own double, over the stretch that is seen."""
    for values in ({}, LONG, presets()["fault-block"], corner("far above critical damping")):
        set_values(page, **values)
        rows = table(page, tmp_path)
        assert rows.dtype.names == COLUMNS
        view = page.evaluate("window.stickslip.view")
        assert (rows["time"][0], rows["time"][-1]) == (view["from"], view["to"])
        assert np.all(np.diff(rows["time"]) > 0.0)
        states = page.evaluate("ts => ts.map(t => window.stickslip.at(t))", rows["time"].tolist())
        for name in ("x", "x_dot", "x_pull", "z", "F", "F_friction", "mode"):
            assert rows[name].tolist() == [float(state[name]) for state in states]
        assert set(rows["F_s"]) == {page.evaluate("window.stickslip.cycle.F_s")}
        assert np.array_equal(rows["sticking"] == 1, rows["mode"] == 0)


def test_every_event_has_its_row(page: Page, tmp_path: Path) -> None:
    """Break-aways and re-sticks stand at their exact times, beside 2,000 even steps."""
    look(page, 0.0, 10.0)
    rows = table(page, tmp_path)
    events = [each["t"] for each in page.evaluate("window.stickslip.events(0, 10)")]
    assert len(events) > 60
    assert set(events) <= set(rows["time"].tolist())
    assert len(rows) == 2001 + len(events)
    page.click("#zoom-in")
    assert table(page, tmp_path)["time"][[0, -1]].tolist() == [2.5, 7.5]


def test_the_csv_is_scored_as_exact(page: Page, tmp_path: Path, command: Command) -> None:
    """`stickslip score` holds the file against the exact cycle and finds nothing to say."""
    for name in ("default", "squeaky-drawer", "machine-slideway"):
        set_values(page, **presets()[name])
        file = saved(page, "csv", tmp_path)
        options = [
            part
            for each, value in presets()[name].items()
            for part in (f"--{each.replace('_', '-')}", repr(value))
        ]
        answer = command("score", *options, file, "--json")
        assert answer.code == 0, answer.out + answer.err
        assert json.loads(answer.out)["cause"] == "exact", name


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_svg_stands_alone(
    browser: Browser, page_file: Path, tmp_path: Path, scheme: str
) -> None:
    """It is XML with both charts and the portrait, in the colours of the page, none left open."""
    with opened(browser, page_file, color_scheme=scheme) as page:
        pause(page)
        file = saved(page, "svg", tmp_path)
        root = ElementTree.parse(file).getroot()
        text = file.read_text(encoding="utf-8")
        assert root.tag == f"{SVG}svg"
        assert "var(" not in text
        paths = {each.get("class"): each.get("d") for each in root.iter(f"{SVG}path")}
        assert paths["curve force"] == page.get_attribute("#F-chart .curve.force", "d")
        masses = [
            each.get("d")
            for each in root.iter(f"{SVG}path")
            if (each.get("class") or "").startswith("curve mass")
        ]
        assert masses == [
            page.get_attribute(f"#{chart} .curve.mass", "d") for chart in ("x-chart", "phase-chart")
        ]
        wanted = {
            ".curve.mass": ("stroke", "#x-chart .curve.mass"),
            ".curve.force": ("stroke", "#F-chart .curve.force"),
            ".threshold": ("stroke", "#F-chart .threshold"),
            ".sheet": ("fill", None),
        }
        on_page = {selector: colour(page, like, name) for selector, (name, like) in wanted.items()}
        # Opened by itself, as any viewer would.
        page.goto(file.as_uri())
        for selector, (name, _) in wanted.items():
            assert colour(page, selector, name) == on_page[selector], selector
        identities = [each.get("id") for each in root.iter() if each.get("id")]
        assert len(set(identities)) == len(identities)
        width, height = (float(root.get(side) or "") for side in ("width", "height"))
        for inner in root.findall(f"{SVG}svg"):
            assert float(inner.get("y") or "") + float(inner.get("height") or "") <= height
            assert float(inner.get("width") or "") <= width


def test_the_picture_has_the_curves_of_the_setting_before(page: Page, tmp_path: Path) -> None:
    """What is compared on the page is compared in the picture: dotted, and in the same colour."""
    pause(page)
    page.evaluate("window.stickslip.compare({ k: 2000 })")
    file = saved(page, "svg", tmp_path)
    selector = "path[class='curve ghost']"
    ways = "all => all.map(each => each.getAttribute('d'))"
    on_page = page.eval_on_selector_all(selector, ways), colour(page, selector, "stroke")
    assert all(on_page[0])
    assert len(on_page[0]) == 3
    page.goto(file.as_uri())
    assert (page.eval_on_selector_all(selector, ways), colour(page, selector, "stroke")) == on_page
    assert colour(page, selector, "strokeDasharray") != "none"
    assert on_page[1] != "none"


def test_the_picture_says_of_which_setting_it_is(page: Page, tmp_path: Path) -> None:
    """Its caption has each parameter in use, SI; nothing else tells a reader of the report."""
    values = {"k": 1234.5, "v": 0.025, "mu_s": 0.55, "mu_k": 0.35}
    values |= {"m": 2.5, "g": 1.62, "load": -1.5, "c": 3.25}
    set_values(page, **values)
    root = ElementTree.parse(saved(page, "svg", tmp_path)).getroot()
    caption = " ".join(each.text or "" for each in root.findall(f"{SVG}text"))
    for name, value in values.items():
        symbol = name.replace("mu_s", "μₛ").replace("mu_k", "μₖ")
        assert re.search(rf"\b{symbol} = {value}(?![\d.])", caption), name


def colour(page: Page, selector: str | None, name: str) -> str:
    """Give a colour of an element, or of the page's paper."""
    script = "([s, n]) => getComputedStyle(document.querySelector(s))[n]"
    asked = [selector, name] if selector else ["body", "backgroundColor"]
    found: str = page.evaluate(script, asked)
    return found


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_png_is_the_picture(
    browser: Browser, page_file: Path, tmp_path: Path, scheme: str
) -> None:
    """Twice as fine as the page, on its paper, with many shades: drawn and not blank."""
    with opened(browser, page_file, color_scheme=scheme) as page:
        size = ElementTree.parse(saved(page, "svg", tmp_path)).getroot()
        file = saved(page, "png", tmp_path)
        content = file.read_bytes()
        assert content[:8] == b"\x89PNG\r\n\x1a\n"
        width, height = struct.unpack(">II", content[16:24])
        assert width == round(2 * float(size.get("width") or ""))
        assert height == round(2 * float(size.get("height") or ""))
        pixels = (imread(file)[..., :3] * 255).round().astype(int)
        assert pixels.shape == (height, width, 3)
        shades, counts = np.unique(pixels @ [1 << 16, 1 << 8, 1], return_counts=True)
        assert len(shades) > 100
        paper = [int(each) for each in colour(page, None, "")[4:-1].split(",")]
        assert pixels[0, 0].tolist() == pixels[-1, -1].tolist() == paper
        assert counts.max() < 0.9 * width * height
        for name in ("mass", "force"):
            stroke = colour(page, f".curve.{name}", "stroke")
            line = [int(each) for each in stroke[4:-1].split(",")]
            assert (np.abs(pixels - line).max(axis=2) <= 2).sum() > 500


def test_the_command_repeats_the_setting_to_the_last_bit(page: Page) -> None:
    """Read as `stickslip simulate` reads it, the line gives the page's doubles, all of them."""
    draw = Random("command line")
    chosen = [make(draw) for make in (block, with_damping, wide) for _ in range(25)]
    chosen += [LONG, {"v": 0.02 * (1 + 2.0**-52)}, {"v": 1e-9, "k": 1e18, "m": 1e18}]
    chosen += [dict(each) for each in presets().values()]
    chosen += [{"m": 2.0, "load": -19.0}, {"v": 1e-9}, {"m": 1.0, "load": 5.0 - 9.81}]
    lines = page.evaluate(
        """all => all.map(values => {
          window.stickslip.set(values);
          const { setting, view } = window.stickslip;
          return { setting, to: view.to, line: document.querySelector("#command").textContent };
        })""",
        chosen,
    )
    for each in lines:
        program, verb, *rest = shlex.split(each["line"])
        assert (program, verb) == ("stickslip", "simulate")
        options = dict(zip(rest[::2], rest[1::2], strict=True))
        stop = options.pop("--stop-time")
        assert each["to"] <= float(stop) <= 1.01 * each["to"]
        assert len(stop.partition("e")[0].replace(".", "").strip("0")) <= 3
        typed = {name[2:].replace("-", "_"): text for name, text in options.items()}
        values = read_values(typed)
        assert {name: values[name] for name in each["setting"]} == each["setting"]


def test_the_command_has_digits_that_a_person_types(page: Page) -> None:
    """Values stand in the unit that is shown, SI without one; start values are left out."""
    expected = {
        "default": "--k 1000 --v 20mm/s --mu-s 0.5 --mu-k 0.3",
        "machine-slideway": "--k 50N/um --v 1mm/s --mu-s 0.2 --mu-k 0.15 --m 500 --c 10kN.s/m",
        "violin-bow": "--k 2823 --v 200mm/s --mu-s 0.8 --mu-k 0.35 --m 100mg --load 999.019mN",
        "fault-block": "--k 3TN/m --v 31.5576mm/year --mu-s 0.6 --mu-k 0.55 --m 2.7e9t",
        "brake-pad": "--k 5N/um --v 20mm/s --mu-s 0.45 --mu-k 0.4 --m 20 --c 400 --load 4.8038kN",
        "squeaky-drawer": "--k 1N/um --v 20mm/s --mu-s 0.5 --mu-k 0.35"
        " --m 500g --c 20 --load 95.095",
        "rubber-seal": "--k 10kN/m --v 10mm/s --mu-s 0.9 --mu-k 0.6 --m 3 --c 30 --load 70.57",
    }
    for name, values in presets().items():
        set_values(page, **values)
        line, _, stop = text_of(page, "#command").partition(" --stop-time ")
        assert line == f"stickslip simulate {expected[name]}"
        assert len(stop) <= 7


def test_the_command_runs(page: Page, tmp_path: Path, command: Command) -> None:
    """Pasted into a shell, the line simulates this very run: the same motion, the same cycle."""
    set_values(page, c=2.0, k=1500.0, v=0.03)
    _, verb, *options = shlex.split(text_of(page, "#command"))
    answer = command(verb, *options, "--engine", "reference", "--output-file", "run.csv")
    assert answer.code == 0, answer.err
    jump = re.search(r"delta_x\s+mm\s+([\d.]+)", answer.out)
    assert jump
    # The command prints six digits.
    assert float(jump[1]) == pytest.approx(1e3 * page.evaluate("window.stickslip.cycle.delta_x"))
    rows = read_csv(tmp_path / "run.csv")
    states = page.evaluate("ts => ts.map(t => window.stickslip.at(t))", rows["time"].tolist())
    stop = page.evaluate("window.stickslip.view.to")
    assert stop <= rows["time"][-1] <= 1.01 * stop
    for name in ("x", "F"):
        exact = np.array([state[name] for state in states])
        # The reference integrates to 1e-10 of each cycle's scale, some 30 cycles long.
        assert np.abs(rows[name] - exact).max() <= 1e-7 * np.abs(exact).max()


def test_the_command_runs_as_long_as_what_is_seen(page: Page) -> None:
    """Another stretch of time, by a button or a script, is another stop time at once."""
    look(page, 0.0, 10.0)
    assert page.inner_text("#command").endswith(" --stop-time 10")
    page.click("#zoom-in")
    assert page.inner_text("#command").endswith(" --stop-time 7.5")


def test_the_command_is_copied(browser: Browser, page_file: Path) -> None:
    """One press puts the line on the clipboard, or selects it where there is none, and says so."""
    with opened(browser, page_file, permissions=["clipboard-read", "clipboard-write"]) as page:
        page.click("#copy")
        page.wait_for_function("document.querySelector('#keep-said').textContent === 'Copied.'")
        assert page.evaluate("navigator.clipboard.readText()") == page.inner_text("#command")
    with opened(browser, page_file) as page:
        page.evaluate("() => { navigator.clipboard.writeText = () => Promise.reject(); }")
        page.click("#copy")
        page.wait_for_function("String(getSelection()).startsWith('stickslip simulate')")
        assert "Selected" in page.inner_text("#keep-said")


def test_what_was_kept_is_said(page: Page, tmp_path: Path) -> None:
    """After each export a status line names the file, so that nobody presses twice."""
    for kind in ("csv", "svg", "png"):
        saved(page, kind, tmp_path)
        page.wait_for_function(
            "name => document.querySelector('#keep-said').textContent.includes(name)",
            arg=f"stick-slip.{kind}",
        )
    assert page.get_attribute("#keep-said", "role") == "status"
    assert setting(page)["k"] == 1000.0
