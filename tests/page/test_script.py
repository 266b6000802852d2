"""How the page's script is put together from its modules, and the types that they declare."""

import re
import subprocess
from importlib.resources import files
from pathlib import Path

import pytest

from stickslip.page.script import imports, joined
from tests.needs import ROOT, TSC, needs

SOURCES = Path(str(files("stickslip.page")))
FORCE = "export function force(k, z) {\n  return k * z;\n}\n"
ENERGY = 'import { force } from "./force.js";\n\nexport const HALF = 0.5;\n'
SHOW = """\
import { force } from "../model/force.js";
import {
  HALF,
} from "../model/energy.js";

const SAID = "export CSV, import nothing";
document.title = `${HALF} ${force(2, 3)} ${SAID}`;
"""
MODULES = {
    "view/show.js": SHOW,
    "model/energy.js": ENERGY,
    "model/force.js": FORCE,
    "model/idle.js": "export const IDLE = 1;\n",
}


def test_a_module_stands_once_after_all_that_it_needs() -> None:
    assert imports("view/show.js", SHOW) == ["model/force.js", "model/energy.js"]
    script = joined(MODULES, "view/show.js")
    pieces = ("function force", "const HALF", "export CSV", "document.title")
    assert [script.count(piece) for piece in pieces] == [1] * len(pieces)
    assert sorted(pieces, key=script.index) == list(pieces)
    assert "IDLE" not in script
    assert not re.search(r"^\s*(import|export)\b", script, re.MULTILINE)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"model/force.js": 'import { HALF } from "./energy.js";\n'}, "imports itself by way of"),
        ({"model/force.js": 'import { a } from "./force.js";\n'}, r"force\.js imports itself"),
        ({"model/force.js": None}, r"needs model/force\.js: no such module"),
        ({"view/show.js": None}, r"the page needs view/show\.js"),
        ({"view/show.js": SHOW + "\nlet force;\n"}, r"force is a name of model/force\.js too"),
        ({"view/show.js": SHOW + "\nclass HALF {}\n"}, r"HALF is a name of model/energy\.js too"),
        ({"view/show.js": SHOW + "\nconst [a, b] = [1, 2];\n"}, "a pattern declares names"),
    ],
)
def test_what_cannot_be_one_script_is_refused(changed: dict[str, str | None], told: str) -> None:
    modules = {name: text for name, text in {**MODULES, **changed}.items() if text is not None}
    with pytest.raises(ValueError, match=told):
        joined(modules, "view/show.js")


@pytest.mark.gate
def test_the_physics_of_the_page_needs_no_browser_and_nothing_lies_about_unused() -> None:
    sources = {
        file.relative_to(SOURCES).as_posix(): file.read_text(encoding="utf-8")
        for file in SOURCES.rglob("*.js")
    }
    needed = {path: imports(path, text) for path, text in sources.items()}
    model = [path for path in sources if path.startswith("model/")]
    assert len(model) > 8
    outward = [each for path in model for each in needed[path] if not each.startswith("model/")]
    assert outward == []
    assert set(sources) == {"main.js", *(each for some in needed.values() for each in some)}


@needs("typescript")
@pytest.mark.parametrize("folder", [".", "model"])
def test_every_name_and_argument_is_of_the_declared_type(folder: str) -> None:
    # The model with the strict rules, and without a browser's names.
    project = ROOT / "workbench" / "stickslip" / "page" / folder
    done = subprocess.run(
        [*TSC, "--project", "."], cwd=project, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.returncode) == ("", 0), done.stderr
