"""A feed axis: its numbers, and the file that a designer writes them in."""

from .model import Assumed, Axis, Demand, Drive, Filter, Friction, low_pass, notch
from .read import AxisFile, axis_file_of, axis_of, read_axis, read_axis_file
from .refusal import AxisError
from .template import example, template
from .values import Number

__all__ = [
    "Assumed",
    "Axis",
    "AxisError",
    "AxisFile",
    "Demand",
    "Drive",
    "Filter",
    "Friction",
    "Number",
    "axis_file_of",
    "axis_of",
    "example",
    "low_pass",
    "notch",
    "read_axis",
    "read_axis_file",
    "template",
]
