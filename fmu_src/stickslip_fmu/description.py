"""What the model descriptions of all FMI versions share: texts, identity, date, units, elements."""

import hashlib
import os
import uuid
from datetime import datetime, timezone
from typing import Dict, Iterator, Mapping, Tuple
from xml.etree.ElementTree import Element, SubElement

from .quantities import UNITS, Quantity
from .release import DATE, VERSION
from .variables import VALUE_REFERENCES, VARIABLES, Variable

MODEL = "StickSlip"

DESCRIPTION = (
    "A mass pulled over dry friction through a spring: sticks, breaks away, slips, sticks again. "
    "Solved exactly from event to event, so no result depends on the communication step."
)

# The categories of messages that every face tells.
LOG_CATEGORIES = {
    "logStatusWarning": "A value was taken, but not as it was given.",
    "logAll": "All messages.",
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


def identity(package: str) -> str:
    """Return the identifier of what is packed under this name, which tells the content.

    In braces and 8-4-4-4-12 digits, as importers know it.
    """
    return f"{{{uuid.UUID(bytes=hashlib.sha256(package.encode()).digest()[:16])}}}"


def root_element(version: str, identifier: Tuple[str, str], generator: str) -> Element:
    """Return the root of modelDescription.xml, still empty.

    Parameters
    ----------
    version
        Of FMI.
    identifier
        The attribute that identifies the FMU, and its value; no binary compares it.
    generator
        Name and version of what wraps the slave.
    """
    return Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": MODEL,
            identifier[0]: identifier[1],
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


def add_units(root: Element) -> None:
    """Add the unit definitions."""
    parent = SubElement(root, "UnitDefinitions")
    for name, unit in UNITS.items():
        element = SubElement(parent, "Unit", {"name": name})
        SubElement(element, "BaseUnit", {base: str(power) for base, power in unit.base.items()})
        for display, factor in unit.displays:
            SubElement(element, "DisplayUnit", {"name": display, "factor": repr(factor)})


def add_log_categories(root: Element, categories_of_face: Mapping[str, str]) -> None:
    """Add the categories that messages belong to, with what they mean."""
    categories = SubElement(root, "LogCategories")
    for name, text in categories_of_face.items():
        SubElement(categories, "Category", {"name": name, "description": text})


def add_experiment(root: Element) -> None:
    """Add the default experiment; a tolerance would mean nothing."""
    SubElement(root, "DefaultExperiment", _EXPERIMENT)


def type_attributes(quantity: Quantity) -> Dict[str, str]:
    """Return what a type of Reals says: quantity, units, order of magnitude."""
    if quantity.kind != "Real":
        return {}
    attributes = {"quantity": quantity.quantity, "unit": quantity.unit}
    if quantity.shown_in:
        attributes["displayUnit"] = quantity.shown_in
    attributes["nominal"] = repr(quantity.nominal)
    return attributes


def variable_attributes(variable: Variable) -> Dict[str, str]:
    """Return what every FMI version says of a variable, but for its values."""
    attributes = {
        "name": variable.name,
        "valueReference": str(VALUE_REFERENCES[variable.name]),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != "input":
        attributes["initial"] = "calculated" if variable.start is None else "exact"
    return attributes


def value_attributes(variable: Variable) -> Dict[str, str]:
    """Return type, bounds and start of a variable.

    What the type says is repeated, for readers that do not look it up.
    """
    attributes = {"declaredType": variable.quantity, **type_attributes(variable.type)}
    for key, value in (
        ("min", variable.minimum),
        ("max", variable.maximum),
        ("start", variable.start),
    ):
        if value is not None:
            attributes[key] = repr(value)
    return attributes


def outputs() -> Iterator[Variable]:
    """Give the outputs. What is set acts from the next step on, so none depends on an input."""
    return (variable for variable in VARIABLES if variable.causality == "output")


def initial_unknowns(offset: int = 0) -> Iterator[Tuple[Variable, Dict[str, str]]]:
    """Give what is calculated at the start, with the attributes that say from what.

    The known variables are numbered from `offset` on.
    """
    for variable in outputs():
        if variable.start is None:
            numbers = sorted(VALUE_REFERENCES[name] + offset for name in variable.depends)
            kind = "constant" if variable.in_proportion else "dependent"
            yield (
                variable,
                {
                    "dependencies": " ".join(map(str, numbers)),
                    "dependenciesKind": " ".join([kind] * len(numbers)),
                },
            )
