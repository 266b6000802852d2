"""The report of a verdict: page, JSON, JUnit XML and PDF, byte-identical for identical input."""
