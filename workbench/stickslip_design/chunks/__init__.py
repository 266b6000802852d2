"""Studies of many points, computed in chunks: on this machine or a cluster, resumed when killed."""

from .results import Results
from .run import run
from .study import Columns, Progress, Study, StudyError

__all__ = ["Columns", "Progress", "Results", "Study", "StudyError", "run"]
