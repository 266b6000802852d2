"""The native block and its FMU."""
