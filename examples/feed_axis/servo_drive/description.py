"""The FMI 2.0 model description of the drive, made from the variable table."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from .variables import VALUE_REFERENCES, VARIABLES, Variable

MODEL = "ServoDrive"

# SI exponents, and the unit a person may rather read with its factor.
_UNITS: dict[str, tuple[dict[str, int], tuple[str, float]]] = {
    "kg.m2": ({"kg": 1, "m": 2}, ("kg.cm2", 1e4)),
    "m": ({"m": 1}, ("mm", 1e3)),
    "s": ({"s": 1}, ("ms", 1e3)),
    "m/s": ({"m": 1, "s": -1}, ("mm/s", 1e3)),
    "m/s2": ({"m": 1, "s": -2}, ("mm/s2", 1e3)),
    "1/s": ({"s": -1}, ("1/min", 60.0)),
    "N": ({"kg": 1, "m": 1, "s": -2}, ("kN", 1e-3)),
    "N/m": ({"kg": 1, "s": -2}, ("N/um", 1e-6)),
    "N.s/m": ({"kg": 1, "s": -1}, ("kN.s/m", 1e-3)),
    "1": ({}, ("%", 100.0)),
}

_CAPABILITIES = {
    "modelIdentifier": MODEL,
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "false",
    "canSerializeFMUstate": "false",
}


def model_description(guid: str, generator: str) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    guid
        Identifies the content.
    generator
        Name and version of what wraps the slave.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": MODEL,
            "guid": guid,
            "description": "A servo drive: inertia, digital position and velocity control",
            "license": "MIT",
            "generationTool": generator,
            "variableNamingConvention": "flat",
        },
    )
    SubElement(root, "CoSimulation", _CAPABILITIES)
    units = SubElement(root, "UnitDefinitions")
    for name, (base, (shown, factor)) in _UNITS.items():
        unit = SubElement(units, "Unit", {"name": name})
        SubElement(unit, "BaseUnit", {each: str(power) for each, power in base.items()})
        SubElement(unit, "DisplayUnit", {"name": shown, "factor": repr(factor)})
    step = repr(VARIABLES[VALUE_REFERENCES["T_s"]].start)
    SubElement(root, "DefaultExperiment", {"startTime": "0.0", "stepSize": step})
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(VARIABLES):
        _add(variables, reference, variable)
    known = SubElement(SubElement(root, "ModelStructure"), "Outputs")
    for index, variable in enumerate(VARIABLES, start=1):
        if variable.causality == "output":
            # What is set acts from the next step on, so no output feeds through.
            SubElement(known, "Unknown", {"index": str(index), "dependencies": ""})
    return root


def _add(parent: Element, reference: int, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != "input":
        attributes["initial"] = "exact"
    typed = SubElement(SubElement(parent, "ScalarVariable", attributes), variable.kind)
    if variable.unit:
        typed.set("unit", variable.unit)
    for key, value in (("min", variable.minimum), ("max", variable.maximum)):
        if value is not None:
            typed.set(key, repr(value))
    typed.set("start", repr(variable.start))
