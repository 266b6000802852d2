"""Makes the tables and pictures of docs/feed-axis.md, and checks them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from stickslip_verification.report.svg import SAME, as_svg, differences

from . import plots, study
from .axis import Axis
from .coupling import Order, Run, simulate
from .monolithic import solve

STEPS: Final = (1e-3, 500e-6, 250e-6, 125e-6, 62.5e-6)
"""Communication steps of the convergence study [s]."""

WAYS: Final[dict[str, tuple[Order, bool]]] = {
    "as shipped": ("jacobi", True),
    "table before drive": ("table first", True),
    "force held": ("jacobi", False),
}
"""Ways of coupling: what steps when, and whether the drive follows the spring."""

COUPLING_TIME: Final = 0.5

TOLERANCE: Final = 0.02
"""Relative, of the numbers in the tables. On another machine a count of an encoder may fall the
other way; a jump of 10 um then moves by a count of 0.1 um, and so does the cycle."""

ROUNDING: Final = 1e-6
"""Relative, of the coupling errors: without encoder counts only rounding is another one on another
machine, and the last digit told covers it."""

COUNTED: Final = 1.5
"""Distance [pt] up to which a line of a run is the same, its width. A count of an encoder that
falls the other way moves a jump by 0.1 um and the next by 0.4 ms: 0.8 pt."""

PHASE: Final = 3.0
"""The same for three seconds of hunting: with the last digit of k changed, every jump comes 6 ms
later, which is 0.9 pt, and 1.9 pt up or down where a steep line leaves the panel."""


class Picture(NamedTuple):
    """The title of a picture and the distance [pt] up to which its lines are the same."""

    title: str
    same: float


PICTURES: Final = {
    "creeping": Picture("A feed axis at constant feed", COUNTED),
    "creeping-variants": Picture("Following error of every variant", COUNTED),
    "rising": Picture("Jumps while the feed rises", COUNTED),
    "hunting": Picture("A feed axis that hunts around its target", PHASE),
    "hunting-variants": Picture("Distance from the target of every variant", COUNTED),
    "coupling": Picture("Error of the coupling over the communication step", SAME),
}

Tell = Callable[[str], None]


def write_document(document: Path, folder: Path, tell: Tell) -> None:
    """Write tables and pictures anew, from FMUs in `folder`."""
    text = document.read_text(encoding="utf-8")
    made = dict(study.tables(folder, tell))
    tell("coupling")
    errors = coupling_errors(folder)
    made["coupling"] = coupling_table(errors)
    document.write_text(study.with_tables(text, made), encoding="utf-8", newline="\n")
    pictures = document.with_suffix("")
    pictures.mkdir(exist_ok=True)
    tell("pictures")
    for name, svg in pictures_of(folder, errors).items():
        (pictures / f"{name}.svg").write_text(svg, encoding="utf-8", newline="\n")


def check_document(document: Path, folder: Path, tell: Tell) -> list[str]:
    """Return what tables and pictures show otherwise than runs of the FMUs in `folder`."""
    text = document.read_text(encoding="utf-8")
    wrong = check_variants(text, folder, tell)
    tell("coupling")
    errors = coupling_errors(folder)
    wrong += check_coupling(text, errors)
    tell("pictures")
    return wrong + check_pictures(document, pictures_of(folder, errors))


def check_pictures(document: Path, drawn: Mapping[str, str]) -> list[str]:
    """Return what the pictures of the how-to show otherwise than those drawn, by their names."""
    folder = document.with_suffix("")
    return [
        each
        for name, svg in drawn.items()
        for each in differences(folder / f"{name}.svg", svg, PICTURES[name].same)
    ]


def check_variants(
    text: str, folder: Path, tell: Tell, variants: tuple[str, ...] | None = None
) -> list[str]:
    """Return what the tables of creeping and hunting say otherwise than runs.

    Parameters
    ----------
    text
        The how-to.
    folder
        Where the FMUs are.
    tell
        Takes what is being done.
    variants
        Names of the variants to look at; all where None.
    """
    wrong = []
    for name, of, row in (
        ("creep", study.CREEPING, study.creep_row),
        ("hunting", study.HUNTING, study.hunting_row),
    ):
        told = study.rows_of(text, name)
        names = [each.name for each in of]
        if list(told) != names:
            wrong.append(f"{name}: the rows are {list(told)}, not {names}")
            continue
        for variant in of:
            if variants is None or variant.name in variants:
                tell(f"{name}: {variant.name}")
                wrong += study.differences(told[variant.name], row(folder, variant), TOLERANCE)
    return wrong


def check_coupling(text: str, errors: dict[str, list[float]]) -> list[str]:
    """Return what the table of coupling errors says otherwise than `coupling_errors`."""
    told = study.rows_of(text, "coupling")
    found = study.rows_in(coupling_table(errors))
    if list(told) != list(found):
        return [f"coupling: the rows are {list(told)}, not {list(found)}"]
    wrong = []
    for step, row in told.items():
        wrong += study.differences(row, found[step], ROUNDING)
    return wrong


def coupling_errors(folder: Path) -> dict[str, list[float]]:
    """Return the largest error of the table's position [m], by way of coupling, over `STEPS`."""
    axis = exact_axis()
    truth = solve(axis, COUPLING_TIME).column("x", axis)
    errors = {}
    for name, (order, follow) in WAYS.items():
        errors[name] = [
            position_error(
                simulate(folder, replace(axis, follow=follow), COUPLING_TIME, step, order),
                truth,
                step / axis.T_s,
            )
            for step in STEPS
        ]
    return errors


def exact_axis() -> Axis:
    """Return the axis without encoder counts, whose rounding would hide how errors shrink."""
    return replace(study.BASE, resolution_motor=0.0, resolution_table=0.0)


def position_error(run: Run, truth: plots.Array, samples_per_step: float) -> float:
    """Return the largest error of the table's position [m] where run and truth have a point."""
    if samples_per_step >= 1.0:
        truth = truth[:: round(samples_per_step)]
        return float(np.max(np.abs(run["x"] - truth)))
    return float(np.max(np.abs(run["x"][:: round(1.0 / samples_per_step)] - truth)))


def coupling_table(errors: dict[str, list[float]]) -> list[str]:
    """Return the lines of the table of coupling errors."""
    lines = [
        "| communication step [µs] | " + " | ".join(errors) + " |",
        "|---" * (1 + len(errors)) + "|",
    ]
    for row, step in enumerate(STEPS):
        cells = [f"{step * 1e6:g}", *(f"{values[row] * 1e6:#.3g}" for values in errors.values())]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def pictures_of(folder: Path, errors: dict[str, list[float]]) -> dict[str, str]:
    """Return the pictures of the how-to by name, as SVG text."""
    base = study.VARIANTS[0]
    creeping = {each.name: study.creep_run(folder, each) for each in study.CREEPING}
    holding = {each.name: study.hunting_run(folder, each) for each in study.HUNTING}
    rising = study.rising_run(folder, base.axis)
    jump = float(np.max(creeping[base.name]["delta_x"][-100:]))
    with plots.styled():
        pages = {
            "creeping": plots.creeping(creeping[base.name], base.axis, 1.5, 0.2),
            "creeping-variants": plots.small_multiples(creeping, 1.5, 0.15, (1e-3, "ms")),
            "rising": plots.rising(rising, base.axis),
            "hunting": plots.holding(holding[base.name], base.axis, 15.0, 3.0),
            "hunting-variants": plots.small_multiples(holding, None, 6.0, (1.0, "s")),
            "coupling": plots.convergence(STEPS, errors, jump),
        }
        return {name: as_svg(pages[name], Title=PICTURES[name].title) for name in PICTURES}
