"""The `stickslip` command: build the FMU, simulate it or the reference, verify it.

The package is what people touch and nothing more: it reads quantities as people type them, runs
an engine of the floors below, and shows what came out as a table, a CSV file or a plot.
"""
