from .drawing import sketch as sketch
from .page import data as data
from .page import html as html
from .plots import feeds as feeds
from .plots import motion as motion
from .plots import responses as responses
from .side_by_side import comparison as comparison
