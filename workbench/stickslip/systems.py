"""Systems of the block that are ready to run, as SSP files: `stickslip build --ssp`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final, Literal, NamedTuple, TypeAlias

from fmi.packer import build_fmu
from fmi.system import Values, write_ssp
from stickslip_design.axis import Axis, axis_file_of, example, read_axis_file
from stickslip_fmu.interface import table_of
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law

System: TypeAlias = Literal["source", "drive", "pair"]
"""The block pulled by a source of speed, by a servo drive, and two blocks pulled by one."""

WIRES: Final[dict[System, tuple[str, ...]]] = {
    "source": ("source.v block.v",),
    "drive": ("drive.v table.v", "table.F drive.F", "table.x drive.x"),
    "pair": (
        *("drive.v first.v", "drive.v second.v", "first.F drive.F", "second.F drive.F_2"),
        "first.x drive.x",
    ),
}
"""Connections of each system, from output to input."""

_SAME: Final = (
    "pitch d T_s K_v K_p T_n dead_band velocity_feedforward friction_feedforward F_max "
    "resolution_motor resolution_table lag dead_time dry"
)
"""Parameters of ServoDrive.fmu that the drive of an axis has by the same name."""


class Move(NamedTuple):
    """The set point: speed [m/s], acceleration [m/s2], and way [m], 0 for a feed without end."""

    feed: float
    acceleration: float = 0.1
    distance: float = 0.0


def start_values(
    axis: Axis, move: Move, system: Literal["drive", "pair"] = "drive"
) -> dict[str, dict[str, float]]:
    """Return the start values of an axis, which starts at rest, by component and variable [SI].

    The second table of a pair has half the mass of the first, which is that of the axis.

    Raises
    ------
    ValueError
        If the FMUs cannot be this axis: a rigid drive, friction that changes, a load, or more than
        one filter of a kind.
    """
    drive = axis.drive
    if drive is None or not axis.friction.constant or axis.load or axis.along:
        raise ValueError("the FMUs have a drive, constant coefficients of friction, and no load")
    if axis.turns:
        raise ValueError("the FMUs are of a slide, in m and N: a rotary table has none")
    filters = {each.kind.replace(" ", "_"): each for each in drive.filters}
    if len(filters) < len(drive.filters):
        raise ValueError("ServoDrive.fmu has one low pass and one notch at most")
    values: dict[str, float] = {name: float(getattr(drive, name)) for name in _SAME.split()}
    for kind, each in filters.items():
        # A low pass of first order has the damping ratio 0 in the FMU.
        damping = each.damping if math.isfinite(each.damping) else 0.0
        values |= {kind: each.frequency, f"{kind}_damping": damping}
        values |= {"notch_depth": each.depth} if kind == "notch" else {}
    # To fewer digits than a double has: the inertia at the motor as it was typed.
    inertia = float(f"{drive.inertia * (drive.pitch / (2.0 * math.pi)) ** 2:.12g}")
    values |= {"J": inertia, "F_max": min(drive.F_max, 1e300), **move._asdict()}
    friction = {"mu_s": axis.friction.mu_s, "mu_k": axis.friction.mu_k}
    table = {"m": axis.m, "g": axis.g, "k": axis.k, "c": axis.c, **friction, "v": 0.0}
    tables = {"table": table}
    if system == "pair":
        tables = {"first": table, "second": {**table, "m": 0.5 * axis.m}}
    pulls = {**values, "on_table": int(drive.on_table), "k": len(tables) * axis.k}
    return {**tables, "drive": pulls}


def values_of(system: System, law: str, axis: Path | str | None) -> Values:
    """Return the start values of a system: of the axis in a file, by default the example.

    That with a source has the start values of the block's FMU, whatever its friction law.

    Raises
    ------
    ValueError
        If there is no such system, law or axis, or they do not go together.
    """
    if system not in WIRES:
        raise ValueError(f"there is no system {system!r}; there are {', '.join(WIRES)}")
    if system == "source":
        if axis is not None:
            raise ValueError("the system with a source has no axis; drive and pair have")
        rows = table_of(friction_law(law).law.interface).rows
        own = {row.name: row.start or 0 for row in rows if row.causality == "parameter"}
        return {"block": own, "source": {"feed": 0.02, "acceleration": 0.1, "distance": 0.0}}
    if law != COULOMB_NAME:
        raise ValueError(f"the table of an axis has Coulomb's friction law, not {law!r}")
    file = read_axis_file(axis) if axis is not None else axis_file_of(example())
    known = file.axis()
    feed = known.demand.feeds[0] if known.demand.feeds else Move(5e-4).feed
    return start_values(known, Move(feed, known.demand.acceleration or 0.1), system)


def driver_of(system: System, folder: Path) -> Path:
    """Return the FMU that pulls, SpeedSource.fmu or ServoDrive.fmu; a folder without gets it."""
    module, fmu = ("source", "SpeedSource") if system == "source" else ("model", "ServoDrive")
    file = folder / f"{fmu}.fmu"
    if not file.exists():
        build_fmu(f"from stickslip_drive.{module} import SPEC", file, "stickslip_drive_")
    return file


def write_system(system: System, target: Path, values: Values, block: Path) -> Path:
    """Write an SSP file with the block's FMU, and what pulls it from the same folder; return it."""
    driver = driver_of(system, block.parent)
    fmus = {name: driver if name in ("source", "drive") else block for name in values}
    return write_ssp(target, fmus, WIRES[system], values, 10.0 if system == "source" else 2.0)
