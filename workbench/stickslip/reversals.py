"""What axes do where they reverse, from Python; as `stickslip.library`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich.console import Group
from rich.text import Text

from stickslip.parameters import ParameterError, above_zero, quantity
from stickslip.results import Shown
from stickslip.show.tables import Fitted, grid
from stickslip_design.axis import Assumed, AxisSource, read_axis_file
from stickslip_design.loop.follower import Follower, Matrix, assumed
from stickslip_design.reversal import circle, plots
from stickslip_units import EXACT, number, shown_in

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType


@dataclass(frozen=True, repr=False)
class Reversal(Shown):
    """What axes do where they reverse.

    Attributes
    ----------
    circles
        The circular tests, by radius, feed and part that is fed forward.
    paths
        For each the deviation of its radius [m], counterclockwise and clockwise, of shape (2, n)
        over n equal angles from 0 on.
    B
        For each axis that differs its name and reversal value: where it rests from below, less from
        above [m]; negative where it stays behind. It came at the slowest feed.
    assumed
        What the axis files do not state.
    """

    circles: tuple[circle.Circle, ...]
    paths: tuple[Matrix, ...]
    B: tuple[tuple[str, float], ...]
    assumed: tuple[Assumed, ...]

    def __repr__(self) -> str:
        axes = " and ".join(f"{name}, B {B:.3g} m" for name, B in self.B)
        most = max(each.G_b for each in self.circles)
        return f"<Reversal of {axes}: {len(self.circles)} circles, G(b) up to {most:.3g} m>"

    def table(self) -> RenderableType:
        """Return a row for each circle, for rich."""
        rows = []
        for test in self.circles:
            lengths = map(_micrometres, (*test[3:9], test.glitch.height))
            share, width = number(100.0 * test.share, EXACT), number(1e3 * test.glitch.width)
            rows.append((test.name, f"{share} %", *lengths, width))
        names = ("G(b)", "G", "H", "D", "F max", "F min", "glitch")
        head = ("circle", "fed\nforward", *(f"{name}\nµm" for name in names), "width\nmm")
        lines = [f"reversal value B of {name}: {_micrometres(B)} µm" for name, B in self.B]
        lines += [f"assumed: {key} {value}, {reason}" for key, value, reason in self.assumed]
        return Group(Fitted([grid(head, rows, padding=(0, 0, 0, 1))]), *map(Text, lines))

    def to_dict(self) -> dict[str, Any]:
        """Return the figures [SI] as JSON knows them, without the paths."""
        return {"circles": self.circles, "B": self.B, "assumed": self.assumed}

    def plot(self) -> Figure:
        """Draw the circles, the deviation of the radius enlarged."""
        return plots.circles(self.circles, self.paths)


def _micrometres(length: float) -> str:
    # Half a nanometre is nothing.
    return shown_in(length if abs(length) >= 0.5e-9 else 0.0, "m")


def reversal(
    axis: AxisSource,
    other: AxisSource | None = None,
    *,
    feeds: Sequence[float | str] = ("1 m/min",),
    radii: Sequence[float | str] = ("50 mm",),
    shares: Sequence[float | str] = (0.0, 1.0),
) -> Reversal:
    """Return what two axes do on circles: deviations of ISO 230-4, and the glitch of each reversal.

    Their friction is LuGre's, with the presliding of the axis file: docs/reversal.md.

    Parameters
    ----------
    axis, other
        The axis at the angle 0 and that across it, as of `design`; None: the same once more.
    feeds, radii
        Of the circles [m/s, m]; each feed on each radius.
    shares
        Parts of Coulomb friction that are fed forward, from 0 to 2. A rigid drive takes none.

    Raises
    ------
    ParameterError, AxisError, ValueError
        If an argument or an axis file cannot be used, an axis turns, or its loop is unstable.
    RuntimeError
        If a motion cannot be followed to its end.
    """
    parts = [quantity(each, "1", "shares", "from 0 to 2") for each in shares]
    for part in parts:
        if not 0.0 <= part <= 2.0:
            raise ParameterError("shares", f" {part:g} is out of range: it must be from 0 to 2")
    speeds = [above_zero(each, "m/s", "feeds") for each in feeds]
    lengths = [above_zero(each, "m", "radii") for each in radii]
    if not (speeds and lengths and parts):
        raise ValueError("a circle needs a feed, a radius and a part that is fed forward")
    files = [read_axis_file(each) for each in (axis, other) if each is not None]
    for file in files:
        file.refuse_turning("the circular test")
    axes = [file.axis() for file in files]
    tables = [Follower(each) for each in axes]
    parts = parts if all(each.drive for each in axes) else [0.0]
    cases = [(feed, radius, part) for radius in lengths for feed in speeds for part in parts]
    paths = tuple(circle.paths(tables[0], tables[-1], *case) for case in cases)
    B = tuple(
        (each.name, circle.reversal_value(table, min(speeds), each.demand.acceleration))
        for each, table in zip(axes, tables, strict=True)
    )
    tests = tuple(circle.measured(*case, path) for case, path in zip(cases, paths, strict=True))
    taken = dict.fromkeys(each for one in axes for each in assumed(one))
    return Reversal(tests, paths, B, tuple(taken))
