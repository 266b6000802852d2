"""Studies of many points, computed in chunks: on this machine or a cluster, resumed when killed."""

from .run import Computing, run
from .store import Columns, Progress, Results, Study, StudyError

__all__ = ["Columns", "Computing", "Progress", "Results", "Study", "StudyError", "run"]
