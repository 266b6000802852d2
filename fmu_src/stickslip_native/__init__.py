"""The stick-slip block in C99, and the FMU made of it that needs no Python."""
