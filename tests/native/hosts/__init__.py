"""The native FMU in simulators, and in programs written in C."""
