"""The page in Firefox: pictures, sliders, units, motion, exports and sections, by one smoke run."""

import json
from pathlib import Path
from typing import Any

from tests.needs import PUPPETEER, SMOKE, firefox, needs
from tests.page.settings import PRESETS
from tests.page.window import SI
from tests.python import run

pytestmark = needs("firefox")

# Nobody listens there; Firefox itself blocks the well-known ports, and such a request goes unseen.
PLANTED = "http://127.0.0.1:47809/planted"


def used(page: Path) -> dict[str, Any]:
    """Return what one run of the script in Firefox has found."""
    done = run(*PUPPETEER, SMOKE, firefox(), page, timeout=300)
    assert done.returncode == 0, done.stderr
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer


def test_the_page_is_drawn_played_moved_and_saved_without_an_error(page_file: Path) -> None:
    found = used(page_file)
    assert found["version"].startswith("firefox/")
    # On a busy machine Firefox draws formulas before it has read them to their end, and complains.
    early = "Incorrect number of children for"
    errors = [each for each in found["errors"] if early not in each]
    assert [each for each in errors if not each.startswith("planted: ")] == []
    assert found["checks"]["formulas"] == []
    assert "planted: planted" in found["errors"]
    asked = [url for url in found["requests"] if not url.startswith(("file:", "data:", "blob:"))]
    assert asked == [PLANTED]
    checks = found["checks"]
    assert checks["jump"] == "6.305\u00a0mm"
    for drawn in checks["drawings"]:
        assert drawn["parts"] > 15
        assert drawn["longest"] > 200
        assert min(drawn["width"], drawn["height"]) > 100
        assert drawn["wrong"] == []
    assert checks["play"]["before"] != checks["play"]["stopped"] == checks["play"]["later"]
    assert checks["sliders"] == {name: {"moved": True, "read": True} for name in SI}
    *taken, refused = [each["said"] for each in checks["typed"]]
    assert set(taken) == {""} != {refused}
    assert {n: each["setting"] for n, each in checks["presets"].items()} == PRESETS
    begins = {"csv": '"time","x"', "svg": "<?xml", "png": "\x89PNG"}
    for each, (kind, start) in zip(checks["exports"], begins.items(), strict=True):
        assert each["file"] == f"stick-slip.{kind}"
        assert each["begins"].startswith(start)
        assert each["size"] > 5000
    for name in ("story", "said", "cures", "applications"):
        assert min(checks[name]["pressed"], checks[name]["settings"]) >= 2, name
        assert "NaN" not in checks[name]["text"]
    assert checks["sound"]["states"] == ["false", "true", "false"]
    assert checks["sound"]["said"]
