"""`stickslip reversal`: what two axes do where they reverse on a circle."""

from pathlib import Path

from stickslip.commands.expanded import command
from stickslip.commands.shared import console


@command
def reversal(
    axis: Path,
    *,
    with_: Path | None = None,
    feeds: list[str] | None = None,
    radii: list[str] | None = None,
    shares: list[str] | None = None,
    plot: Path | None = None,
    json: bool = False,
) -> None:
    """Run the circular test of ISO 230-4 on two axes: deviations, and the glitch of each reversal.

    Friction turns over by presliding, friction.presliding in the axis file. The reversal value of
    ISO 230-2 comes with it.
    """
    from stickslip.files import check_drawable, check_writable
    from stickslip.progress import meter
    from stickslip.reversals import reversal as reversed_axes

    if plot is not None:
        check_drawable(plot, "--plot")
        check_writable(plot, "--plot")
    asked = {"feeds": feeds, "radii": radii, "shares": shares}
    with meter("Running the circles"):
        found = reversed_axes(axis, with_, **{k: each for k, each in asked.items() if each})
    if plot is not None:
        found.write_plot(plot, "--plot")
    if json:
        print(found.to_json())
    else:
        console().print(found.table())
