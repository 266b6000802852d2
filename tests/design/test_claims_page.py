"""The page of the claims and its plots: complete, fit to embed, the same on every run."""

from __future__ import annotations

import hashlib
import os
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from stickslip_design.claims import findings, markdown, write
from stickslip_verification.report.svg import tidy
from tests.python import python

# In a process of its own, so that neither the cache nor the hash seed of this one helps.
ELSEWHERE = """
import hashlib, sys
from stickslip_design import claims
heavy = {"numpy", "mpmath", "matplotlib"}
print(sorted(heavy & set(sys.modules)))
found = claims.findings()
text = "\\n".join(claims.markdown(found))
print("matplotlib" in sys.modules)
text += "".join(claims.draw(each) for each in found)
print(hashlib.sha256(text.encode()).hexdigest())
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Return the page and its plots, as they are written."""
    return write(tmp_path_factory.mktemp("docs"))


@pytest.fixture(scope="module")
def plots(files: list[Path]) -> dict[str, str]:
    """Return every plot by the id of its finding."""
    return {file.stem: file.read_text(encoding="utf-8") for file in files[1:]}


def test_page_and_plots_are_the_same_in_another_process(plots: dict[str, str]) -> None:
    """Two processes write the same bytes, and only drawing needs the library that draws."""
    done = python("-c", ELSEWHERE, env={**os.environ, "PYTHONHASHSEED": "7"}, timeout=300)
    at_import, while_trying, digest = done.stdout.splitlines()
    assert at_import == "[]"
    assert while_trying == "False"
    here = "\n".join(markdown(findings())) + "".join(plots[each.id] for each in findings())
    assert digest == hashlib.sha256(here.encode()).hexdigest()


def test_plots_are_fit_to_embed(plots: dict[str, str]) -> None:
    """Each plot is well-formed, needs no font, has a title, no date, and in a page its own ids."""
    names: list[str] = []
    for id_, svg in plots.items():
        root = ET.fromstring(svg)
        tags = {element.tag.partition("}")[2] for element in root.iter()}
        assert svg.startswith("<svg ")
        assert "title" in tags
        assert not {"text", "image", "script", "metadata"} & tags
        assert not re.search(r"matplotlib\.org|20\d\d-\d\d", svg)
        in_page = tidy(svg, id_, "title")
        of_plot = re.findall(r'\bid="([^"]+)"', in_page)
        assert of_plot
        assert all(name.startswith(f"{id_}-") for name in of_plot)
        used = set(re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', in_page))
        assert {one or other for one, other in used} <= set(of_plot)
        names += of_plot
    assert len(names) == len(set(names))


def test_page_says_all_there_is(files: list[Path]) -> None:
    """Every claim stands on the page with its verdict, its sentence, its table and its plot."""
    page = files[0].read_text(encoding="utf-8")
    assert files[0].name == "claims.md"
    assert all(file.is_file() for file in files)
    assert len(files) == 1 + len(findings())
    for each in findings():
        section = page.split(f"## {each.title}\n")[1].split("\n## ")[0]
        assert each.claim in section
        assert f"`{each.formula}`" in section
        assert each.sentence in section
        (target,) = re.findall(r"!\[[^]]+\]\(([^)]+)\)", section)
        assert files[0].parent / target in files
        rows = [line for line in section.splitlines() if line.startswith("|")]
        assert len(rows) == 2 + len(each.rows)
        assert {line.count("|") for line in rows} == {len(each.header) + 1}


def test_every_claim_is_tried_once() -> None:
    """The six claims of the page are those with a data file."""
    folder = Path(sys.modules[findings.__module__].__file__ or "").parent
    ids = [each.id for each in findings()]
    assert sorted(ids) == sorted(file.stem for file in folder.glob("*.toml"))
    assert len(ids) == len(set(ids)) == 6
