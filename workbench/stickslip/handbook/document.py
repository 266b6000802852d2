"""The FMU's own documentation: model, interface, importing, how it was verified; one file."""

from importlib.resources import files
from typing import Any, Final

from fmi.table import Table, Variable
from stickslip_fmu.interface import table_of
from stickslip_fmu.laws.named import COULOMB_NAME, friction_law
from stickslip_fmu.release import DATE, VERSION

_SOURCES: Final = files("stickslip.handbook")
_TITLES: Final = {
    ("parameter", False): "Parameters",
    ("input", False): "Inputs",
    ("output", False): "Outputs: the motion",
    ("output", True): "Outputs: the last cycle",
}
"""The tables of the interface, by causality and whether the cycle meter holds the value."""


def document(fmi_version: int, *, native: bool = False, law: str = COULOMB_NAME) -> str:
    """Return documentation/index.html of the FMU for FMI 2.0 or 3.0 (2 or 3).

    The `native` one is the FMU in C, the other one that in Python. `law` is the name of its
    friction law, a built-in one.
    """
    own = friction_law(law).law.interface
    return _rendered(
        "index.html.j2",
        fmi_version=fmi_version,
        native=native,
        licences="../licenses" if fmi_version == 2 else "licenses",
        groups=_groups(table_of(own)),
        model=own.model,
        law=law,
    )


def notes_on_references() -> str:
    """Return documentation/fmi-ls-ref.html: what lies in extra/, and how to use it."""
    return _rendered("fmi-ls-ref.html.j2")


def _rendered(template: str, **names: Any) -> str:
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined
    )
    return environment.from_string(_text(template)).render(
        version=VERSION,
        date=DATE.partition("T")[0],
        style=Markup(_text("handbook.css")),
        **names,
    )


def _text(name: str) -> str:
    return (_SOURCES / name).read_text(encoding="utf-8")


def _groups(table: Table) -> list[tuple[str, list[dict[str, str]]]]:
    """Return the rows of the interface tables, by what they are to a user."""
    groups: dict[str, list[dict[str, str]]] = {}
    for row in table.rows:
        metered = row.attribute.startswith("meter.")
        name = _TITLES[row.causality, metered]
        groups.setdefault(name, []).append(_row(row))
    return list(groups.items())


def _row(row: Variable) -> dict[str, str]:
    return {
        "name": row.name,
        "type": row.kind,
        "unit": "" if row.unit == "1" else row.unit,
        "start": "" if row.start is None else f"{row.start:g}",
        "range": row.range if row.type.items else row.range.partition("finite and ")[2],
        "when": row.variability if row.causality == "parameter" else "",
        "what": row.description,
    }
