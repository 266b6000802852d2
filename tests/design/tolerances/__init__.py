"""Tests of scatter: how likely an axis jumps."""
