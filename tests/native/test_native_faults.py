"""Faults planted in the C sources: each is detected by the check that was named in advance."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Literal

import fmpy
import pytest

from stickslip_native.named import native_law
from stickslip_native.packer import build, sources_of
from tests.native.conftest import EACH
from tests.native.planting import Fault, Planter, load_fault, load_faults, pack
from tests.native.suite import Suite
from tests.needs import needs

FAULTS = load_faults()


@dataclass
class Bench:
    """FMUs of one FMI version and law with faults planted, and the suite that tries them.

    Attributes
    ----------
    version
        The major version of FMI.
    law
        The friction law.
    """

    version: Literal[2, 3]
    law: str
    folder: Path
    suite: Suite
    _sound: dict[tuple[str, str], list[str]] = field(default_factory=dict)

    def failing(self, fault: Fault) -> tuple[list[str], list[str]]:
        """Return what the fault's check finds in the sound FMU, and in the faulty one."""
        key = fault.check, fault.place
        if key not in self._sound:
            self._sound[key] = self._tried(fault, self._library("sound", None))
        return self._sound[key], self._tried(fault, self._library(fault.id, fault))

    def _tried(self, fault: Fault, library: Path) -> list[str]:
        folder = library.parents[2]
        count = int(fault.place.split()[0]) if fault.place.endswith("sequences") else 0
        match fault.check:
            case "equal-bits":
                # That of the sound one is a test of its own.
                sound = folder.name == "sound"
                return [] if sound else self.suite.differing(library, count, self.law)
            case "call-sequences":
                return self.suite.call_sequences(folder, self._identity, count)
            case "damaged-states":
                return self.suite.damaged_states(folder, self._identity)
            case "texts":
                return self.suite.texts(library)
        fmu = pack(self._fmu, library, folder / f"{folder.name}.fmu")
        return self.suite.failing(fmu, fault.check, fault.place)

    def _library(self, name: str, fault: Fault | None) -> Path:
        model = native_law(self.law).spec.name
        library: Path = self.folder / name / "binaries" / fmpy.platform / f"{model}.so"
        if not library.exists():
            planter = self.planter
            library.parent.mkdir(parents=True)
            planter.library(library, fault)
        return library

    @cached_property
    def planter(self) -> Planter:
        """The compiled sources."""
        self.folder.mkdir()
        return Planter(sources_of(self.version, self.law), self.folder)

    @cached_property
    def _fmu(self) -> Path:
        return build(self.folder, face=self.version, this_machine=True, law=self.law)

    @cached_property
    def _identity(self) -> str:
        found = re.search(r'"(.*)"', sources_of(self.version, self.law)["identity.h"].decode())
        assert found is not None
        return found[1]


Benches = dict[tuple[int, str], Bench]


@pytest.fixture(scope="module")
def benches(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Benches]:
    """Return the benches of both FMI versions and all laws."""
    folder = tmp_path_factory.mktemp("faults")
    with Suite() as suite:
        yield {
            (version, law): Bench(version, law, folder / f"{law}-{version}", suite)
            for version, law in EACH
        }


def _of_fmi3(fault: Fault) -> bool:
    return any("fmi3" in name for name in fault.replaces)


@needs("cc")
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.id)
def test_a_planted_fault_is_detected_as_foretold(benches: Benches, fault: Fault) -> None:
    """The check that a fault names fails on the faulty FMU, and passes on the sound one."""
    sound, faulty = benches[3 if _of_fmi3(fault) else 2, fault.law].failing(fault)
    assert sound == []
    assert faulty, f"{fault.check} passes although {fault.about}"


@needs("cc")
def test_faults_are_planted_in_every_source(benches: Benches) -> None:
    """Each C file of core, faces and laws has a fault at least."""
    hit = {
        benches[3 if _of_fmi3(fault) else 2, fault.law].planter.source_of(name)
        for fault in FAULTS
        for name in fault.replaces
    }
    assert hit == {name for bench in benches.values() for name in bench.planter.names()}


HARMLESS = """\
/* Nothing is wrong: the true function is called.
 * replaces: sum_with
 * detected by: {check}
 */
#include "numerics.h"

struct sum true_sum_with(struct sum total, double term);

struct sum sum_with(struct sum total, double term)
{{
    return true_sum_with(total, term);
}}
"""


def _harmless(folder: Path, check: str) -> Fault:
    source = folder / f"harmless-{check.split()[0]}.c"
    source.write_text(HARMLESS.format(check=check))
    return load_fault(source)


@needs("cc")
@pytest.mark.parametrize(
    "check",
    ["x-course in default", "equal-bits in 20 sequences", "call-sequences in 20 sequences",
     "damaged-states", "texts", "memory-of-states"],
)  # fmt: skip
def test_what_is_no_fault_is_not_detected(benches: Benches, tmp_path: Path, check: str) -> None:
    """A replacement that changes nothing fails no check."""
    assert benches[2, "coulomb"].failing(_harmless(tmp_path, check)) == ([], [])


@needs("cc")
@pytest.mark.parametrize("name", ["sum_without", "ZERO"])
def test_a_name_that_is_not_there_once_is_told(benches: Benches, name: str) -> None:
    """A fault that replaces what is gone, or is in two files, cannot be planted."""
    with pytest.raises(ValueError, match=f"^{name} is in "):
        benches[2, "coulomb"].planter.source_of(name)
