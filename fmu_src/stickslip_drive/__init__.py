"""The servo drive: set point, digital controller, drive inertia, and its table of variables.

These modules travel in ServoDrive.fmu: Python 3.8, its standard library, and fmi.
"""
