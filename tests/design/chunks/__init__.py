"""Tests of studies computed in chunks."""
