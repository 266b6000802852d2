"""The modules that travel in an FMU: found by their imports, tied to each other relatively."""

from collections.abc import Callable
from pathlib import Path

import pytest

from fmukit.packer import PackError, travelling
from stickslip_fmu import packer

Write = Callable[[str, str], None]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Return a function that writes a module where this process finds it."""
    monkeypatch.syspath_prepend(tmp_path)

    def write(path: str, text: str) -> None:
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    return write


def test_all_of_the_block_travels_and_one_face() -> None:
    """The block travels without what builds it; of the kit one face travels and no packer."""
    here = Path(packer.__file__).parent
    modules = {file.relative_to(here).as_posix() for file in here.rglob("*.py")}
    block = {f"stickslip_fmu/{each}" for each in modules if "laws/stribeck/" not in each}
    two, three = travelling(packer.MAIN, 2), travelling(packer.MAIN, 3)
    for packed in (two, three):
        assert {each for each in packed if each.startswith("stickslip_fmu/")} == (
            block - {"stickslip_fmu/packer.py", "stickslip_fmu/laws/named.py"}
        )
        assert "fmukit/packer.py" not in packed
    faces = {"fmukit/fmi2/__init__.py", "fmukit/fmi2/description.py", "fmukit/fmi2/face.py"}
    assert two.keys() - three.keys() == faces
    assert three.keys() - two.keys() == {each.replace("fmi2", "fmi3") for each in faces}


def test_imports_between_what_travels_become_relative(write: Write) -> None:
    """From any depth, in functions too; imports of the standard library stay as they are."""
    write("yard/__init__.py", "from shed.tools import saw\n")
    write("yard/far/__init__.py", "")
    write(
        "yard/far/corner.py",
        "import math\nfrom os import path; from shed.tools import saw  # é\n\n\n"
        "def cut():\n    from shed import (\n        tools,\n    )\n    from .. import gate\n",
    )
    write("yard/gate.py", "")
    write("shed/__init__.py", "")
    write("shed/tools.py", "saw = 1\n")
    packed = travelling("from yard.far.corner import cut as SPEC", 2)
    assert packed["slave.py"].startswith(b"from .yard.far.corner import cut as SPEC\n")
    assert packed["yard/__init__.py"] == b"from ..shed.tools import saw\n"
    assert packed["yard/far/corner.py"].decode() == (
        "import math\nfrom os import path; from ...shed.tools import saw  # é\n\n\n"
        "def cut():\n    from ...shed import (\n        tools,\n    )\n    from .. import gate\n"
    )
    assert {"yard/gate.py", "yard/far/__init__.py", "shed/__init__.py", "shed/tools.py"} < set(
        packed
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            "from nowhere.at_all import x",
            "nowhere, which cellar imports, cannot be packed: no",
        ),
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
def test_a_module_that_cannot_travel_is_named(write: Write, text: str, told: str) -> None:
    """With its line and the reason, before anything is built."""
    write("cellar.py", text)
    with pytest.raises(PackError, match="cannot be packed") as caught:
        travelling("from cellar import SPEC", 2)
    assert told in str(caught.value)
