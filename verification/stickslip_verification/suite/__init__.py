"""The suite as a whole: its ground, the run of an FMU, planted faults, the verdict."""
