"""Packs FMUs 2.0 as a system that is ready to run: SSP, System Structure and Parameterization 1.0.

The parameters are in it twice. `parameters.ssv` has one name for a number that several FMUs share,
and `parameters.ssm` says whose parameters it is. Each component has its own once more, for
importers that read no files of parameters.
"""

from pathlib import Path
from typing import Any, Dict, Mapping, NamedTuple, Sequence, Tuple, Union
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement
from zipfile import ZipFile

from .packer import write_archive

Values = Mapping[str, Mapping[str, Union[int, float]]]
"""Start values by component and variable, SI."""

SET = "parameters"
"""Name of each set of parameters."""

_FOLDER = "resources"
_SPACES = {
    "ssc": "Common",
    "ssd": "Description",
    "ssm": "ParameterMapping",
    "ssv": "ParameterValues",
}
_SSP = "http://ssp-standard.org/SSP1/SystemStructure"


class _Fmu(NamedTuple):
    """Causality, type and unit of the variables of an FMU; base units of its units by name."""

    variables: Dict[str, Tuple[str, str, Dict[str, str]]]
    units: Dict[str, Dict[str, str]]


def write_ssp(
    target: Path, fmus: Mapping[str, Path], wires: Sequence[str], values: Values, stop_time: float
) -> Path:
    """Write an SSP file and return it.

    Parameters
    ----------
    target
        The file; its stem names the system.
    fmus
        FMUs built with `packer`, by component. Several components may share one.
    wires
        Connections, such as "drive.v table.v".
    values
        Start values.
    stop_time
        End of the default experiment [s].

    Raises
    ------
    KeyError
        If an FMU has not a variable that a value is for.
    OSError
        If an FMU cannot be read or the file not written.
    """
    read = {name: _read(file) for name, file in fmus.items()}
    units = {unit: base for fmu in read.values() for unit, base in fmu.units.items()}
    root = _element("ssd:SystemStructureDescription", version="1.0", name=target.stem)
    system = _add(root, "ssd:System", name=target.stem)
    binding = _add(_add(system, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    binding.set("source", f"{_FOLDER}/{SET}.ssv")
    _add(binding, "ssd:ParameterMapping", source=f"{_FOLDER}/{SET}.ssm")
    elements = _add(system, "ssd:Elements")
    driven = {wire.split()[1] for wire in wires}
    for name, fmu in read.items():
        source = f"{_FOLDER}/{fmus[name].name}"
        kind = {"type": "application/x-fmu-sharedlibrary", "implementation": "CoSimulation"}
        component = _add(elements, "ssd:Component", name=name, source=source, **kind)
        connectors = _add(component, "ssd:Connectors")
        for variable, (causality, type_, unit) in fmu.variables.items():
            # FMPy 0.3.32 gives an input that nothing drives the value of another one.
            if causality == "output" or f"{name}.{variable}" in driven:
                connector = _add(connectors, "ssd:Connector", name=variable, kind=causality)
                _add(connector, f"ssc:{type_}", **unit)
        own = _add(_add(component, "ssd:ParameterBindings"), "ssd:ParameterBinding")
        own = _add(_add(own, "ssd:ParameterValues"), "ssv:ParameterSet", version="1.0", name=SET)
        own = _add(own, "ssv:Parameters")
        for variable, value in values.get(name, {}).items():
            _add_value(own, variable, value, fmu.variables[variable])
    connections = _add(system, "ssd:Connections")
    for wire in wires:
        start, end = (each.split(".") for each in wire.split())
        ends = {"startElement": start[0], "startConnector": start[1]}
        ends.update(endElement=end[0], endConnector=end[1])
        _add(connections, "ssd:Connection", **ends)
    _add_units(_add(root, "ssd:Units"), units)
    _add(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(float(stop_time)))

    shared = _element("ssv:ParameterSet", version="1.0", name=SET)
    parameters = _add(shared, "ssv:Parameters")
    mapping = _element("ssm:ParameterMapping", version="1.0")
    for name, places in _names(fmus, values).items():
        holder, variable = places[0].split(".")
        described = read[holder].variables[variable]
        _add_value(parameters, name, values[holder][variable], described)
        for place in places:
            _add(mapping, "ssm:MappingEntry", source=name, target=place)
    _add_units(_add(shared, "ssv:Units"), units)
    entries = {
        "SystemStructure.ssd": _text(root),
        f"{_FOLDER}/{SET}.ssv": _text(shared),
        f"{_FOLDER}/{SET}.ssm": _text(mapping),
        **{f"{_FOLDER}/{file.name}": file.read_bytes() for file in fmus.values()},
    }
    write_archive(entries, target)
    return target


def _read(file: Path) -> _Fmu:
    with ZipFile(file) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
    return _Fmu(
        {
            row.attrib["name"]: (
                row.attrib["causality"],
                row[0].tag,
                {name: row[0].attrib[name] for name in ("unit",) if name in row[0].attrib},
            )
            for row in root.iter("ScalarVariable")
        },
        {unit.attrib["name"]: dict(unit[0].attrib) for unit in root.iter("Unit")},
    )


def _names(fmus: Mapping[str, Path], values: Values) -> Dict[str, Sequence[str]]:
    """Return what each name of the set stands for: one variable, or equal ones of several FMUs."""
    names: Dict[str, Sequence[str]] = {}
    for variable in dict.fromkeys(name for own in values.values() for name in own):
        holders = [component for component, own in values.items() if variable in own]
        targets = [f"{component}.{variable}" for component in holders]
        one = len({values[each][variable] for each in holders}) == 1
        if one and len({fmus[each] for each in holders}) == len(holders):
            names[variable] = targets
        else:
            names.update((target, [target]) for target in targets)
    return names


def _element(tag: str, **attributes: str) -> Element:
    return Element(_tag(tag), attributes)


def _add(parent: Element, tag: str, **attributes: str) -> Element:
    return SubElement(parent, _tag(tag), attributes)


def _tag(tag: str) -> str:
    prefix, name = tag.split(":")
    return f"{{{_SSP}{_SPACES[prefix]}}}{name}"


def _add_value(parent: Element, name: str, value: Union[int, float], variable: Any) -> None:
    _, type_, unit = variable
    number = repr(float(value)) if type_ == "Real" else repr(value)
    _add(_add(parent, "ssv:Parameter", name=name), f"ssv:{type_}", value=number, **unit)


def _add_units(parent: Element, units: Mapping[str, Mapping[str, str]]) -> None:
    for name, base in units.items():
        _add(_add(parent, "ssc:Unit", name=name), "ssc:BaseUnit", **base)


def _text(root: Element) -> bytes:
    for prefix, name in _SPACES.items():
        ElementTree.register_namespace(prefix, _SSP + name)
    ElementTree.indent(root)
    return ElementTree.tostring(root, "unicode", xml_declaration=True).encode()
