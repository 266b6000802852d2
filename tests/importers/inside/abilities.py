"""Tries what an importer can do, by the importer's probes."""

import importlib
from typing import Any

TRIED_ON_THE_BLOCK = (
    "inputs",
    "parameters",
    "several",
    "reset",
    "state",
    "serialize",
    "variable_step",
    "units",
)


def tried(fmu: str, order: Any) -> dict[str, bool]:
    """Return what can be done, by name: first the kinds of variables, then what the block is for.

    `order` holds the importer, and by kind an FMU that has it and a value to set.
    """
    probes = _probes(order["importer"])
    kinds = {kind: probes.kind(*given) for kind, given in order["kinds"].items()}
    return kinds | {name: getattr(probes, name)(fmu) for name in TRIED_ON_THE_BLOCK}


def begin(fmu: str, importer: str) -> bool:
    """Return whether the FMU does two steps with an input changed between them."""
    return bool(_probes(importer).inputs(fmu))


def log(fmu: str, importer: str) -> None:
    """Have the FMU send a warning while the importer is asked for messages."""
    _probes(importer).log(fmu)


def refused(fmu: str, importer: str) -> str:
    """Give the FMU what it refuses; return what comes of it in the importer."""
    return str(_probes(importer).refused(fmu))


def refused_later(fmu: str, importer: str) -> str:
    """Set it between two steps; return what comes of it."""
    return str(_probes(importer).refused_later(fmu))


def _probes(importer: str) -> Any:
    # What an importer needs may be missing, so only the one that is tried is imported.
    return importlib.import_module(f".able_{importer}", __package__).PROBES
