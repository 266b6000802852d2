"""What a person finds in the FMU: documentation, page, icon, licences."""

import html
import io
import posixpath
import re
from collections.abc import Mapping
from typing import Literal

import pytest
from PIL import Image

from stickslip.handbook import parts
from stickslip.page import page
from stickslip_fmu.spec import TABLE

pytestmark = pytest.mark.gate
Runtime = Mapping[str, tuple[str, bytes]]

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


def test_the_icon_is_a_small_square_picture() -> None:
    picture = parts()["model.png"]
    assert len(picture) < 10_000
    with Image.open(io.BytesIO(picture)) as drawn:
        assert (drawn.format, drawn.size) == ("PNG", (256, 256))
