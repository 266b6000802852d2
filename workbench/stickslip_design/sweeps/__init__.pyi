from .model import SweepError as SweepError
from .model import read_model as read_model
from .study import sweep as sweep
