"""The system of both FMUs, made from an axis file: ServoDrive.fmu, StickSlip.fmu, FeedAxis.ssp."""

from __future__ import annotations

from pathlib import Path

from fmi.system import Values
from stickslip.systems import Move, build_driver, start_values, write_system
from stickslip_design.axis import Axis
from stickslip_fmu.packer import build as build_block
from stickslip_native.packer import build as build_native


def build_all(folder: Path, axis: Axis, move: Move, *, native: bool = False) -> Path:
    """Write both FMUs and FeedAxis.ssp into a folder; return the path of the latter.

    A `native` table is compiled for this machine and has the name of the other one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if native:
        build_native(folder / "StickSlip.fmu", this_machine=True)
    else:
        build_block(folder)
    build_driver("drive", folder)
    return write_ssp(folder / "FeedAxis.ssp", start_values(axis, move), folder)


def write_ssp(target: Path, values: Values, fmus: Path) -> Path:
    """Write an SSP file of StickSlip.fmu and ServoDrive.fmu in the folder `fmus`; return it."""
    return write_system("drive", target, values, fmus / "StickSlip.fmu", fmus / "ServoDrive.fmu")
