"""The modules that travel in an FMU: found by their imports, tied to each other relatively."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from fmi.packer import PackError, travelling
from stickslip_fmu import packer

Write = Callable[[str, str], None]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    monkeypatch.syspath_prepend(tmp_path)

    def write(path: str, text: str) -> None:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")

    return write


def test_neither_packer_nor_another_friction_law_travels() -> None:
    found = travelling(packer.MAIN)
    assert not [each for each in found if re.search("packer|description|stribeck", each)]


def test_imports_between_what_travels_become_relative_at_any_depth(write: Write) -> None:
    text = (
        "import math\nfrom os import path; {0}  # é\n\n\n"
        "def cut():\n    {1} import (\n        tools,\n    )\n    from .. import gate\n"
    )
    write("yard/__init__.py", "from shed.tools import saw\n")
    write("yard/far/__init__.py", "")
    write("yard/far/corner.py", text.format("from shed.tools import saw", "from shed"))
    write("yard/gate.py", "")
    write("shed/__init__.py", "")
    write("shed/tools.py", "saw = 1\n")
    packed = travelling("from yard.far.corner import cut as SPEC")
    assert packed["slave.py"].startswith(b"from .yard.far.corner import cut as SPEC\n")
    assert packed["yard/__init__.py"] == b"from ..shed.tools import saw\n"
    relative = text.format("from ...shed.tools import saw", "from ...shed")
    assert packed["yard/far/corner.py"].decode() == relative
    others = {"yard/gate.py", "yard/far/__init__.py", "shed/__init__.py", "shed/tools.py"}
    assert others < set(packed)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("from nowhere.at_all import x", "nowhere, which cellar imports, cannot be packed: no"),
        (
            "import stickslip_fmu.block",
            "line 1 imports stickslip_fmu.block, which is not in Python's standard library",
        ),
        ("from  stickslip_fmu.spec import SPEC", "line 1 is not written from stickslip_fmu.spec"),
        ("match 1:\n    case 1: pass", "line 2 is not Python 3.8"),
        ("import numpy as np", "cellar cannot be packed: line 1 imports numpy, which is not in"),
        ("from numpy import pi", "(cellar imports numpy)"),
    ],
)
def test_a_module_that_cannot_travel_is_named_with_line_and_reason(
    write: Write, text: str, told: str
) -> None:
    write("cellar.py", text)
    with pytest.raises(PackError, match="cannot be packed") as caught:
        travelling("from cellar import SPEC")
    assert told in str(caught.value)
