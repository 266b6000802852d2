"""The page in Firefox: pictures, sliders, units, motion, exports and sections, by one smoke run."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from stickslip.errors import CommandError
from stickslip.units import parse
from tests.needs import PUPPETEER, SMOKE, firefox, needs
from tests.page.settings import presets
from tests.page.using import SI

pytestmark = needs("firefox")

# Nobody listens there; Firefox itself blocks the well-known ports, and such a request goes unseen.
PLANTED = "http://127.0.0.1:47809/planted"
PICTURES = ("schematic", "x-chart", "F-chart", "phase-chart")


@pytest.fixture(scope="module")
def found(page_file: Path) -> dict[str, Any]:
    """Give what one run of the script in Firefox has found."""
    done = subprocess.run(
        [*PUPPETEER, str(SMOKE), firefox(), str(page_file)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    assert answer["version"].startswith("firefox/")
    return answer


@pytest.fixture
def checks(found: dict[str, Any]) -> dict[str, Any]:
    """Give the facts of each check by its name."""
    facts: dict[str, Any] = found["checks"]
    return facts


def test_firefox_has_nothing_to_complain_of(found: dict[str, Any]) -> None:
    """No error and no request but those that are planted at the end of the run."""
    assert [each for each in found["errors"] if not each.startswith("planted: ")] == []
    assert "planted: planted" in found["errors"]
    asked = [url for url in found["requests"] if not url.startswith(("file:", "data:", "blob:"))]
    assert asked == [PLANTED]


def test_the_pictures_are_drawn(checks: dict[str, Any]) -> None:
    """Every picture has a size and lines, and no coordinate that is no number."""
    for name in PICTURES:
        assert checks[name]["parts"] > 15, name
        assert checks[name]["longest"] > 200, name
        assert min(checks[name]["width"], checks[name]["height"]) > 100, name
        assert checks[name]["wrong"] == [], name
    assert checks["jump"] == "6.305\u00a0mm"


def test_the_motion_plays_and_stops(checks: dict[str, Any]) -> None:
    """The cursor moves while it plays, and stays where it is stopped."""
    play = checks["play"]
    assert play["before"] != play["stopped"] == play["later"]


def test_every_slider_moves_setting_and_numbers(checks: dict[str, Any]) -> None:
    """Five presses of an arrow on each slider."""
    assert checks["sliders"] == {name: {"moved": True, "read": True} for name in SI}


def test_firefox_reads_units_as_the_command_does(checks: dict[str, Any]) -> None:
    """What is typed with a unit, or in the unit beside the field, is the command's double."""
    *read, refused = checks["typed"]
    for each in read:
        name, text, used = each["name"], each["text"], dict(each["setting"])
        used["N"] = used["m"] * used["g"] + used["load"]
        beside = "" if text[-1:].isalpha() or text.endswith("%") else each["unit"]
        assert used[name] == parse(f"{text} {beside}", SI[name], name), text
        assert each["said"] == ""
    with pytest.raises(CommandError, match="is a force; expected a stiffness in N/m, such as 1 kN"):
        parse(refused["text"], "N/m", "k")
    assert "is a force; expected a stiffness in N/m, such as 1 kN" in refused["said"]


def test_every_preset_is_set(checks: dict[str, Any]) -> None:
    """The values are those of the table, bit for bit, and every number of the page is one."""
    for name, values in presets().items():
        assert checks["presets"][name]["setting"] == values
        assert "NaN" not in checks["presets"][name]["text"]
    assert len(checks["presets"]) == len(presets())


def test_the_exports_arrive(checks: dict[str, Any]) -> None:
    """CSV, SVG and PNG are files of their kind with content."""
    begins = {"csv": '"time","x"', "svg": "<?xml", "png": "\x89PNG"}
    for each, (kind, start) in zip(checks["exports"], begins.items(), strict=True):
        assert each["file"] == f"stick-slip.{kind}"
        assert each["begins"].startswith(start)
        assert each["size"] > 5000


@pytest.mark.parametrize("name", ["story", "said", "cures", "applications"])
def test_the_buttons_of_a_section_set_the_stage(checks: dict[str, Any], name: str) -> None:
    """Pressed one after the other they give settings of their own, and every number is one."""
    assert checks[name]["pressed"] >= 2
    assert checks[name]["settings"] >= 2
    assert "NaN" not in checks[name]["text"]


def test_the_sound_is_turned_on_and_off(checks: dict[str, Any]) -> None:
    """The button says what it is, and a line says what is heard."""
    assert checks["sound"]["states"] == ["false", "true", "false"]
    assert checks["sound"]["said"]
