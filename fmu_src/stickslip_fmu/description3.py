"""The FMI 3.0 model description, made from the variable table."""

from typing import Dict
from xml.etree.ElementTree import Element, SubElement

from .description import (
    LOG_CATEGORIES,
    MODEL,
    add_experiment,
    add_log_categories,
    add_units,
    initial_unknowns,
    outputs,
    root_element,
    type_attributes,
    value_attributes,
    variable_attributes,
)
from .quantities import QUANTITIES, Quantity
from .variables import VALUE_REFERENCES, VARIABLES

# FMI 3.0 wants the independent variable to be one of the variables.
TIME = len(VARIABLES)

_CAPABILITIES = {
    "modelIdentifier": MODEL,
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


def model_description(identity: str, generator: str) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    identity
        The instantiation token.
    generator
        Name and version of what wraps the slave.
    """
    root = root_element("3.0", ("instantiationToken", identity), generator)
    SubElement(root, "CoSimulation", _CAPABILITIES)
    add_units(root)
    _add_types(SubElement(root, "TypeDefinitions"))
    add_log_categories(root, _LOG_CATEGORIES)
    add_experiment(root)
    _add_variables(SubElement(root, "ModelVariables"))
    _add_structure(SubElement(root, "ModelStructure"))
    return root


def _add_types(parent: Element) -> None:
    for name, quantity in QUANTITIES.items():
        attributes = {"name": name, **type_attributes(quantity)}
        element = SubElement(parent, f"{type_name(quantity)}Type", attributes)
        for item in quantity.items:
            attributes = {
                "name": item.name,
                "value": str(item.value),
                "description": item.description,
            }
            SubElement(element, "Item", attributes)


def _add_variables(parent: Element) -> None:
    for variable in VARIABLES:
        attributes = {**variable_attributes(variable), **value_attributes(variable)}
        SubElement(parent, type_name(variable.type), attributes)
    SubElement(parent, "Float64", _time_attributes())


def _time_attributes() -> Dict[str, str]:
    return {
        "name": "time",
        "valueReference": str(TIME),
        "description": "Time",
        "causality": "independent",
        "variability": "continuous",
        "declaredType": "Time",
        **type_attributes(QUANTITIES["Time"]),
    }


def _add_structure(parent: Element) -> None:
    for variable in outputs():
        reference = str(VALUE_REFERENCES[variable.name])
        SubElement(parent, "Output", {"valueReference": reference, "dependencies": ""})
    for variable, dependencies in initial_unknowns():
        reference = str(VALUE_REFERENCES[variable.name])
        SubElement(parent, "InitialUnknown", {"valueReference": reference, **dependencies})
