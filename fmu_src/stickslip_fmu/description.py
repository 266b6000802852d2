"""The FMI 2.0 model description, made from the variable table."""

import os
from datetime import datetime, timezone
from typing import Dict, Iterable, NamedTuple, Tuple
from xml.etree.ElementTree import Element, SubElement

from .release import DATE, VERSION
from .variables import VALUE_REFERENCES, VARIABLES, Variable

MODEL = "StickSlip"

DESCRIPTION = (
    "A mass pulled over dry friction through a spring: sticks, breaks away, slips, sticks again. "
    "Solved exactly from event to event, so no result depends on the communication step."
)


class Unit(NamedTuple):
    """A unit: its SI exponents, and the units a person may rather read with their factors."""

    base: Dict[str, int]
    displays: Tuple[Tuple[str, float], ...] = ()


_UNITS: Dict[str, Unit] = {
    "kg": Unit({"kg": 1}),
    "m": Unit({"m": 1}, (("mm", 1e3),)),
    "s": Unit({"s": 1}, (("ms", 1e3),)),
    "m/s": Unit({"m": 1, "s": -1}, (("mm/s", 1e3),)),
    "m/s2": Unit({"m": 1, "s": -2}),
    "N": Unit({"kg": 1, "m": 1, "s": -2}, (("kN", 1e-3),)),
    "N/m": Unit({"kg": 1, "s": -2}, (("N/mm", 1e-3),)),
    "N.s/m": Unit({"kg": 1, "s": -1}),
    "J": Unit({"kg": 1, "m": 2, "s": -2}, (("mJ", 1e3),)),
    "Hz": Unit({"s": -1}),
    "1": Unit({}),
}

# The display unit of a variable is the first one of its unit, for these units.
_SHOWN_OTHERWISE = ("m", "m/s")

_LOG_CATEGORIES = {
    "logStatusWarning": "A value was taken, but not as it was given.",
    "logAll": "All messages.",
}

_CAPABILITIES = {
    "modelIdentifier": MODEL,
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}

_EXPERIMENT = {"startTime": "0.0", "stopTime": "10.0", "stepSize": "0.01"}


def generation_time() -> str:
    """Return the build's date: SOURCE_DATE_EPOCH where it is set, else that of the release.

    Raises ValueError where that variable is no whole number of seconds.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if not epoch:
        return DATE
    if not epoch.isdecimal():
        raise ValueError(f"SOURCE_DATE_EPOCH = {epoch!r}: expected whole seconds since 1970")
    moment = datetime.fromtimestamp(int(epoch), timezone.utc)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def model_description(guid: str, generator: str) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    guid
        Identifies the content; the binary checks nothing against it.
    generator
        Name and version of what wraps the slave.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": MODEL,
            "guid": guid,
            "description": DESCRIPTION,
            "author": "The stickslip engineers",
            "version": VERSION,
            "copyright": "The stickslip engineers",
            "license": "MIT",
            "generationTool": generator,
            "generationDateAndTime": generation_time(),
            "variableNamingConvention": "flat",
        },
    )
    SubElement(root, "CoSimulation", _CAPABILITIES)
    _add_units(SubElement(root, "UnitDefinitions"))
    categories = SubElement(root, "LogCategories")
    for name, text in _LOG_CATEGORIES.items():
        SubElement(categories, "Category", {"name": name, "description": text})
    SubElement(root, "DefaultExperiment", _EXPERIMENT)
    variables = SubElement(root, "ModelVariables")
    for variable in VARIABLES:
        _add_variable(variables, variable)
    _add_structure(SubElement(root, "ModelStructure"))
    return root


def _add_units(parent: Element) -> None:
    for name, unit in _UNITS.items():
        element = SubElement(parent, "Unit", {"name": name})
        SubElement(element, "BaseUnit", {base: str(power) for base, power in unit.base.items()})
        for display, factor in unit.displays:
            SubElement(element, "DisplayUnit", {"name": display, "factor": repr(factor)})


def _add_variable(parent: Element, variable: Variable) -> None:
    attributes = {
        "name": variable.name,
        "valueReference": str(VALUE_REFERENCES[variable.name]),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != "input":
        attributes["initial"] = "calculated" if variable.start is None else "exact"
    element = SubElement(parent, "ScalarVariable", attributes)
    typed = SubElement(element, variable.kind)
    if variable.unit:
        typed.set("unit", variable.unit)
        if variable.unit in _SHOWN_OTHERWISE:
            typed.set("displayUnit", _UNITS[variable.unit].displays[0][0])
    for key, value in (
        ("min", variable.minimum),
        ("max", variable.maximum),
        ("nominal", variable.nominal),
        ("start", variable.start),
    ):
        if value is not None:
            typed.set(key, repr(value))


def _add_structure(parent: Element) -> None:
    outputs = [variable for variable in VARIABLES if variable.causality == "output"]
    known = SubElement(parent, "Outputs")
    for variable in outputs:
        # What is set acts from the next step on, so no output feeds through.
        SubElement(known, "Unknown", {"index": _index(variable.name), "dependencies": ""})
    unknowns = SubElement(parent, "InitialUnknowns")
    for variable in outputs:
        if variable.start is None:
            SubElement(
                unknowns,
                "Unknown",
                {
                    "index": _index(variable.name),
                    "dependencies": " ".join(_indices(variable.depends)),
                },
            )


def _index(name: str) -> str:
    return str(VALUE_REFERENCES[name] + 1)


def _indices(names: Iterable[str]) -> Iterable[str]:
    return map(str, sorted(VALUE_REFERENCES[name] + 1 for name in names))
