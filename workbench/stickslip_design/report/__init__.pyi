from .page import data as data
from .page import html as html
from .plots import feeds as feeds
from .plots import motion as motion
from .plots import responses as responses
from .sketch import sketch as sketch
