"""The FMI 2.0 model description, made from the variable table."""

from typing import Mapping, Sequence
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
from ..table import Table, Variable

_CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
}


def model_description(
    spec: Spec,
    identity: str,
    generator: str,
    log_categories: Mapping[str, str] = LOG_CATEGORIES,
    sources: Sequence[str] = (),
) -> Element:
    """Return the root of modelDescription.xml.

    Parameters
    ----------
    spec
        The model.
    identity
        The GUID.
    generator
        Name and version of the tool that makes the FMU.
    log_categories
        Categories of messages with their meanings.
    sources
        Files in sources/ that have to be compiled.
    """
    root = root_element(spec, "2.0", ("guid", identity), generator)
    slave = SubElement(root, "CoSimulation", {"modelIdentifier": spec.name, **_CAPABILITIES})
    _add_sources(slave, sources)
    add_units(root, spec.table)
    types = SubElement(root, "TypeDefinitions")
    for name, quantity in spec.table.quantities.items():
        simple = SubElement(types, "SimpleType", {"name": name})
        SubElement(simple, quantity.kind, type_attributes(quantity))
    add_log_categories(root, log_categories)
    add_experiment(root, spec.experiment)
    add_annotations(SubElement(root, "VendorAnnotations"), "Tool", "name", spec.annotations)
    variables = SubElement(root, "ModelVariables")
    for variable in spec.table.rows:
        scalar = SubElement(variables, "ScalarVariable", variable_attributes(variable))
        SubElement(scalar, variable.kind, value_attributes(variable))
    _add_structure(SubElement(root, "ModelStructure"), spec.table)
    drop_empty_lists(root)
    return root


def _add_sources(slave: Element, sources: Sequence[str]) -> None:
    if sources:
        parent = SubElement(slave, "SourceFiles")
        for name in sources:
            SubElement(parent, "File", {"name": name})


def _add_structure(parent: Element, table: Table) -> None:
    known = SubElement(parent, "Outputs")
    for variable in outputs(table):
        SubElement(known, "Unknown", {"index": _index(variable), "dependencies": ""})
    unknowns = SubElement(parent, "InitialUnknowns")
    for variable, dependencies in initial_unknowns(table, offset=1):
        SubElement(unknowns, "Unknown", {"index": _index(variable), **dependencies})


def _index(variable: Variable) -> str:
    """Return the position in the list of variables, which is counted from 1."""
    return str(variable.number + 1)
