"""Pictures as SVG text: lines with few points, small texts, and what two pictures differ in.

`as_svg` makes a file of a figure, `thin` and `tidy` a part of a page; `differences` compares two
files by what they draw.
"""

from stickslip_verification.report.svg.compare import SAME, differences
from stickslip_verification.report.svg.figure import as_svg, thin
from stickslip_verification.report.svg.line import thinned
from stickslip_verification.report.svg.text import tidy

__all__ = ["SAME", "as_svg", "differences", "thin", "thinned", "tidy"]
