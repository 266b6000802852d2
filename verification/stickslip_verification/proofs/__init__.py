"""Proofs on random sets: statements that hold for every draw, or are refuted by one."""

from stickslip_verification.proofs.run_all import prove
from stickslip_verification.proofs.tally import ProofResult

__all__ = ["ProofResult", "prove"]
