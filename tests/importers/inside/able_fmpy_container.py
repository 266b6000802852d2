"""What FMPy's container can do."""

from .by_fmpy_container import nest
from .through_fmpy import STEP, Probes

PROBES = Probes(lambda fmu: nest(fmu, STEP, blocks=("a",), link=None), "a.")
