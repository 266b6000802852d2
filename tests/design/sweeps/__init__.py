"""Tests of sweeps over FMUs and systems of FMUs."""
