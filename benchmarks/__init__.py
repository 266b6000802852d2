"""Benchmarks: what is fast, measured against what."""
