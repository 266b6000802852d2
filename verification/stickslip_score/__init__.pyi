from .judge import score as score
from .read import Curve as Curve
from .read import CurveError as CurveError
from .read import read_curve as read_curve
from .result import Cause as Cause
from .result import Compared as Compared
from .result import Score as Score
from .result import as_json as as_json
