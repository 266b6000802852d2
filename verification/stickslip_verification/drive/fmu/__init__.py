"""An FMU 2.0 or 3.0 as a file: its archive, its variables by the suite's names, its instances."""
