"""The table of variables as C: the record of settings, value references, rows."""

from typing import Dict, List

from fmi.model import Spec
from fmi.table import Table, Variable

_HEADER = """\
/* The variables of the model, made from its table. */
#ifndef STICKSLIP_TABLE_H
#define STICKSLIP_TABLE_H

#include <stdbool.h>
#include <stddef.h>

/* The values that rule the motion: parameters, inputs and start values [SI units]. */
struct settings {{
{fields}
}};

enum {{ SETTINGS = {settings}, VARIABLES = {variables}, DISCRETE = {discrete} }};

/* Value references, which are positions in ROWS. */
enum reference {{
{references}
}};

enum kind {{ REAL, INTEGER, BOOLEAN }};

struct row {{
    const char *name;
    const char *unit; /* "" where a message names none */
    enum kind kind;
    bool enumeration; /* an Integer whose values have names: an Enumeration in FMI 3.0 */
    bool settable;    /* a parameter or input */
    bool fixed;       /* a parameter that cannot change after the initialization */
    bool tunable;     /* a parameter that can */
    int discrete;     /* position among the outputs that change at events alone, else -1 */
    bool has_start, has_minimum, has_maximum;
    double start, minimum, maximum;
    const char *range; /* in words */
    size_t offset;     /* in struct settings, of what is settable */
}};

extern const struct row ROWS[VARIABLES];

#endif
"""

_SOURCE = """\
/* The rows of the table of variables, made from it. */
#include "table.h"

const struct row ROWS[VARIABLES] = {{
{rows}
}};
"""


def table_files(spec: Spec) -> Dict[str, str]:
    """Return table.h and table.c of a model, by name."""
    table = spec.table
    settable = [row for row in table.rows if row.settable]
    return {
        "table.h": _HEADER.format(
            fields="\n".join(f"    double {row.name};" for row in settable),
            settings=len(settable),
            variables=len(table.rows),
            discrete=len(_discrete(table)),
            references="\n".join(f"    VR_{row.name} = {row.number}," for row in table.rows),
        ),
        "table.c": _SOURCE.format(rows="\n".join(_row(table, row) for row in table.rows)),
    }


def _discrete(table: Table) -> List[Variable]:
    return [row for row in table.rows if not row.settable and row.variability == "discrete"]


def _row(table: Table, row: Variable) -> str:
    discrete = _discrete(table)
    members: List[str] = [
        _text(row.name),
        _text("" if row.unit == "1" else row.unit),
        row.kind.upper(),
        _truth(bool(row.type.items)),
        _truth(row.settable),
        _truth(row.variability == "fixed"),
        _truth(row.variability == "tunable"),
        str(discrete.index(row) if row in discrete else -1),
        *(_truth(value is not None) for value in (row.start, row.minimum, row.maximum)),
        *(_number(value) for value in (row.start, row.minimum, row.maximum)),
        _text(row.range),
        f"offsetof(struct settings, {row.name})" if row.settable else "0",
    ]
    return f"    {{{', '.join(members)}}},"


def _text(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _truth(value: bool) -> str:
    return str(value).lower()


def _number(value: object) -> str:
    return "0.0" if value is None else repr(float(value))  # type: ignore[arg-type]
