"""Tests of fmi: a model as an FMU."""
