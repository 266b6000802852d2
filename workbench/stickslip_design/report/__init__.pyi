from .page import html as html
from .plots import feeds as feeds
from .plots import responses as responses
from .record import data as data
