"""A foreign FMU 2.0 in C99: the exact block of `block.c`, in SI, compiled where it is wanted."""

from __future__ import annotations

import hashlib
from pathlib import Path

from tests.verification.foreign.building import HERE, pack_library

FAULTS = {"": 0, "push-lost-beside-load": 1, "reset-keeps-mass": 2}
"""Faults that can be planted, with their numbers in the source."""

UNITS = {
    "kg": 'kg="1"',
    "m": 'm="1"',
    "m/s": 'm="1" s="-1"',
    "m/s2": 'm="1" s="-2"',
    "N/m": 'kg="1" s="-2"',
    "N.s/m": 'kg="1" s="-1"',
    "N": 'kg="1" m="1" s="-2"',
    "s": 's="1"',
    "1": "",
}

# Name, unit, causality, variability, start of the Reals, by their value reference.
REALS = (
    ("Body.M", "kg", "parameter", "fixed", "1"),
    ("Body.Gravity", "m/s2", "parameter", "fixed", "9.81"),
    ("Body.Start.Position", "m", "parameter", "fixed", "0"),
    ("Body.Start.Velocity", "m/s", "parameter", "fixed", "0"),
    ("Spring.Start.Extension", "m", "parameter", "fixed", "0"),
    ("Spring.K", "N/m", "parameter", "tunable", "1000"),
    ("Way.D", "N.s/m", "parameter", "tunable", "0"),
    ("Way.MuStatic", "1", "parameter", "tunable", "0.5"),
    ("Way.MuKinetic", "1", "parameter", "tunable", "0.3"),
    ("Pull.Velocity", "m/s", "input", "continuous", "0.02"),
    ("Body.Load", "N", "input", "continuous", "0"),
    ("Body.Push", "N", "input", "continuous", "0"),
    ("Body.Position", "m", "output", "continuous", ""),
    ("Body.Velocity", "m/s", "output", "continuous", ""),
    ("Pull.Position", "m", "output", "continuous", ""),
    ("Spring.Extension", "m", "output", "continuous", ""),
    ("Spring.Force", "N", "output", "continuous", ""),
    ("Way.Force", "N", "output", "continuous", ""),
    ("Way.LastEvent", "s", "output", "discrete", ""),
)
OTHERS = (("Way.Direction", "Integer", 0), ("Way.Slips", "Integer", 1), ("Way.Stick", "Boolean", 0))


def build(folder: Path, name: str = "ExactInC", fault: str = "") -> Path:
    """Compile and pack the FMU, maybe with a fault in it."""
    options = ("-std=c99", "-O2", "-ffp-contract=off", f"-DFAULT={FAULTS[fault]}")
    return pack_library(HERE / "block.c", folder / f"{name}.fmu", _description(name), options)


def _description(name: str) -> str:
    units = "".join(
        f'<Unit name="{unit}"><BaseUnit {base}/></Unit>' for unit, base in UNITS.items()
    )
    variables, outputs = [], []
    for reference, (variable, unit, causality, variability, start) in enumerate(REALS):
        begin = f' start="{start}"' if start else ""
        variables.append(
            f'<ScalarVariable name="{variable}" valueReference="{reference}" '
            f'causality="{causality}" variability="{variability}">'
            f'<Real unit="{unit}"{begin}/></ScalarVariable>'
        )
    for variable, kind, reference in OTHERS:
        variables.append(
            f'<ScalarVariable name="{variable}" valueReference="{reference}" causality="output" '
            f'variability="discrete"><{kind}/></ScalarVariable>'
        )
    for index, variable in enumerate(variables, start=1):
        if 'causality="output"' in variable:
            outputs.append(f'<Unknown index="{index}" dependencies=""/>')
    guid = hashlib.sha256("".join(variables).encode()).hexdigest()
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        f'<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{guid}">'
        f'<CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true" '
        'canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>'
        f"<UnitDefinitions>{units}</UnitDefinitions>"
        f"<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure><Outputs>{''.join(outputs)}</Outputs>"
        f"<InitialUnknowns>{''.join(outputs)}</InitialUnknowns></ModelStructure>"
        "</fmiModelDescription>"
    )
