"""The system of both FMUs, made from an axis file: start values, ServoDrive.fmu, FeedAxis.ssp."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Final, NamedTuple

from fmi.packer import build_fmu, write_archive
from stickslip_design.axis import Axis
from stickslip_fmu.packer import build as build_block
from stickslip_native.packer import build as build_native

_CONNECTORS: Final = {
    "table": "v input m/s, F output N, x output m, x_dot output m/s, delta_x output m",
    "drive": "F input N, x input m, v output m/s, x_motor output m, x_command output m, "
    "F_motor output N",
}
"""Name, kind and unit of the connectors by component."""

_SAME: Final = (
    "pitch d T_s K_v K_p T_n dead_band velocity_feedforward friction_feedforward F_max "
    "resolution_motor resolution_table lag dead_time dry"
)
"""Parameters of ServoDrive.fmu that the drive of an axis has by the same name."""

Values = Mapping[str, Mapping[str, float]]
"""Start values of "table" and "drive" by variable, SI."""


class Move(NamedTuple):
    """The set point: speed [m/s], acceleration [m/s2], and way [m], 0 for a feed without end."""

    feed: float
    acceleration: float = 0.1
    distance: float = 0.0


def start_values(axis: Axis, move: Move) -> dict[str, dict[str, float]]:
    """Return the start values of both FMUs; the axis starts at rest.

    Raises
    ------
    ValueError
        If the two FMUs cannot be this axis: a rigid drive, friction that changes, a load, or more
        than one filter of a kind.
    """
    drive = axis.drive
    if drive is None or not axis.friction.constant or axis.load or axis.along:
        raise ValueError("the FMUs have a drive, constant coefficients of friction, and no load")
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
    return {
        "table": {"m": axis.m, "g": axis.g, "k": axis.k, "c": axis.c, **friction, "v": 0.0},
        "drive": {**values, "on_table": int(drive.on_table), "k": axis.k},
    }


def build_drive(folder: Path) -> Path:
    """Build ServoDrive.fmu of `servo_drive` and fmi in a folder and return its path."""
    main = "from examples.feed_axis.servo_drive.model import SPEC"
    return build_fmu(main, folder / "ServoDrive.fmu", "servo_drive_")


def build_all(folder: Path, axis: Axis, move: Move, *, native: bool = False) -> Path:
    """Write both FMUs and FeedAxis.ssp into a folder; return the path of the latter.

    A `native` table is compiled for this machine and has the name of the other one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if native:
        build_native(folder / "StickSlip.fmu", this_machine=True)
    else:
        build_block(folder)
    build_drive(folder)
    return write_ssp(folder / "FeedAxis.ssp", start_values(axis, move), folder)


def write_ssp(target: Path, values: Values, fmus: Path) -> Path:
    """Write an SSP file of StickSlip.fmu and ServoDrive.fmu in the folder `fmus`; return it."""
    of_system = {f"{name}.{each}": own[each] for name, own in values.items() for each in own}
    names = {"table": "StickSlip.fmu", "drive": "ServoDrive.fmu"}
    components = "".join(_component(name, names[name], values[name]) for name in names)
    entries = {
        "SystemStructure.ssd": _STRUCTURE.format(components).encode(),
        "parameters.ssv": (_XML + _parameter_set(of_system, _SPACES)).encode(),
        **{f"resources/{name}": (fmus / name).read_bytes() for name in names.values()},
    }
    write_archive(entries, target)
    return target


_XML: Final = "<?xml version='1.0' encoding='UTF-8'?>\n"
_SSP: Final = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACES: Final = f' xmlns:ssv="{_SSP}ParameterValues"'
_STRUCTURE: Final = f"""{_XML}<ssd:SystemStructureDescription xmlns:ssc="{_SSP}Common"
 xmlns:ssd="{_SSP}Description"{_SPACES} version="1.0" name="FeedAxis">
<ssd:System name="FeedAxis">
<ssd:ParameterBindings><ssd:ParameterBinding source="parameters.ssv" /></ssd:ParameterBindings>
<ssd:Elements>{{}}</ssd:Elements>
<ssd:Connections>
<ssd:Connection startElement="drive" startConnector="v" endElement="table" endConnector="v" />
<ssd:Connection startElement="table" startConnector="F" endElement="drive" endConnector="F" />
<ssd:Connection startElement="table" startConnector="x" endElement="drive" endConnector="x" />
</ssd:Connections>
</ssd:System>
<ssd:Units>
<ssc:Unit name="m"><ssc:BaseUnit m="1" /></ssc:Unit>
<ssc:Unit name="m/s"><ssc:BaseUnit m="1" s="-1" /></ssc:Unit>
<ssc:Unit name="N"><ssc:BaseUnit kg="1" m="1" s="-2" /></ssc:Unit>
</ssd:Units>
</ssd:SystemStructureDescription>
"""


def _component(name: str, fmu: str, values: Mapping[str, float]) -> str:
    connectors = "".join(
        f'<ssd:Connector name="{own}" kind="{kind}"><ssc:Real unit="{unit}" /></ssd:Connector>\n'
        for own, kind, unit in (each.split() for each in _CONNECTORS[name].split(","))
    )
    # The same numbers once more: ecos and libcosim read no .ssv file.
    return f"""
<ssd:Component name="{name}" type="application/x-fmu-sharedlibrary" source="resources/{fmu}">
<ssd:Connectors>
{connectors}</ssd:Connectors>
<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
{_parameter_set(values)}
</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
</ssd:Component>
"""


def _parameter_set(values: Mapping[str, float], spaces: str = "") -> str:
    """Return a set of parameters, whose name ecos asks for."""
    lines = [
        f'<ssv:Parameter name="{name}"><ssv:{kind} value="{value!r}" /></ssv:Parameter>'
        for name, value in values.items()
        for kind in ["Integer" if isinstance(value, int) else "Real"]
    ]
    parameters = "\n".join(("<ssv:Parameters>", *lines, "</ssv:Parameters>"))
    return f'<ssv:ParameterSet{spaces} version="1.0" name="axis">{parameters}</ssv:ParameterSet>'
