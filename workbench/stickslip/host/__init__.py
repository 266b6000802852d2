"""The start of a simulator that is not written in Python, with the libpython that the FMU needs."""
