"""How the page's script is put together from its modules, and who may import whom among them."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path, PurePosixPath

import pytest

from stickslip.page import page
from stickslip.page.script import imports, joined

FORCE = "export function force(k, z) {\n  return k * z;\n}\n"
ENERGY = """\
import { force } from "./force.js";

export const HALF = 0.5;
export function energy(k, z) {
  return HALF * force(k, z) * z;
}
"""
SHOW = """\
import { force } from "../model/force.js";
import {
  HALF,
  energy,
} from "../model/energy.js";

document.title = `${HALF} ${force(2, 3)} ${energy(2, 3)}`;
"""
MODULES = {"view/show.js": SHOW, "model/energy.js": ENERGY, "model/force.js": FORCE}


def sources() -> dict[str, str]:
    """Give the page's own modules by their path."""
    root = Path(str(files("stickslip.page")))
    return {
        file.relative_to(root).as_posix(): file.read_text(encoding="utf-8")
        for file in root.rglob("*.js")
    }


def without_comments(source: str) -> str:
    """Drop the comments, which fill whole lines in these modules."""
    return re.sub(r"^\s*(/\*.*?\*/|//[^\n]*)$", "", source, flags=re.DOTALL | re.MULTILINE)


def test_a_module_stands_after_all_that_it_needs() -> None:
    """What is used at once has been defined before, whatever order the files come in."""
    script = joined(MODULES, "view/show.js")
    places = [
        script.index(piece)
        for piece in ("function force", "const HALF", "function energy", "document.title")
    ]
    assert places == sorted(places)


def test_a_module_stands_in_the_script_once() -> None:
    """A module that two others need is there once, and one that nobody needs is not."""
    modules = {**MODULES, "model/idle.js": "export const IDLE = 1;\n"}
    script = joined(modules, "view/show.js")
    assert script.count("function force") == 1
    assert "IDLE" not in script


def test_a_joined_script_imports_and_exports_nothing() -> None:
    """A browser runs the script from a file, where it may load no modules."""
    assert not re.search(r"^\s*(import|export)\b", joined(MODULES, "view/show.js"), re.MULTILINE)


def test_the_words_import_and_export_stay_where_they_are_text() -> None:
    """Only the lines that say import and export are taken away, not texts that speak of them."""
    said = 'export const SAID = "export CSV, import nothing";\n'
    assert joined({"a.js": said}, "a.js") == said.removeprefix("export ")


def test_imports_are_paths_from_the_pages_root() -> None:
    """An import is read relative to the module's own folder."""
    assert imports("view/show.js", SHOW) == ["model/force.js", "model/energy.js"]
    assert imports("model/energy.js", ENERGY) == ["model/force.js"]
    assert imports("model/force.js", FORCE) == []


def test_a_circle_of_imports_is_refused() -> None:
    """Two modules that need each other have no order; both are named."""
    circle = {
        "a.js": 'import { b } from "./b.js";\nexport const a = 1;\n',
        "b.js": 'import { a } from "./a.js";\nexport const b = 1;\n',
    }
    with pytest.raises(ValueError, match=r"a\.js imports itself by way of b\.js"):
        joined(circle, "a.js")


def test_a_module_that_needs_itself_is_refused() -> None:
    """The smallest circle is one too."""
    with pytest.raises(ValueError, match=r"a\.js imports itself"):
        joined({"a.js": 'import { a } from "./a.js";\nexport const a = 1;\n'}, "a.js")


def test_a_missing_module_is_named_with_the_one_that_needs_it() -> None:
    """A wrong path in an import is told where it stands."""
    lost = {name: text for name, text in MODULES.items() if name != "model/force.js"}
    with pytest.raises(ValueError, match=r"needs model/force\.js: no such module"):
        joined(lost, "view/show.js")
    with pytest.raises(ValueError, match=r"the page needs view/none\.js"):
        joined(MODULES, "view/none.js")


@pytest.mark.parametrize(
    "line", ["const force = 1;", "function* force() {}", "let force;", "class force {}"]
)
def test_a_name_of_two_modules_is_refused(line: str) -> None:
    """The modules share one scope, so a name belongs to one of them; both are named."""
    modules = {**MODULES, "view/show.js": f"{SHOW}\n{line}\n"}
    with pytest.raises(ValueError, match=r"view/show\.js: force is a name of model/force\.js too"):
        joined(modules, "view/show.js")


def test_names_declared_by_a_pattern_are_refused() -> None:
    """Names that a pattern takes apart would escape the search for names used twice."""
    modules = {**MODULES, "view/show.js": f"{SHOW}\nconst [force, idle] = [1, 2];\n"}
    with pytest.raises(ValueError, match=r"view/show\.js: a pattern declares names"):
        joined(modules, "view/show.js")


def test_a_name_inside_a_function_is_nobody_elses() -> None:
    """Only names at the top of a module are shared."""
    modules = {**MODULES, "view/show.js": f"{SHOW}\nfunction own() {{\n  const force = 1;\n}}\n"}
    assert "const force = 1" in joined(modules, "view/show.js")


def test_the_model_needs_nothing_but_the_model() -> None:
    """The physics of the page can be read, and run, without its pictures."""
    outward = [
        f"{path} imports {needed}"
        for path, text in sources().items()
        if PurePosixPath(path).parts[0] == "model"
        for needed in imports(path, text)
        if PurePosixPath(needed).parts[0] != "model"
    ]
    assert not outward


def test_the_model_knows_no_browser() -> None:
    """No module of the physics names the document, the window or their like."""
    named = [
        f"{path}: {found[0]}"
        for path, text in sources().items()
        if PurePosixPath(path).parts[0] == "model"
        for found in re.finditer(
            r"\b(document|window|globalThis|self|navigator|location|console)\b",
            without_comments(text),
        )
    ]
    assert len(sources()) > 8
    assert not named


def test_every_import_is_one_that_the_joining_takes_away() -> None:
    """The modules import and export in the few forms that are understood, and in no other."""
    strange = [
        f"{path}: {line}"
        for path, text in sources().items()
        for line in joined({**sources(), path: text}, path).splitlines()
        if re.match(r"\s*(import\b|export\b)", line)
    ]
    assert not strange


def test_every_module_is_part_of_the_page() -> None:
    """No source lies about that the page does not need."""
    needed = {"main.js"}
    waiting = ["main.js"]
    while waiting:
        path = waiting.pop()
        new = set(imports(path, sources()[path])) - needed
        needed |= new
        waiting += new
    assert needed == set(sources())


def test_an_imported_name_is_exported_where_it_is_taken_from() -> None:
    """The browser would not tell: all names share one scope, and a misspelt import goes unseen."""
    every = sources()
    missing = []
    for path, text in every.items():
        found = re.findall(r'^import \{([^}]*)\} from "([^"]*)";', text, re.MULTILINE)
        for names, target in zip((n for n, _ in found), imports(path, text), strict=True):
            exported = set(
                re.findall(
                    r"^export (?:function\*?|const|class) (\w+)", every[target], re.MULTILINE
                )
            )
            wanted = {name.strip() for name in names.split(",") if name.strip()}
            missing += [f"{path}: {name} of {target}" for name in wanted - exported]
    assert not missing


def test_the_page_keeps_its_texts_and_drops_its_comments() -> None:
    """What is left out of the sources is what no reader of the page sees."""
    script = page().partition("<script>")[2]
    assert "docs/theory.md" not in script
    assert "http://www.w3.org/2000/svg" in script


def test_a_module_imports_what_it_calls() -> None:
    """In the one scope a call without an import would work, and hide who needs whom."""
    every = {path: without_comments(text) for path, text in sources().items()}
    exported = {
        name: path
        for path, text in every.items()
        for name in re.findall(r"^export (?:function\*?|const|class) (\w+)", text, re.MULTILINE)
    }
    unsaid = [
        f"{path} calls {name} of {owner}"
        for path, text in every.items()
        for name, owner in exported.items()
        if owner != path
        and re.search(rf"(?<![\w.])(?<!get ){name}\(", text)
        and not re.search(rf"^import \{{[^}}]*\b{name}\b", text, re.MULTILINE)
        and not re.search(rf"\b(?:const|let|function\*?) {name}\b", text)
    ]
    assert not unsaid
