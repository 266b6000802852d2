"""Packs FMUs 2.0 as a system that is ready to run: SSP, System Structure and Parameterization 1.0.

The parameters are in it twice. `parameters.ssv` has one name for a number that several FMUs share,
and `parameters.ssm` says whose parameters it is. Each component has its own once more, for
importers that read no files of parameters.
"""

from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement
from zipfile import ZipFile

from .packer import write_archive

Values = Mapping[str, Mapping[str, Union[int, float]]]
"""Start values by component and variable, SI."""

_SSP = "http://ssp-standard.org/SSP1/SystemStructure"
_KINDS = {"c": "Common", "d": "Description", "m": "ParameterMapping", "v": "ParameterValues"}
_SPACES = {f"ss{letter}": _SSP + name for letter, name in _KINDS.items()}
_SET = {"version": "1.0", "name": "parameters"}
_FMU = {"type": "application/x-fmu-sharedlibrary", "implementation": "CoSimulation"}


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
        Start values of variables that the FMUs have.
    stop_time
        End of the default experiment [s].
    """
    described = {name: _description(file) for name, file in fmus.items()}
    rows = {
        f"{name}.{row.get('name')}": row
        for name, description in described.items()
        for row in description.iter("ScalarVariable")
    }
    root = _add(None, "ssd:SystemStructureDescription", version="1.0", name=target.stem)
    system = _add(root, "ssd:System", name=target.stem)
    binding = _add(_add(system, "ssd:ParameterBindings"), "ssd:ParameterBinding")
    binding.set("source", "resources/parameters.ssv")
    _add(binding, "ssd:ParameterMapping", source="resources/parameters.ssm")
    elements = _add(system, "ssd:Elements")
    driven = [wire.split()[1] for wire in wires]
    for name, file in fmus.items():
        source = f"resources/{file.name}"
        component = _add(elements, "ssd:Component", name=name, source=source, **_FMU)
        connectors = _add(component, "ssd:Connectors")
        for place, row in rows.items():
            holder, _, variable = place.partition(".")
            kind = row.attrib["causality"]
            # FMPy 0.3.32 gives an input that nothing drives the value of another one.
            if holder == name and (kind == "output" or place in driven):
                connector = _add(connectors, "ssd:Connector", name=variable, kind=kind)
                _add(connector, f"ssc:{row[0].tag}", **_unit(row))
        own = _add(_add(component, "ssd:ParameterBindings"), "ssd:ParameterBinding")
        own = _add(_add(own, "ssd:ParameterValues"), "ssv:ParameterSet", **_SET)
        own = _add(own, "ssv:Parameters")
        for variable, value in values[name].items():
            _add_value(own, variable, value, rows[f"{name}.{variable}"])
    connections = _add(system, "ssd:Connections")
    for wire in wires:
        names = ("startElement", "startConnector", "endElement", "endConnector")
        _add(connections, "ssd:Connection", **dict(zip(names, wire.replace(".", " ").split())))

    shared, mapping = _add(None, "ssv:ParameterSet", **_SET), _add(None, "ssm:ParameterMapping")
    mapping.set("version", "1.0")
    parameters = _add(shared, "ssv:Parameters")
    for name, places in _names(fmus, values).items():
        holder, _, variable = places[0].partition(".")
        _add_value(parameters, name, values[holder][variable], rows[places[0]])
        for place in places:
            _add(mapping, "ssm:MappingEntry", source=name, target=place)
    for units in (_add(root, "ssd:Units"), _add(shared, "ssv:Units")):
        known = {unit.get("name"): unit for own in described.values() for unit in own.iter("Unit")}
        for unit in known.values():
            base = _add(units, "ssc:Unit", name=unit.attrib["name"])
            _add(base, "ssc:BaseUnit", **unit[0].attrib)
    _add(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(float(stop_time)))
    texts = {"SystemStructure.ssd": root, "resources/parameters.ssv": shared}
    texts["resources/parameters.ssm"] = mapping
    files = {f"resources/{file.name}": file.read_bytes() for file in fmus.values()}
    write_archive({**files, **{name: _text(tree) for name, tree in texts.items()}}, target)
    return target


def _description(file: Path) -> Element:
    with ZipFile(file) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def _names(fmus: Mapping[str, Path], values: Values) -> Dict[str, List[str]]:
    """Return what each name of the set stands for: one variable, or equal ones of several FMUs."""
    names: Dict[str, List[str]] = {}
    for variable in dict.fromkeys(name for own in values.values() for name in own):
        holders = [component for component, own in values.items() if variable in own]
        targets = [f"{component}.{variable}" for component in holders]
        numbers = {values[each][variable] for each in holders}
        if len(numbers) == 1 and len({fmus[each] for each in holders}) == len(holders):
            names[variable] = targets
        else:
            names.update((target, [target]) for target in targets)
    return names


def _add(parent: Optional[Element], tag: str, **attributes: str) -> Element:
    """Return a new element, in its parent if it has one."""
    prefix, name = tag.split(":")
    tag = f"{{{_SPACES[prefix]}}}{name}"
    return Element(tag, attributes) if parent is None else SubElement(parent, tag, attributes)


def _add_value(parent: Element, name: str, value: Any, row: Element) -> None:
    text = repr(float(value)) if row[0].tag == "Real" else repr(value)
    parameter = _add(parent, "ssv:Parameter", name=name)
    _add(parameter, f"ssv:{row[0].tag}", value=text, **_unit(row))


def _unit(row: Element) -> Dict[str, str]:
    return {name: text for name, text in row[0].attrib.items() if name == "unit"}


def _text(root: Element) -> bytes:
    for prefix, space in _SPACES.items():
        ElementTree.register_namespace(prefix, space)
    ElementTree.indent(root)
    return ElementTree.tostring(root, "unicode", xml_declaration=True).encode()
