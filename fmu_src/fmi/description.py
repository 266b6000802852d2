"""Parts that the model descriptions of all FMI versions have: identity, date, units, elements."""

import hashlib
import os
import uuid
from datetime import datetime, timezone
from typing import Dict, Iterator, Mapping, Sequence, Tuple
from xml.etree.ElementTree import Element, SubElement

from .model import Annotation, Experiment, Spec
from .table import Quantity, Table, Variable

# Categories of the messages of every face.
LOG_CATEGORIES = {
    "logStatusWarning": "A value was taken, but not as it was given.",
    "logAll": "All messages.",
}


def generation_time(release: str) -> str:
    """Return the date of the build: SOURCE_DATE_EPOCH where it is set, else that of the release.

    Raises ValueError where that variable is no whole number of seconds.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    if not epoch:
        return release
    if not epoch.isdecimal():
        raise ValueError(f"SOURCE_DATE_EPOCH = {epoch!r}: expected whole seconds since 1970")
    moment = datetime.fromtimestamp(int(epoch), timezone.utc)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def identity(content: str) -> str:
    """Return the GUID that goes with a digest of the FMU's content.

    In braces and 8-4-4-4-12 digits, as importers know it.
    """
    return f"{{{uuid.UUID(bytes=hashlib.sha256(content.encode()).digest()[:16])}}}"


def root_element(spec: Spec, version: str, identifier: Tuple[str, str], generator: str) -> Element:
    """Return the root of modelDescription.xml, still empty.

    Parameters
    ----------
    spec
        The model.
    version
        FMI version.
    identifier
        Name and value of the attribute that identifies the FMU; no binary compares it.
    generator
        Name and version of the tool that makes the FMU.

    Raises
    ------
    ValueError
        If the name of the model is no identifier.
    """
    if not spec.name.isidentifier():
        raise ValueError(f"the model name {spec.name!r} is no Python identifier")
    return Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": spec.name,
            identifier[0]: identifier[1],
            "description": spec.description,
            "author": spec.author,
            "version": spec.version,
            "copyright": spec.author,
            "license": spec.licence,
            "generationTool": generator,
            "generationDateAndTime": generation_time(spec.date),
            "variableNamingConvention": "flat",
        },
    )


def add_units(root: Element, table: Table) -> None:
    """Add the unit definitions."""
    parent = SubElement(root, "UnitDefinitions")
    for name, unit in table.units.items():
        element = SubElement(parent, "Unit", {"name": name})
        SubElement(element, "BaseUnit", {base: str(power) for base, power in unit.base.items()})
        for display, factor in unit.displays:
            SubElement(element, "DisplayUnit", {"name": display, "factor": repr(factor)})


def add_log_categories(root: Element, categories_of_face: Mapping[str, str]) -> None:
    """Add the categories of messages with their meanings."""
    categories = SubElement(root, "LogCategories")
    for name, text in categories_of_face.items():
        SubElement(categories, "Category", {"name": name, "description": text})


def add_experiment(root: Element, experiment: Experiment) -> None:
    """Add the default experiment."""
    attributes = {
        "startTime": experiment.start_time,
        "stopTime": experiment.stop_time,
        "stepSize": experiment.step_size,
    }
    given = {name: repr(value) for name, value in attributes.items() if value is not None}
    SubElement(root, "DefaultExperiment", given)


def add_annotations(parent: Element, tag: str, key: str, given: Sequence[Annotation]) -> None:
    """Add annotations, each an element `tag` whose attribute `key` is the type."""
    for annotation in given:
        element = SubElement(parent, tag, {key: annotation.type})
        SubElement(element, annotation.element, dict(annotation.attributes))


def drop_empty_lists(root: Element) -> None:
    """Remove lists without members, which the schemas forbid."""
    for parent in (root, *root.iter("ModelStructure")):
        for child in list(parent):
            if not len(child) and not child.attrib and child.tag != "ModelStructure":
                parent.remove(child)


def type_attributes(quantity: Quantity) -> Dict[str, str]:
    """Return the attributes of a type of Reals: quantity, units, order of magnitude."""
    if quantity.kind != "Real":
        return {}
    attributes = {}
    if quantity.quantity:
        attributes["quantity"] = quantity.quantity
    if quantity.unit:
        attributes["unit"] = quantity.unit
    if quantity.shown_in:
        attributes["displayUnit"] = quantity.shown_in
    if quantity.nominal:
        attributes["nominal"] = repr(quantity.nominal)
    return attributes


def variable_attributes(variable: Variable) -> Dict[str, str]:
    """Return the attributes of a variable that all FMI versions have, without its values."""
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.number),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality != "input":
        attributes["initial"] = "calculated" if variable.start is None else "exact"
    return attributes


def value_attributes(variable: Variable) -> Dict[str, str]:
    """Return type, bounds and start of a variable.

    The attributes of the type are repeated, for readers that do not look them up.
    """
    attributes = {"declaredType": variable.type.name, **type_attributes(variable.type)}
    for key, value in (
        ("min", variable.minimum),
        ("max", variable.maximum),
        ("start", variable.start),
    ):
        if value is not None:
            attributes[key] = str(value).lower() if isinstance(value, bool) else repr(value)
    return attributes


def outputs(table: Table) -> Iterator[Variable]:
    """Give the outputs. A value that is set acts from the next step on, so none feeds through."""
    return (variable for variable in table.rows if variable.causality == "output")


def initial_unknowns(table: Table, offset: int = 0) -> Iterator[Tuple[Variable, Dict[str, str]]]:
    """Give the variables that are calculated at the start, with the attributes of dependency.

    The known variables are numbered from `offset` on.
    """
    for variable in outputs(table):
        if variable.start is None:
            numbers = sorted(table.by_name[name].number + offset for name in variable.depends)
            kind = "constant" if variable.in_proportion else "dependent"
            yield (
                variable,
                {
                    "dependencies": " ".join(map(str, numbers)),
                    "dependenciesKind": " ".join([kind] * len(numbers)),
                },
            )
