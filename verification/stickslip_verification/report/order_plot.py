"""The picture of an observed order: error of the reference over its tolerance, as SVG."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from stickslip_verification.model.verdict import ObservedOrder
from stickslip_verification.report.house_style import BLUE, INK, STYLE, label_decades
from stickslip_verification.report.svg import as_part


def draw_order(order: ObservedOrder, number: int) -> str:
    """Draw the error of the reference over its tolerance, with the slope that the method promises.

    ``number`` tells this picture from the others on the page.
    """
    with mpl.rc_context(STYLE):
        page = Figure(figsize=(3.6, 2.5))
        panel = page.add_axes((0.19, 0.17, 0.77, 0.77))
        levels, errors = np.array(order.tolerances, float), np.array(order.errors, float)
        usable = np.isfinite(errors) & (errors > 0.0)
        panel.loglog(levels[usable], errors[usable], color=BLUE, marker="o", ms=4.5, lw=1.2)
        if usable.any():
            # Through the middle of the points, so that it shows the slope and no offset.
            offset = np.mean(np.log(errors[usable]) - order.expected * np.log(levels[usable]))
            promised = np.exp(offset) * levels**order.expected
            panel.loglog(levels, promised, color=INK, lw=1.0, ls=(0, (4, 3)))
            promise = f"- - -  order {order.expected:.2g}"
            panel.text(0.03, 0.93, promise, transform=panel.transAxes, va="top")
        label_decades(panel.xaxis, panel.get_xlim(), 5)
        label_decades(panel.yaxis, panel.get_ylim(), 5)
        panel.grid(visible=True)
        panel.set_xlabel("tolerance of the integration", labelpad=2.0)
        panel.set_ylabel(f"error of {order.quantity}", labelpad=3.0)
        title = f"{order.case}: error of {order.quantity} over the tolerance"
        return as_part(page, f"plot-order-{number}", title)
