"""A feed axis: its numbers, and the file that a designer writes them in."""

from .build import Number
from .model import Assumed, Axis, AxisError, Demand, Drive, Filter, Friction, low_pass, notch
from .read import AxisFile, axis_file_of, axis_of, example, read_axis, read_axis_file, template

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
