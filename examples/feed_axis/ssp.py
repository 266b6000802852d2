"""Writes FeedAxis.ssp: both FMUs, how they are wired, and the numbers of the axis."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final
from xml.etree.ElementTree import Element, SubElement, indent, register_namespace, tostring

from fmi.packer import write_archive

from .axis import Axis

_SSP: Final = "http://ssp-standard.org/SSP1/SystemStructure"
_SSC, _SSD, _SSV = (f"{{{_SSP}{part}}}" for part in ("Common", "Description", "ParameterValues"))

# Name of the component, its FMU, and its connectors: kind and unit by name.
TABLE: Final = "table"
DRIVE: Final = "drive"
_FMUS: Final = {TABLE: "StickSlip.fmu", DRIVE: "ServoDrive.fmu"}
_CONNECTORS: Final = {
    TABLE: {
        "v": "input m/s",
        "F": "output N",
        "x": "output m",
        "x_dot": "output m/s",
        "delta_x": "output m",
    },
    DRIVE: {
        "F": "input N",
        "x": "input m",
        "v": "output m/s",
        "x_motor": "output m",
        "x_command": "output m",
        "F_motor": "output N",
    },
}
_CONNECTIONS: Final = (
    (DRIVE, "v", TABLE, "v"),
    (TABLE, "F", DRIVE, "F"),
    (TABLE, "x", DRIVE, "x"),
)
_UNITS: Final = {
    "m": {"m": "1"},
    "m/s": {"m": "1", "s": "-1"},
    "N": {"kg": "1", "m": "1", "s": "-2"},
}

OUTPUTS: Final = tuple(
    f"{component}.{name}"
    for component, connectors in _CONNECTORS.items()
    for name, words in connectors.items()
    if words.startswith("output")
)
"""What every master records, as component.variable."""

PARAMETER_SET: Final = "axis"
"""Name of the parameter set, which ecos asks for."""

_INLINE: Final = f"{_SSD}ParameterValues"


def write_ssp(target: Path, axis: Axis, fmus: Path) -> Path:
    """Write the SSP file and return its path.

    Parameters
    ----------
    target
        The file, ending in .ssp.
    axis
        The numbers that go into parameters.ssv.
    fmus
        Folder with StickSlip.fmu and ServoDrive.fmu.
    """
    for prefix, space in (("ssc", _SSC), ("ssd", _SSD), ("ssv", _SSV)):
        register_namespace(prefix, space.strip("{}"))
    values = {TABLE: axis.of_table(), DRIVE: axis.of_drive()}
    entries = {
        "SystemStructure.ssd": _document(_structure(values)),
        "parameters.ssv": _document(_of_system(values)),
        **{f"resources/{name}": (fmus / name).read_bytes() for name in _FMUS.values()},
    }
    write_archive(entries, target)
    return target


def _structure(values: Mapping[str, Mapping[str, float]]) -> Element:
    root = Element(f"{_SSD}SystemStructureDescription", {"version": "1.0", "name": "FeedAxis"})
    system = SubElement(root, f"{_SSD}System", {"name": "FeedAxis"})
    bindings = SubElement(system, f"{_SSD}ParameterBindings")
    SubElement(bindings, f"{_SSD}ParameterBinding", {"source": "parameters.ssv"})
    elements = SubElement(system, f"{_SSD}Elements")
    for name, fmu in _FMUS.items():
        component = SubElement(
            elements,
            f"{_SSD}Component",
            {
                "name": name,
                "type": "application/x-fmu-sharedlibrary",
                "source": f"resources/{fmu}",
            },
        )
        connectors = SubElement(component, f"{_SSD}Connectors")
        for variable, words in _CONNECTORS[name].items():
            kind, unit = words.split()
            connector = SubElement(connectors, f"{_SSD}Connector", {"name": variable, "kind": kind})
            SubElement(connector, f"{_SSC}Real", {"unit": unit})
        # The same numbers once more: ecos and libcosim read no .ssv file.
        bindings = SubElement(component, f"{_SSD}ParameterBindings")
        inline = SubElement(SubElement(bindings, f"{_SSD}ParameterBinding"), _INLINE)
        inline.append(_parameter_set(values[name]))
    connections = SubElement(system, f"{_SSD}Connections")
    names = ("startElement", "startConnector", "endElement", "endConnector")
    for connection in _CONNECTIONS:
        SubElement(connections, f"{_SSD}Connection", dict(zip(names, connection, strict=True)))
    units = SubElement(root, f"{_SSD}Units")
    for unit, base in _UNITS.items():
        element = SubElement(units, f"{_SSC}Unit", {"name": unit})
        SubElement(element, f"{_SSC}BaseUnit", base)
    return root


def _of_system(values: Mapping[str, Mapping[str, float]]) -> Element:
    return _parameter_set(
        {
            f"{component}.{name}": value
            for component, own in values.items()
            for name, value in own.items()
        }
    )


def _parameter_set(values: Mapping[str, float]) -> Element:
    root = Element(f"{_SSV}ParameterSet", {"version": "1.0", "name": PARAMETER_SET})
    parameters = SubElement(root, f"{_SSV}Parameters")
    for name, value in values.items():
        parameter = SubElement(parameters, f"{_SSV}Parameter", {"name": name})
        kind = "Integer" if isinstance(value, int) else "Real"
        SubElement(parameter, f"{_SSV}{kind}", {"value": repr(value)})
    return root


def _document(root: Element) -> bytes:
    indent(root)
    text: bytes = tostring(root, encoding="UTF-8", xml_declaration=True)
    return text
