"""Quantities that people type and read: units and numbers read, and one ladder to show them.

Numbers are scaled as fractions and rounded once, so that ``20mm/s`` is the same double as 0.02.
"""

from .quantity import (
    BETWEEN,
    KINDS,
    Kind,
    QuantityError,
    Units,
    between,
    in_unit,
    on_data_sheet,
    parse_range,
    parts_of,
    typed,
    typed_in,
)
from .shown import (
    EXACT,
    NONE,
    Scale,
    decibels,
    number,
    per_minute,
    scale_for,
    shown_in,
    told,
)
from .units import (
    UNIT_PREFIXES,
    UNITS_ALONE,
    UNITS_WITH_PREFIX,
    Conversion,
    Dimension,
    Unit,
    conversion,
    defined,
    spelled,
)

__all__ = [
    "BETWEEN",
    "EXACT",
    "KINDS",
    "NONE",
    "UNITS_ALONE",
    "UNITS_WITH_PREFIX",
    "UNIT_PREFIXES",
    "Conversion",
    "Dimension",
    "Kind",
    "QuantityError",
    "Scale",
    "Unit",
    "Units",
    "between",
    "conversion",
    "decibels",
    "defined",
    "in_unit",
    "number",
    "on_data_sheet",
    "parse_range",
    "parts_of",
    "per_minute",
    "scale_for",
    "shown_in",
    "spelled",
    "told",
    "typed",
    "typed_in",
]
