"""The servo drive: set point, digital controller, drive inertia, and their FMI 2.0 face.

What stands here travels in ServoDrive.fmu: Python 3.8 and its standard library, and pythonfmu.
"""
