"""Scatter: how likely an axis jumps where its numbers vary."""
