"""Random tests on random sets: statements that hold for every draw, or are refuted by one."""

from stickslip_verification.random_sets.run_all import prove
from stickslip_verification.random_sets.tally import RandomTestResult

__all__ = ["RandomTestResult", "prove"]
