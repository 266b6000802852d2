"""Sweeps: any FMU or system of FMUs, run with many settings."""
