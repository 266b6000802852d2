from .judgements import CurveVerdict as CurveVerdict
from .judgements import Design as Design
from .judgements import FmuVerdict as FmuVerdict
from .judgements import design as design
from .judgements import score as score
from .judgements import verify as verify
from .library import Cycle as Cycle
from .library import Limits as Limits
from .library import Run as Run
from .library import build as build
from .library import critical as critical
from .library import cycle as cycle
from .library import simulate as simulate
from .parameters import ParameterError as ParameterError
from .parameters import Parameters as Parameters
from .studies import map as map  # noqa: A004 - the name of the command
from .studies import scatter as scatter
from .studies import sweep as sweep
