"""An FMU as a file: extracted once, its description read, its variables found by our names."""

from __future__ import annotations

import shutil
import weakref
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import fmpy
import fmpy.model_description

from stickslip_verification.drive.fmu.errors import FmuError, one_line
from stickslip_verification.drive.fmu.fmi2 import Fmi2Instance
from stickslip_verification.drive.fmu.fmi3 import Fmi3Instance
from stickslip_verification.drive.fmu.hooks import hooked
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.fmu.names import NameMap
from stickslip_verification.drive.fmu.stated import StatedContract, stated_contract
from stickslip_verification.drive.fmu.unpacking import (
    DESCRIPTION,
    MOST_DESCRIBED,
    check_size,
    new_folder,
    unpack,
)
from stickslip_verification.drive.fmu.variables import (
    Variable,
    collect,
    collect_own,
    extra_outputs,
    listing,
)
from stickslip_verification.truth.parameters import Parameter

if TYPE_CHECKING:
    from stickslip_verification.suite.faults import Hook

_FACES: Mapping[str, type[FmuInstance]] = {"2.0": Fmi2Instance, "3.0": Fmi3Instance}

_MOST_PROBLEMS = 100
_LONGEST_PROBLEM = 1000

REQUIRED: tuple[str, ...] = ("m", "k", "mu_s", "mu_k", "v", "x")
"""What an FMU must have to be judged as a stick-slip block at all."""


class FmuFile:
    """An extracted FMU and its description.

    Parameters
    ----------
    path
        The ``.fmu`` archive.
    names
        Our names to its names, where they differ.
    hooks
        Faults planted between the master and its instances.
    own_starts
        Whether the FMU's own start values are tried; None for where it promises them: its
        description names the exact contract, and no names differ.

    Attributes
    ----------
    fmi_version
        2.0 or 3.0.
    stated
        The contract that its description names.
    own_starts
        Whether a case leaves parameters that it does not name at the FMU's start values.
    variables
        The variables that are ours, by our names.
    extra_outputs
        The outputs that are none of ours, by the FMU's names.
    problems
        What the description breaks of the FMI standard, if it can be read all the same.
    token
        What the FMU is instantiated with: its guid or instantiation token.
    folder
        Where it is extracted, until `close` or the end of this object.

    Raises
    ------
    FmuError
        No such file, not an FMU, too much to unpack, not for co-simulation, neither FMI 2.0 nor
        3.0, not for this platform; or a variable of ours that cannot be used, see `collect`.
    """

    def __init__(
        self,
        path: Path,
        names: NameMap | None = None,
        hooks: Sequence[Hook] = (),
        *,
        own_starts: bool | None = None,
    ) -> None:
        self.path = path
        self.names = NameMap() if names is None else names
        description, self.problems, self.stated = _read(path)
        if own_starts is None:
            own_starts = self.stated.exact and not self.names.targets
        self.own_starts = own_starts
        interface = description.coSimulation
        _check_platform(path)
        self.fmi_version: str = description.fmiVersion[:3]
        face = _FACES[self.fmi_version]
        self._face = hooked(face, hooks) if hooks else face
        self.token: str = description.guid
        self.model_identifier: str = interface.modelIdentifier
        self.can_get_and_set_state: bool = interface.canGetAndSetFMUstate
        self.can_serialize_state: bool = interface.canSerializeFMUstate
        self.once_per_process: bool = interface.canBeInstantiatedOnlyOncePerProcess
        self.variables: Mapping[str, Variable] = collect(path.name, description, self.names)
        self._description = description
        self.extra_outputs: tuple[str, ...] = extra_outputs(description, self.variables)
        self.folder = new_folder()
        self.close = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        unpack(path, self.folder)

    def has(self, name: str) -> bool:
        """Whether the FMU has this variable of ours."""
        return name in self.variables

    def listing(self, wanted: Collection[str]) -> str:
        """Tell on one line what the FMU has, those most like the wanted names first."""
        return listing(self._description, wanted)

    def look_for(self, parameters: Iterable[Parameter], *, optional: bool = False) -> None:
        """Add what the FMU has of the parameters of a friction law to its variables.

        Where they are `optional`, one that is of another kind or unit is another quantity with the
        same name, and is left alone; what the names file maps must be right.
        """
        for each in parameters:
            if self.has(each.name):
                continue
            wanted = {each.name: each.unit}
            try:
                added = collect_own(self.path.name, self._description, self.names, wanted)
            except FmuError:
                if not optional or each.name in self.names.targets:
                    raise
                continue
            self.variables = {**self.variables, **added}

    def instantiate(self) -> FmuInstance:
        """Make a new instance; `FmuError` if the FMU refuses."""
        return self._face(self)


def available(fmu: FmuFile, names: Iterable[str]) -> list[str]:
    """Of these names, those that the FMU has, in the same order."""
    return [name for name in names if fmu.has(name)]


def missing(fmu: FmuFile, names: Iterable[str] = REQUIRED) -> list[str]:
    """Of these names, those that the FMU lacks, in the same order."""
    return [name for name in names if not fmu.has(name)]


def require(fmu: FmuFile, names: Iterable[str] = REQUIRED) -> None:
    """Raise `FmuError` with the names that the FMU lacks and what to do, if it lacks any."""
    lacking = missing(fmu, names)
    if lacking:
        them = "them" if len(lacking) > 1 else "it"
        raise FmuError(
            f"{fmu.path}: has no variable {', '.join(lacking)}; map {them} with --names "
            f"(`stickslip names` begins the file); {fmu.listing(lacking)}"
        )


def description_of(path: Path) -> Any:
    """Return the model description of an FMU as FMPy has it; `FmuError` for what is no FMU."""
    return _read(path)[0]


def _read(path: Path) -> tuple[Any, tuple[str, ...], StatedContract]:
    if not path.exists():
        raise FmuError(f"{path}: no such file")
    if not path.is_file():
        raise FmuError(f"{path}: not an FMU (not a file)")
    if not zipfile.is_zipfile(path):
        raise FmuError(f"{path}: not an FMU (not a zip archive)")
    problems: tuple[str, ...] = ()
    try:
        check_size(path)
        with zipfile.ZipFile(path) as archive:
            if DESCRIPTION not in archive.namelist():
                raise FmuError(f"{path}: not an FMU (no {DESCRIPTION} in it)")
            # FMPy would say this in words of its own, or of Python's.
            with archive.open(DESCRIPTION) as stream:
                # Without a number of bytes, zipfile unpacks more than the archive says.
                text = stream.read(MOST_DESCRIBED)
            root = ElementTree.fromstring(text)
            _check_description(path, root)
        try:
            description = fmpy.read_model_description(str(path))
        except fmpy.model_description.ValidationError as error:
            problems = tuple(
                " ".join(str(problem).split())[:_LONGEST_PROBLEM]
                for problem in error.problems[:_MOST_PROBLEMS]
            )
            description = fmpy.read_model_description(str(path), validate=False)
    except FmuError:
        raise
    except Exception as error:
        raise FmuError(f"{path}: not an FMU ({one_line(error)})") from None
    return description, problems, stated_contract(root)


def _check_description(path: Path, root: ElementTree.Element) -> None:
    """Refuse a description that is none, or is of another version of FMI."""
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise FmuError(f"{path}: not an FMU ({DESCRIPTION} is no model description)")
    if version[:3] not in _FACES:
        raise FmuError(f"{path}: is FMI {version}; this suite drives FMI 2.0 and 3.0")
    if root.find("CoSimulation") is None:
        kinds = {"ModelExchange": "model exchange", "ScheduledExecution": "scheduled execution"}
        others = [text for tag, text in kinds.items() if root.find(tag) is not None]
        has = f", only {' and '.join(others)}" if others else ""
        raise FmuError(f"{path}: has no co-simulation interface{has}")


def _check_platform(path: Path) -> None:
    platforms = fmpy.supported_platforms(str(path))
    if fmpy.platform not in platforms:
        binaries = [platform for platform in platforms if platform != "c-code"]
        has = ", ".join(binaries) if binaries else "no binary"
        raise FmuError(f"{path}: is not for this platform, {fmpy.platform}; it has {has}")
