from .csv_file import read_curve as read_curve
from .curve import Curve as Curve
from .curve import CurveError as CurveError
from .judge import score as score
from .result import Cause as Cause
from .result import Compared as Compared
from .result import Score as Score
from .result import as_json as as_json
