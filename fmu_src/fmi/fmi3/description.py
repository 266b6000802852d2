"""The FMI 3.0 model description, made from the variable table."""

from typing import Dict, Mapping
from xml.etree.ElementTree import Element, SubElement

from ..description import (
    LOG_CATEGORIES,
    add_annotations,
    add_experiment,
    add_log_categories,
    add_units,
    drop_empty_lists,
    initial_unknowns,
    outputs,
    root_element,
    type_attributes,
    value_attributes,
    variable_attributes,
)
from ..model import Spec
from ..table import Quantity, Table

_CAPABILITIES = {
    "needsExecutionTool": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canGetAndSetFMUState": "true",
    "canSerializeFMUState": "true",
    "canHandleVariableCommunicationStepSize": "true",
    "providesIntermediateUpdate": "false",
    "mightReturnEarlyFromDoStep": "false",
    "canReturnEarlyAfterIntermediateUpdate": "false",
    "hasEventMode": "false",
}

_LOG_CATEGORIES = {**LOG_CATEGORIES, "logStatusError": "A step was refused, and why."}


def type_name(quantity: Quantity) -> str:
    """Return the FMI 3.0 type of the variables of this quantity."""
    if quantity.items:
        return "Enumeration"
    return {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}[quantity.kind]


def model_description(
    spec: Spec,
    identity: str,
    generator: str,
    log_categories: Mapping[str, str] = _LOG_CATEGORIES,
) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    spec
        The model.
    identity
        The instantiation token.
    generator
        Name and version of the tool that makes the FMU.
    log_categories
        Categories of messages with their meanings.
    """
    root = root_element(spec, "3.0", ("instantiationToken", identity), generator)
    SubElement(root, "CoSimulation", {"modelIdentifier": spec.name, **_CAPABILITIES})
    add_units(root, spec.table)
    _add_types(SubElement(root, "TypeDefinitions"), spec.table)
    add_log_categories(root, log_categories)
    add_experiment(root, spec.experiment)
    _add_variables(SubElement(root, "ModelVariables"), spec.table)
    _add_structure(SubElement(root, "ModelStructure"), spec.table)
    add_annotations(SubElement(root, "Annotations"), "Annotation", "type", spec.annotations)
    drop_empty_lists(root)
    return root


def _add_types(parent: Element, table: Table) -> None:
    for name, quantity in table.quantities.items():
        attributes = {"name": name, **type_attributes(quantity)}
        element = SubElement(parent, f"{type_name(quantity)}Type", attributes)
        for item in quantity.items:
            attributes = {
                "name": item.name,
                "value": str(item.value),
                "description": item.description,
            }
            SubElement(element, "Item", attributes)


def _add_variables(parent: Element, table: Table) -> None:
    for variable in table.rows:
        attributes = {**variable_attributes(variable), **value_attributes(variable)}
        SubElement(parent, type_name(variable.type), attributes)
    SubElement(parent, "Float64", _time_attributes(table))


def time_reference(table: Table) -> int:
    """Return the value reference of the independent variable, which FMI 3.0 wants to be listed."""
    return len(table.rows)


def _time_attributes(table: Table) -> Dict[str, str]:
    attributes = {
        "name": "time",
        "valueReference": str(time_reference(table)),
        "description": "Time",
        "causality": "independent",
        "variability": "continuous",
    }
    if "Time" in table.quantities:
        attributes["declaredType"] = "Time"
        attributes.update(type_attributes(table.quantities["Time"]))
    return attributes


def _add_structure(parent: Element, table: Table) -> None:
    for variable in outputs(table):
        reference = str(variable.number)
        SubElement(parent, "Output", {"valueReference": reference, "dependencies": ""})
    for variable, dependencies in initial_unknowns(table):
        reference = str(variable.number)
        SubElement(parent, "InitialUnknown", {"valueReference": reference, **dependencies})
