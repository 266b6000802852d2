"""The icon of the FMU, drawn by code: the mass on its way, pulled by a spring."""

import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_PIXELS = 256
_INK, _MASS, _FORCE = "#16202c", "#1a63c6", "#d9660b"


def icon() -> bytes:
    """Return the icon as PNG, 256 pixels square; the same bytes at every call."""
    import matplotlib

    # A person's own defaults are no part of the FMU.
    with matplotlib.rc_context(matplotlib.rcParamsDefault):
        return _drawn()


def _drawn() -> bytes:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(1.0, 1.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    axes.set_axis_off()
    _draw_machine(axes)
    _draw_motion(axes)
    picture = io.BytesIO()
    # Without the name of what wrote it, which would change with every release of that.
    figure.savefig(picture, format="png", dpi=_PIXELS, metadata={"Software": None})
    return picture.getvalue()


def _draw_machine(axes: "Axes") -> None:
    """Draw the way with its hatching, the mass on it, the spring and the pull."""
    from matplotlib.patches import FancyArrow, Rectangle

    axes.plot([0.05, 0.95], [0.56, 0.56], color=_INK, lw=1.1)
    for index in range(11):
        left = 0.07 + 0.08 * index
        axes.plot([left, left + 0.04], [0.515, 0.56], color=_INK, lw=0.5)
    axes.add_patch(Rectangle((0.1, 0.56), 0.3, 0.26, facecolor=_MASS, edgecolor=_INK, lw=0.8))
    coils = [(0.4, 0.69), (0.45, 0.69)]
    coils += [(0.47 + 0.04 * index, 0.69 + (0.055, -0.055)[index % 2]) for index in range(6)]
    coils += [(0.69, 0.69), (0.74, 0.69)]
    axes.plot(*zip(*coils, strict=True), color=_FORCE, lw=1.1, solid_joinstyle="round")
    axes.add_patch(FancyArrow(0.74, 0.69, 0.2, 0.0, width=0.016, head_width=0.09,
                              head_length=0.07, length_includes_head=True, color=_INK))  # fmt: skip


def _draw_motion(axes: "Axes") -> None:
    """Draw what it does below: the mass goes in jumps, the pulled end evenly."""
    steps = [(0.06, 0.08), (0.28, 0.08), (0.36, 0.2), (0.58, 0.2), (0.66, 0.32), (0.88, 0.32),
             (0.94, 0.41)]  # fmt: skip
    axes.plot([0.06, 0.94], [0.12, 0.46], color="#8b95a0", lw=0.8)
    axes.plot(*zip(*steps, strict=True), color=_MASS, lw=1.5, solid_joinstyle="round")
