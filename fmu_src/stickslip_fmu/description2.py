"""The FMI 2.0 model description, made from the variable table."""

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
from .quantities import QUANTITIES
from .variables import VALUE_REFERENCES, VARIABLES, Variable

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


def model_description(identity: str, generator: str) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    identity
        The GUID.
    generator
        Name and version of what wraps the slave.
    """
    root = root_element("2.0", ("guid", identity), generator)
    SubElement(root, "CoSimulation", _CAPABILITIES)
    add_units(root)
    types = SubElement(root, "TypeDefinitions")
    for name, quantity in QUANTITIES.items():
        simple = SubElement(types, "SimpleType", {"name": name})
        SubElement(simple, quantity.kind, type_attributes(quantity))
    add_log_categories(root, LOG_CATEGORIES)
    add_experiment(root)
    variables = SubElement(root, "ModelVariables")
    for variable in VARIABLES:
        scalar = SubElement(variables, "ScalarVariable", variable_attributes(variable))
        SubElement(scalar, variable.kind, value_attributes(variable))
    _add_structure(SubElement(root, "ModelStructure"))
    return root


def _add_structure(parent: Element) -> None:
    known = SubElement(parent, "Outputs")
    for variable in outputs():
        SubElement(known, "Unknown", {"index": _index(variable), "dependencies": ""})
    unknowns = SubElement(parent, "InitialUnknowns")
    for variable, dependencies in initial_unknowns(offset=1):
        SubElement(unknowns, "Unknown", {"index": _index(variable), **dependencies})


def _index(variable: Variable) -> str:
    """Return the position in the list of variables, which is counted from 1."""
    return str(VALUE_REFERENCES[variable.name] + 1)
