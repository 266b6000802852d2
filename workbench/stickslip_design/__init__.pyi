from .sweeps.study import sweep as sweep
from .tolerances.study import scatter as scatter
