"""What a person finds in the FMU: documentation, page, icon, licences."""

import html
import io
import posixpath
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import fmpy
import pytest
from lxml import etree
from PIL import Image

from stickslip.handbook import parts
from stickslip.page import page
from stickslip_fmu.laws.named import BUILT_IN, friction_law
from stickslip_fmu.spec import TABLE, spec_of

pytestmark = pytest.mark.gate
Runtime = Mapping[str, tuple[str, bytes]]
SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"

RUNTIME = {"start": ("Start of the libraries: MIT", b"All rights reversed")}
"""What a compiler would link into the native FMU."""


@pytest.mark.parametrize(("fmi_version", "runtime"), [(2, None), (2, RUNTIME), (3, RUNTIME)])
@pytest.mark.parametrize("name", ["documentation/index.html", "documentation/fmi-ls-ref.html"])
def test_a_document_is_one_file_and_its_links_lead_somewhere(
    fmi_version: Literal[2, 3], name: str, runtime: Runtime | None
) -> None:
    files = parts(fmi_version, runtime)
    text = files[name].decode()
    for word in ("<link", "<img", "src=", "url(", "@import"):
        assert word not in text
    evidence = "extra/org.fmi-standard.fmi-ls-ref/"
    there = {*files, evidence + "report.html", evidence + "fmi-ls-manifest.xml"}
    ids = re.findall(r'\bid="([^"]+)"', text)
    for link in re.findall(r'<a [^>]*href="([^"]+)"', text):
        file, _, anchor = link.partition("#")
        assert not file or posixpath.normpath(posixpath.join("documentation", file)) in there
        assert not anchor or anchor in ids


def test_the_interface_is_the_variable_table() -> None:
    text = parts()["documentation/index.html"].decode()
    rows = re.findall(r'<tr><th scope="row"><code>(\w+)</code></th><td class="n">([^<]*)', text)
    assert sorted(name for name, _ in rows) == sorted(row.name for row in TABLE.rows)
    units = dict(rows)
    plain = html.unescape(re.sub(r"<[^>]+>", "", text))
    for row in TABLE.rows:
        assert units[row.name] == ("" if row.unit == "1" else row.unit or row.kind)
        assert row.description in plain


def test_the_page_lies_beside_the_documentation() -> None:
    assert parts()["documentation/explore.html"].decode() == page()


def test_licences_stand_where_each_standard_wants_them() -> None:
    for files, folder, of in (
        (parts(2), "licenses", ("pythonfmu.txt", "stickslip.txt")),
        (parts(3, RUNTIME), "documentation/licenses", ("stickslip.txt",)),
    ):
        entry = files[f"{folder}/license.txt"].decode()
        for name in of:
            assert name in entry
            assert "MIT License" in files[f"{folder}/{name}"].decode()


def test_the_native_fmu_carries_the_licences_of_its_runtime_and_of_no_wrapper() -> None:
    for files, folder in (
        (parts(2, RUNTIME), "licenses"),
        (parts(3, {}), "documentation/licenses"),
    ):
        names = {name for name in files if name.startswith(f"{folder}/")}
        entry = files[f"{folder}/license.txt"].decode()
        parts_of_runtime = {"start.txt"} if folder == "licenses" else set[str]()
        assert names == {
            f"{folder}/{name}" for name in {"license.txt", "stickslip.txt"} | parts_of_runtime
        }
        assert all(name in entry for name in parts_of_runtime)
    assert parts(2, RUNTIME)["licenses/start.txt"] == b"All rights reversed"


@pytest.mark.parametrize("law", BUILT_IN)
def test_terminals_are_flanges_and_friction_under_a_small_square_icon(law: str) -> None:
    files = parts(law=law)
    assert files["model.png"] == files["terminalsAndIcons/icon.png"]
    table = spec_of(friction_law(law).law).table.by_name
    root = etree.fromstring(files["terminalsAndIcons/terminalsAndIcons.xml"])
    etree.XMLSchema(file=SCHEMA).assertValid(root)
    found = {
        str(terminal.get("name")): {
            (table[each.get("variableName")].causality, each.get("variableName"))
            for each in terminal.iterfind("TerminalMemberVariable")
        }
        for terminal in root.iter("Terminal")
    }
    settings = {row for row in found.pop("friction") if row[0] == "parameter"}
    own = {"stribeck": "mu_1", "lugre": "sigma_0", "rate_state": "D_c"}.get(law, "mu_s")
    assert {name for _, name in settings} >= {"c", own}
    assert found == {
        "pulled_end": {("input", "v"), ("output", "x_pull"), ("output", "F")},
        "mass": {("input", "F_ext"), ("output", "x"), ("output", "x_dot")},
    }
    for name, width in (("icon", 256), ("flange", 32)):
        picture = files[f"terminalsAndIcons/{name}.png"]
        assert len(picture) < 3_000
        with Image.open(io.BytesIO(picture)) as drawn:
            assert (drawn.format, drawn.size) == ("PNG", (width, width))
