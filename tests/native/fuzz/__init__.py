"""Random calls and damaged states on the native FMU, under sanitizers."""
