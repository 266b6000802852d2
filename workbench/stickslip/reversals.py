"""What axes do where they reverse, from Python; as `stickslip.library`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.parameters import ParameterError, above_zero, quantity
from stickslip.results import Shown
from stickslip.show.tables import reversal_summary
from stickslip_design.axis import AxisSource, read_axis_file
from stickslip_design.reversal import plots
from stickslip_design.reversal.study import Reversals, study

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType


@dataclass(frozen=True, repr=False)
class Reversal(Shown):
    """What axes do where they reverse: `found` has the circles with their paths, and B."""

    found: Reversals

    def __repr__(self) -> str:
        worst = max(self.found.circles, key=lambda each: each.G_b)
        axes = " and ".join(f"{each.axis}, B {each.B:.3g} m" for each in self.found.values)
        return (
            f"<Reversal of {axes}: G(b) {worst.G_b:.3g} m, glitch {worst.glitch.height:.3g} m "
            f"at {worst.feed:.3g} m/s, radius {worst.radius:.3g} m>"
        )

    def table(self) -> RenderableType:
        """Return a row for each circle, for rich."""
        return reversal_summary(self.found)

    def to_dict(self) -> dict[str, Any]:
        """Return the figures [SI] as JSON knows them, without the paths."""
        circles = [
            {
                "feed": each.feed, "radius": each.radius, "share": each.share, "G_b": each.G_b,
                "G": each.G, "H": each.H, "D": each.D, "F_max": each.F[0], "F_min": each.F[1],
                "glitches": each.glitches,
            }
            for each in self.found.circles
        ]  # fmt: skip
        return {
            "circles": circles, "reversal_values": self.found.values, "assumed": self.found.assumed
        }  # fmt: skip

    def plot(self) -> Figure:
        """Draw the circles, the deviation of the radius enlarged."""
        return plots.circles(self.found.circles)

    def write_plot(self, target: Path | str, option: str = "file") -> None:
        """Draw into a .png, .svg or .pdf file; `option` names it in a refusal."""
        from stickslip.show.plot import write_figure

        write_figure(self.plot(), Path(target), option)


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
    return Reversal(study([file.axis() for file in files], speeds, lengths, parts))
