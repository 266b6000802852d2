"""What every run is held to, whatever the case: laws as data, read here and judged in `run`."""

from stickslip_verification.laws.law import (
    Agreement,
    Law,
    LawError,
    Laws,
    Order,
    Probe,
    ResidualLaw,
    RunLaw,
    load_laws,
)

__all__ = [
    "Agreement",
    "Law",
    "LawError",
    "Laws",
    "Order",
    "Probe",
    "ResidualLaw",
    "RunLaw",
    "load_laws",
]
