"""An FMU as a file: extracted once, its description read, its variables found by our names."""

from __future__ import annotations

import shutil
import weakref
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import fmpy

from stickslip_verification.drive.fmu.description import Description, read_description
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FACES, FmuInstance, hooked
from stickslip_verification.drive.fmu.names import UNITS, NameMap, Variable, collect
from stickslip_verification.drive.fmu.unpacking import new_folder, unpack
from stickslip_verification.truth.parameters import Parameter

if TYPE_CHECKING:
    from stickslip_verification.suite.faults import Hook

REQUIRED: tuple[str, ...] = ("m", "k", "mu_s", "mu_k", "v", "x")
"""What an FMU must have to be judged as a stick-slip block at all."""


class FmuFile(Description):
    """An FMU, extracted to ``folder`` until `close` or the end of this object, and its description.

    ``variables`` are ours, by our names; ``extra_outputs`` are none of ours, by the FMU's names.
    `hooks` are faults planted between the master and its instances. With `own_starts` a case leaves
    parameters that it does not name at the FMU's start values; None for where the FMU promises
    them: its description names the exact contract, and no names differ.

    `FmuError` if it is none for co-simulation by FMI 2.0 or 3.0 on this platform, if it has too
    much to unpack, or a variable of ours that cannot be used, see `collect`.
    """

    def __init__(
        self,
        path: Path,
        names: NameMap | None = None,
        hooks: Sequence[Hook] = (),
        *,
        own_starts: bool | None = None,
    ) -> None:
        super().__init__(**vars(read_description(path)))
        self.path = path
        self.names = NameMap() if names is None else names
        promised = self.stated.exact and not self.names.targets
        self.own_starts = promised if own_starts is None else own_starts
        platforms = fmpy.supported_platforms(str(path))
        if fmpy.platform not in platforms:
            has = ", ".join(each for each in platforms if each != "c-code") or "no binary"
            raise FmuError(f"{path}: is not for this platform, {fmpy.platform}; it has {has}")
        self._face = hooked(FACES[self.fmi_version], hooks)
        self.variables: Mapping[str, Variable] = collect(path.name, self, self.names, UNITS)
        known = {variable.their_name for variable in self.variables.values()}
        self.extra_outputs = tuple(
            name
            for name, each in self.declared.items()
            if each.causality == "output" and name not in known
        )
        self.folder = new_folder()
        self.close = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
        unpack(path, self.folder)

    def has(self, name: str) -> bool:
        """Whether the FMU has this variable of ours."""
        return name in self.variables

    def look_for(self, parameters: Iterable[Parameter], *, optional: bool = False) -> None:
        """Add what the FMU has of the parameters of a friction law to its variables.

        Where they are `optional`, one that is of another kind or unit is another quantity with the
        same name, and is left alone; what the names file maps must be right.
        """
        for each in parameters:
            if self.has(each.name):
                continue
            try:
                own = collect(self.path.name, self, self.names, {each.name: each.unit})
            except FmuError:
                if not optional or each.name in self.names.targets:
                    raise
            else:
                self.variables = {**self.variables, **own}

    def __reduce__(self) -> tuple[type[FmuFile], tuple[Path, NameMap]]:
        """Pickle the path and the names: whoever reads it extracts the FMU anew."""
        return FmuFile, (self.path.absolute(), self.names)

    def instantiate(self) -> FmuInstance:
        """Make a new instance; `FmuError` if the FMU refuses."""
        return self._face(self)


def available(fmu: FmuFile, names: Iterable[str]) -> list[str]:
    """Return those of the names that the FMU has, in the same order."""
    return [name for name in names if fmu.has(name)]


def require(fmu: FmuFile) -> None:
    """Raise `FmuError` with what the FMU lacks of `REQUIRED` and what to do, if it lacks any."""
    lacking = [name for name in REQUIRED if not fmu.has(name)]
    if lacking:
        them = "them" if len(lacking) > 1 else "it"
        raise FmuError(
            f"{fmu.path}: has no variable {', '.join(lacking)}; map {them} with --names "
            f"(`stickslip names` begins the file); {fmu.listing(lacking)}"
        )
