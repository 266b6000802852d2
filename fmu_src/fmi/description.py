"""The model description of FMI 2.0 and 3.0, made from the variable table."""

import hashlib
import os
import uuid
from datetime import datetime, timezone
from typing import (
    Any,
    Dict,
    Iterable,
    Iterator,
    List,
    Literal,
    Mapping,
    NamedTuple,
    Optional,
    Tuple,
)
from xml.etree.ElementTree import Element, SubElement

from .model import Spec
from .table import Quantity, Table, Unit, Variable

Face = Literal[2, 3]
"""The major version of FMI."""

_CAPABILITIES: Dict[Face, Dict[str, str]] = {
    2: {
        "needsExecutionTool": "false",
        "canHandleVariableCommunicationStepSize": "true",
        "canInterpolateInputs": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    },
    3: {
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "canHandleVariableCommunicationStepSize": "true",
        "providesIntermediateUpdate": "false",
        "mightReturnEarlyFromDoStep": "true",
        "canReturnEarlyAfterIntermediateUpdate": "false",
        "hasEventMode": "true",
    },
}


_OF_BOTH = (
    "needsExecutionTool",
    "canBeInstantiatedOnlyOncePerProcess",
    "canNotUseMemoryManagementFunctions",
    "canGetAndSetFMUstate",
    "canSerializeFMUstate",
    "canGetAndSetFMUState",
    "canSerializeFMUState",
)


class Equations(NamedTuple):
    """What a solver of the simulator's integrates, by model exchange.

    Attributes
    ----------
    states
        The continuous states in their order, outputs all, and the variable of each derivative.
    indicators
        Local variables whose changes of sign are events.
    local
        Quantity and description of the variables that the table does not have. Their value
        references follow that of the time.
    units
        Units that the table has not.
    depends
        States and inputs that outputs, derivatives and indicators depend on between events.
    """

    states: Mapping[str, str]
    indicators: Tuple[str, ...]
    local: Mapping[str, Tuple[Quantity, str]]
    units: Mapping[str, Unit]
    depends: Mapping[str, Tuple[str, ...]]


def identity(content: str) -> str:
    """Return the GUID that goes with a digest of the FMU's content.

    In braces and 8-4-4-4-12 digits, as importers know it.
    """
    return f"{{{uuid.UUID(bytes=hashlib.sha256(content.encode()).digest()[:16])}}}"


def model_description(
    spec: Spec,
    face: Face,
    identity: str,
    generator: str,
    refusals: str = "",
    sources: Iterable[str] = (),
    equations: Optional[Equations] = None,
    moving: Tuple[str, ...] = (),
) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    spec
        The model.
    face
        The major version of FMI.
    identity
        The GUID of FMI 2.0, the instantiation token of FMI 3.0; no binary compares it.
    generator
        Name and version of the tool that makes the FMU.
    refusals
        Meaning of the errors in the log; "" where the FMU logs none.
    sources
        Files in sources/ that have to be compiled, for FMI 2.0.
    equations
        What the FMU has for model exchange, None for nothing. An FMU of FMI 2.0 has this interface
        alone then.
    moving
        Inputs of co-simulation that may move within a step.

    Raises
    ------
    ValueError
        If the name of the model is no identifier, or SOURCE_DATE_EPOCH is set to something else
        than whole seconds.
    """
    if not spec.name.isidentifier():
        raise ValueError(f"the model name {spec.name!r} is no Python identifier")
    table = spec.table
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": f"{face}.0",
            "modelName": spec.name,
            "guid" if face == 2 else "instantiationToken": identity,
            "description": spec.description,
            "author": spec.author,
            "version": spec.version,
            "copyright": spec.author,
            "license": spec.licence,
            "generationTool": generator,
            "generationDateAndTime": _generation_time(spec.date),
            "variableNamingConvention": "flat",
        },
    )
    able = dict(_CAPABILITIES[face])
    if moving:
        able["canInterpolateInputs" if face == 2 else "providesIntermediateUpdate"] = "true"
    interfaces = {"CoSimulation": able}
    if equations is not None:
        both = {name: able[name] for name in _OF_BOTH if name in able}
        interfaces = {"ModelExchange": both} if face == 2 else {"ModelExchange": both, **interfaces}
    for name, attributes in interfaces.items():
        slave = SubElement(root, name, {"modelIdentifier": spec.name, **attributes})
        _add(slave, "SourceFiles", (Element("File", {"name": name}) for name in sources))
    _add(root, "UnitDefinitions", _units({**table.units, **(equations.units if equations else {})}))
    _add(root, "TypeDefinitions", _types(table, face))
    _add(root, "LogCategories", _log_categories(refusals))
    times = zip(("startTime", "stopTime", "stepSize"), spec.experiment)
    experiment = {name: repr(value) for name, value in times if value is not None}
    SubElement(root, "DefaultExperiment", experiment)
    if face == 2:
        _add(root, "VendorAnnotations", _annotations(spec, "Tool", "name"))
    variables = SubElement(root, "ModelVariables")
    variables.extend(_variables(table, face, equations is not None))
    for variable in variables if face == 3 else ():
        if variable.attrib["name"] in moving:
            variable.set("intermediateUpdate", "true")
    structure = SubElement(root, "ModelStructure")
    _add_structure(structure, table, face)
    if equations is not None:
        _add_equations(variables, structure, table, equations, face)
        if face == 2:
            root.set("numberOfEventIndicators", str(len(equations.indicators)))
    if face == 3:
        _add(root, "Annotations", _annotations(spec, "Annotation", "type"))
    return root


def _generation_time(release: str) -> str:
    """Return the date of the build: SOURCE_DATE_EPOCH where it is set, else that of the release."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if not epoch:
        return release
    if not epoch.isdecimal():
        raise ValueError(f"SOURCE_DATE_EPOCH = {epoch!r}: expected whole seconds since 1970")
    moment = datetime.fromtimestamp(int(epoch), timezone.utc)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def _add(parent: Element, tag: str, members: Iterable[Element]) -> None:
    """Add a list; the schemas forbid one without members."""
    listed = list(members)
    if listed:
        SubElement(parent, tag).extend(listed)


def _units(units: Mapping[str, Unit]) -> Iterator[Element]:
    for name, unit in units.items():
        element = Element("Unit", {"name": name})
        SubElement(element, "BaseUnit", {base: str(power) for base, power in unit.base.items()})
        for display, factor in unit.displays:
            SubElement(element, "DisplayUnit", {"name": display, "factor": repr(factor)})
        yield element


def _types(table: Table, face: Face) -> Iterator[Element]:
    for name, quantity in table.quantities.items():
        attributes = _type_attributes(quantity)
        if face == 2:
            element = Element("SimpleType", {"name": name})
            SubElement(element, quantity.kind, attributes)
        else:
            element = Element(f"{quantity.fmi3_type}Type", {"name": name, **attributes})
            for item in quantity.items:
                fields = {key: str(value) for key, value in item._asdict().items()}
                SubElement(element, "Item", fields)
        yield element


def _type_attributes(quantity: Quantity) -> Dict[str, str]:
    """Return the attributes of a type of Reals: quantity, units, order of magnitude."""
    if quantity.kind != "Real":
        return {}
    attributes = {
        "quantity": quantity.quantity,
        "unit": quantity.unit,
        "displayUnit": quantity.shown_in,
        "nominal": repr(quantity.nominal) if quantity.nominal else "",
    }
    return {name: text for name, text in attributes.items() if text}


def _log_categories(refusals: str) -> Iterator[Element]:
    meanings = {
        "logStatusWarning": "A value was taken, but not as it was given.",
        "logAll": "All messages.",
        "logStatusError": refusals,
    }
    for name, meaning in meanings.items():
        if meaning:
            yield Element("Category", {"name": name, "description": meaning})


def _annotations(spec: Spec, tag: str, key: str) -> Iterator[Element]:
    for annotation in spec.annotations:
        element = Element(tag, {key: annotation.type})
        SubElement(element, annotation.element, dict(annotation.attributes))
        yield element


def _variables(table: Table, face: Face, has_time: bool) -> Iterator[Element]:
    for variable in table.rows:
        attributes = {
            "name": variable.name,
            "valueReference": str(variable.number),
            "description": variable.description,
            "causality": variable.causality,
            "variability": variable.variability,
        }
        if variable.causality != "input":
            attributes["initial"] = "calculated" if variable.start is None else "exact"
        kind = variable.kind if face == 2 else variable.type.fmi3_type
        yield _variable(face, kind, attributes, _value_attributes(variable))
    if face == 3 or has_time:
        time = {
            "name": "time",
            "valueReference": str(table.time_reference),
            "description": "Time",
            "causality": "independent",
            "variability": "continuous",
        }
        of_type = {}
        if "Time" in table.quantities:
            of_type = {"declaredType": "Time", **_type_attributes(table.quantities["Time"])}
        yield _variable(face, "Real" if face == 2 else "Float64", time, of_type)


def _variable(
    face: Face, kind: str, attributes: Dict[str, str], of_type: Dict[str, str]
) -> Element:
    """Return a variable; in FMI 2.0 what belongs to its type is in an element of its own."""
    if face == 3:
        return Element(kind, {**attributes, **of_type})
    element = Element("ScalarVariable", attributes)
    SubElement(element, kind, of_type)
    return element


def _value_attributes(variable: Variable) -> Dict[str, str]:
    """Return type, bounds and start of a variable.

    The attributes of the type are repeated, for readers that do not look them up.
    """
    values: Dict[str, Any] = {
        "min": variable.minimum,
        "max": variable.maximum,
        "start": variable.start,
    }
    return {
        "declaredType": variable.type.name,
        **_type_attributes(variable.type),
        **{
            name: str(value).lower() if isinstance(value, bool) else repr(value)
            for name, value in values.items()
            if value is not None
        },
    }


def _add_structure(parent: Element, table: Table, face: Face) -> None:
    """Add outputs, none of which follows an input at once, and what is calculated at the start."""
    # FMI 2.0 names a variable by its position, counted from 1.
    key, first = ("index", 1) if face == 2 else ("valueReference", 0)
    outputs: List[Element] = []
    unknowns: List[Element] = []
    for row in table.rows:
        if row.causality != "output":
            continue
        name = {key: str(row.number + first)}
        outputs.append(Element("Unknown" if face == 2 else "Output", {**name, "dependencies": ""}))
        if row.start is None:
            numbers = sorted(table.by_name[known].number + first for known in row.depends)
            kind = "constant" if row.in_proportion else "dependent"
            dependencies = {
                "dependencies": " ".join(map(str, numbers)),
                "dependenciesKind": " ".join([kind] * len(numbers)),
            }
            tag = "Unknown" if face == 2 else "InitialUnknown"
            unknowns.append(Element(tag, {**name, **dependencies}))
    if face == 2:
        _add(parent, "Outputs", outputs)
        _add(parent, "InitialUnknowns", unknowns)
    else:
        parent.extend([*outputs, *unknowns])


def _add_equations(
    variables: Element, structure: Element, table: Table, equations: Equations, face: Face
) -> None:
    """Add states, derivatives and indicators, and what outputs depend on between events."""
    key, first = ("index", 1) if face == 2 else ("valueReference", 0)
    numbers = {row.name: row.number + first for row in table.rows}
    for n, (name, (quantity, description)) in enumerate(equations.local.items(), start=1):
        number = table.time_reference + n
        numbers[name] = number + first
        attributes = {"name": name, "valueReference": str(number), "description": description}
        attributes.update(causality="local", variability="continuous", initial="calculated")
        kind = "Real" if face == 2 else "Float64"
        variables.append(_variable(face, kind, attributes, _type_attributes(quantity)))
    rates = {rate: str(numbers[state]) for state, rate in equations.states.items()}
    for variable in variables:
        name, of_type = variable.attrib["name"], variable[0] if face == 2 else variable
        if name in rates:
            of_type.set("derivative", rates[name])
        if name in equations.states:
            of_type.set("reinit", "true")

    def unknown(tag: str, name: str) -> Element:
        knowns = sorted(numbers[on] for on in equations.depends[name])
        known = {key: str(numbers[name]), "dependencies": " ".join(map(str, knowns))}
        return Element("Unknown" if face == 2 else tag, known)

    outputs = structure if face == 3 else structure[0]
    names = {str(number): name for name, number in numbers.items()}
    for output in outputs:
        name = names[output.attrib[key]]
        if name in equations.depends and output.tag in ("Output", "Unknown"):
            output.set("dependencies", unknown("Output", name).attrib["dependencies"])
    derivatives = [unknown("ContinuousStateDerivative", name) for name in equations.states.values()]
    settable = " ".join(str(numbers[row.name]) for row in table.rows if row.settable)
    starts = [
        Element(
            "Unknown" if face == 2 else "InitialUnknown",
            {key: str(numbers[name]), "dependencies": settable},
        )
        for name in equations.states.values()
        if name in equations.local
    ]
    if face == 2:
        structure.insert(1, Element("Derivatives"))
        structure[1].extend(derivatives)
        structure[2].extend(starts)
    else:
        at = len(structure.findall("Output"))
        structure[at:at] = derivatives
        structure.extend(starts)
        structure.extend(unknown("EventIndicator", name) for name in equations.indicators)
