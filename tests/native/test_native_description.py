"""The description of the native FMU: that of the Python FMU, but for who made it, and of what."""

from collections.abc import Callable
from pathlib import Path
from typing import Literal
from xml.etree import ElementTree

import fmpy
import pytest

from stickslip_fmu import packer as python_packer
from stickslip_native import compiler, packer
from stickslip_native.named import native_law
from tests.fmu.conformity import CHECKERS, description_of
from tests.laws import renamed
from tests.native.conftest import EACH, LAWS, Native
from tests.needs import needs

Checker = Callable[[Path], list[str]]

OF_ONE_FMU = {2: {"guid", "generationTool"}, 3: {"instantiationToken", "generationTool"}}


def root_of(fmu: Path) -> ElementTree.Element:
    """Return the root of an FMU's description."""
    return ElementTree.fromstring(description_of(fmu))


def parts_of(root: ElementTree.Element) -> dict[str, str]:
    """Return the children of a description as text without layout, by tag."""
    return {
        child.tag: ElementTree.canonicalize(
            ElementTree.tostring(child, encoding="unicode"), strip_text=True
        )
        for child in root
    }


@needs("cc")
@pytest.mark.parametrize(("face", "law"), EACH)
def test_the_description_is_that_of_the_python_fmu(
    face: Literal[2, 3], law: str, native: Native, tmp_path: Path
) -> None:
    """Variables, units, types, structure, experiment, annotations and capabilities are the same."""
    made = root_of(native(face, law))
    python = root_of(python_packer.build(tmp_path, face=face, law=law))
    different = {name for name in made.attrib if made.get(name) != python.get(name)}
    assert different == OF_ONE_FMU[face]
    assert made.keys() == python.keys()
    categories = {each.get("name") for each in made.iter("Category")}
    assert categories == {"logStatusWarning", "logStatusError", "logAll"}
    for slave in made.iter("CoSimulation"):
        for sources in slave.findall("SourceFiles"):
            slave.remove(sources)
    ours, theirs = parts_of(made), parts_of(python)
    assert list(ours) == list(theirs)
    assert {tag for tag in ours if ours[tag] != theirs[tag]} == {"LogCategories"}


@needs("cc")
@pytest.mark.parametrize("checker", CHECKERS)
def test_checkers_find_nothing(either_native: Path, checker: Checker) -> None:
    """The XML schema, fmpy and fmutool have nothing to say of the native FMU."""
    assert checker(either_native) == []


@needs("cc")
def test_every_c_file_is_listed(either_native: Path) -> None:
    """Importers that compile the sources find all of them in the description."""
    description = fmpy.read_model_description(str(either_native), validate=True)
    (configuration,) = description.buildConfigurations
    (together,) = configuration.sourceFileSets
    face: Literal[2, 3] = 2 if description.fmiVersion == "2.0" else 3
    (law,) = (each for each in LAWS if native_law(each).spec.name == description.modelName)
    travelling = packer.sources_of(face, law)
    assert set(together.sourceFiles) == {name for name in travelling if name.endswith(".c")}
    assert f"fmi{face}.c" in together.sourceFiles
    assert not any(name.startswith(f"fmi{5 - face}") for name in travelling)
    assert configuration.modelIdentifier == description.modelName
    assert either_native.name.startswith(f"{description.modelName}_native")
    # No law's own file travels with another one.
    assert ("coulomb.c" in travelling, "stribeck.c" in travelling) == (
        law == "coulomb",
        law == "stribeck",
    )


@needs("cc")
def test_the_identity_is_made_from_the_content(
    native_path: Path, native3_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another FMI version, source or compiler option has another GUID, and the C code knows it."""
    guid = fmpy.read_model_description(str(native_path)).guid
    token = fmpy.read_model_description(str(native3_path)).instantiationToken
    assert guid != token
    assert f'"{guid}"' in packer.sources_of(2)["identity.h"].decode()
    assert f'"{token}"' in packer.sources_of(3)["identity.h"].decode()
    sources = packer.sources_of(2)
    assert guid.encode() in packer.description(2, sources)
    sources["block.c"] += b"\n"
    assert guid.encode() not in packer.description(2, sources)
    monkeypatch.setattr(packer, "FLAGS", (*compiler.FLAGS, "-ffast-math"))
    assert guid not in packer.sources_of(2)["identity.h"].decode()


def test_a_law_without_a_native_side_is_told() -> None:
    """A law of somebody else has one in Python alone so far; an unknown one is none."""
    with pytest.raises(ValueError, match="no native side; coulomb and stribeck have one"):
        packer.sources_of(2, renamed.NAME)
    with pytest.raises(ValueError, match="'stribek' is no friction law"):
        packer.sources_of(2, "stribek")
