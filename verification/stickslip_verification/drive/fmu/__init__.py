"""An FMU 2.0 or 3.0: its description and archive, the suite's names for it, its instances."""
