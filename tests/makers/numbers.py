"""A foreign FMU 3.0 in C with a variable of each type of number, whose steps end after 1 s."""

from __future__ import annotations

import inspect
from pathlib import Path

import fmpy.fmi3

from tests.makers import pack_library

TYPES = {
    "Float32": ("x", "output", "float"),
    "Float64": ("k", "parameter", "double"),
    "Int8": ("mode", "output", "int8_t"),
    "UInt8": ("mu_k", "parameter", "uint8_t"),
    "Int16": ("mu_s", "parameter", "int16_t"),
    "UInt16": ("g", "parameter", "uint16_t"),
    "Int32": ("F", "output", "int32_t"),
    "UInt32": ("n_slips", "output", "uint32_t"),
    "Int64": ("v", "input", "int64_t"),
    "UInt64": ("m", "parameter", "uint64_t"),
    "Boolean": ("sticking", "output", "bool"),
    "Enumeration": ("load", "input", "int64_t"),
}
"""Type to our name of the variable, its causality and its type in C."""

VALUES = {
    "x": 0.25, "k": 0.1, "mode": -1.0, "mu_k": 250.0, "mu_s": -300.0, "g": 60000.0, "F": -1e9,
    "n_slips": 4e9, "v": -(2.0**40), "m": 2.0**63, "sticking": 1.0, "load": 1.0,
}  # fmt: skip
"""A value for each variable that the next smaller type could not hold."""

HEAD = """\
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static int instance;

void *fmi3InstantiateCoSimulation(void) { return &instance; }

int fmi3DoStep(void *i, double time, double h, bool no_set, bool *event, bool *terminate,
               bool *early, double *reached) {
    *event = true;
    *early = h > 1.0;
    *reached = time + 1.0;
    return 0;
}
"""

ACCESS = """
static {c_type} of_{kind}[20];

int fmi3Get{kind}(void *i, const unsigned *which, size_t n, {c_type} *values, size_t m) {{
    for (size_t j = 0; j < n; j++) values[j] = of_{kind}[which[j]];
    return n == m ? 0 : 3;
}}

int fmi3Set{kind}(void *i, const unsigned *which, size_t n, const {c_type} *values, size_t m) {{
    for (size_t j = 0; j < n; j++) of_{kind}[which[j]] = values[j];
    return n == m ? 0 : 3;
}}
"""


def build(folder: Path) -> Path:
    """Compile and pack the FMU."""
    text = HEAD
    for kind, (_, _, c_type) in TYPES.items():
        if kind != "Enumeration":
            text += ACCESS.format(kind=kind, c_type=c_type)
    for name, _ in inspect.getmembers(fmpy.fmi3.FMU3Slave):
        if name.startswith("fmi3") and f" {name}(" not in text and f"*{name}(" not in text:
            text += f"\nint {name}(void) {{ return 0; }}\n"
    source = folder / "numbers.c"
    source.write_text(text, encoding="utf-8")
    return pack_library(source, folder / "Numbers.fmu", _description())


def _description() -> str:
    variables = outputs = ""
    for reference, (kind, (name, causality, _)) in enumerate(TYPES.items(), start=1):
        variability = "fixed" if causality == "parameter" else "discrete"
        more = "" if causality == "output" else ' start="1"'
        more += ' declaredType="Choice"' if kind == "Enumeration" else ""
        variables += (
            f'<{kind} name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="{variability}"{more}/>'
        )
        outputs += f'<Output valueReference="{reference}"/>' if causality == "output" else ""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<fmiModelDescription fmiVersion="3.0" modelName="Numbers" instantiationToken="1">'
        '<CoSimulation modelIdentifier="Numbers"/>'
        '<TypeDefinitions><EnumerationType name="Choice"><Item name="one" value="1"/>'
        "</EnumerationType></TypeDefinitions><ModelVariables>"
        '<Float64 name="time" causality="independent" valueReference="0"/>'
        f"{variables}</ModelVariables><ModelStructure>{outputs}</ModelStructure>"
        "</fmiModelDescription>"
    )
