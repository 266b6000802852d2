from .model import read_model as read_model
from .refusal import SweepError as SweepError
from .study import sweep as sweep
