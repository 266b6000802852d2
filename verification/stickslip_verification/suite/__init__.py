"""The suite as data: cases, invariants, planted faults, tolerances, meanings of failures."""
