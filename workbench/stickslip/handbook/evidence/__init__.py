"""What the FMU carries as evidence: an experiment, its result, and the report of the suite."""

from stickslip.handbook.evidence.folder import evidence

__all__ = ["evidence"]
