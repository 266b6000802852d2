"""The report of a verdict: page, JSON and JUnit XML, byte-identical for identical input."""
