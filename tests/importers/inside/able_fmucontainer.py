"""What a container made by `fmucontainer` can do."""

from .by_fmucontainer import nest
from .through_fmpy import STEP, Probes

PROBES = Probes(lambda fmu: nest(fmu, STEP, blocks=("a",), link=None), "a.")
