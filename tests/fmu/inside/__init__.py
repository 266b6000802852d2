"""What runs in a process of its own that has the FMU and cannot import the project."""

SKIPPED = -1
"""What stands for the status of a call that would hand over a state which is not there."""
