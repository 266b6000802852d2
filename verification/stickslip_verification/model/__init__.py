"""What every room below `run` speaks of: quantities, formulas, records of runs, the verdict."""
