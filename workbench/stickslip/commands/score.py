"""`stickslip score`: a curve from any tool against the exact cycle."""

from pathlib import Path
from typing import Annotated, Any

import typer

from stickslip.commands.quantities import help_text, option_name, read_values
from stickslip.commands.shared import console
from stickslip.errors import CommandError


def _parameter(name: str, *spellings: str) -> Any:
    return typer.Option(
        option_name(name),
        *spellings,
        help=help_text(name),
        metavar="VALUE",
        rich_help_panel="Parameters of the block that the curve should show",
        show_default=False,
    )


def _column(option: str, what: str) -> Any:
    return typer.Option(
        option,
        metavar="NAME",
        help=f"Column of {what}, with the unit that the header lacks ('x [mm]'); default: guessed.",
        show_default=False,
    )


def score(
    curve: Annotated[
        Path, typer.Argument(metavar="RESULT.csv", help="A time series with at least t and x or F.")
    ],
    m: Annotated[str | None, _parameter("m")] = None,
    g: Annotated[str | None, _parameter("g")] = None,
    k: Annotated[str | None, _parameter("k")] = None,
    c: Annotated[str | None, _parameter("c")] = None,
    mu_s: Annotated[str | None, _parameter("mu_s")] = None,
    mu_k: Annotated[str | None, _parameter("mu_k")] = None,
    v: Annotated[str | None, _parameter("v")] = None,
    load: Annotated[str | None, _parameter("load")] = None,
    F_ext: Annotated[str | None, _parameter("F_ext", "--f-ext")] = None,
    time: Annotated[str | None, _column("--time", "the time")] = None,
    x: Annotated[str | None, _column("--x", "the mass's position")] = None,
    x_dot: Annotated[str | None, _column("--x-dot", "the mass's velocity")] = None,
    force: Annotated[str | None, _column("--force", "the spring force")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print JSON for machines.")] = False,
) -> None:
    """Compare a curve from any tool with the exact cycle, and say why it differs."""
    from stickslip_score import CurveError, as_json, read_curve
    from stickslip_score import score as judge

    given = {"m": m, "g": g, "k": k, "c": c, "mu_s": mu_s, "mu_k": mu_k}
    given |= {"v": v, "load": load, "F_ext": F_ext}
    # A curve is held against friction that does not grow with the time at rest.
    parameters = {name: value for name, value in read_values(given).items() if name in given}
    columns = {"t": time, "x": x, "x_dot": x_dot, "F": force}
    names = {quantity: name for quantity, name in columns.items() if name is not None}
    try:
        result = judge(read_curve(curve, names), parameters)
    except (CurveError, ValueError) as error:
        raise CommandError(str(error)) from error
    if json:
        from json import dumps

        print(dumps(as_json(result), indent=2, ensure_ascii=False, allow_nan=False))
        return
    from stickslip.show.score_table import score_table

    console().print(score_table(result))
