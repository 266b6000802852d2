from .model import read_model as read_model
from .plan import read_plan as read_plan
from .refusal import SweepError as SweepError
from .study import sweep as sweep
