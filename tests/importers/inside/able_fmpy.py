"""What FMPy can do."""

from .through_fmpy import Probes

PROBES = Probes(lambda fmu: fmu)
