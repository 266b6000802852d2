"""Tests of fmukit: a model as an FMU."""
