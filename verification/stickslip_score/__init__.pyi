from .cause import Cause as Cause
from .cause import Compared as Compared
from .cause import Score as Score
from .cause import as_json as as_json
from .cause import score as score
from .read import Curve as Curve
from .read import CurveError as CurveError
from .read import read_curve as read_curve
