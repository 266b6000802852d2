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
    from stickslip import reversals
    from stickslip.files import check_drawable, check_writable
    from stickslip.progress import meter
    from stickslip.show.plot import write_figure

    if plot is not None:
        check_drawable(plot, "--plot")
        check_writable(plot, "--plot")
    asked = {"feeds": feeds, "radii": radii, "shares": shares}
    with meter("Running the circles"):
        found = reversals.reversal(axis, with_, **{k: each for k, each in asked.items() if each})
    if plot is not None:
        write_figure(found.plot(), plot, "--plot")
    print(found.to_json()) if json else console().print(found.table())
