"""Judgement of runs: each check and invariant with its error, tolerance and outcome."""
