"""Co-simulation FMUs, FMI 2.0 and 3.0, from a table of variables and a model object."""
