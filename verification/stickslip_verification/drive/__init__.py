"""Runs: an FMU or the reference driven through a case, each in a process with a time limit."""
