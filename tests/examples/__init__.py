"""Tests of the examples: what they tell is so."""
