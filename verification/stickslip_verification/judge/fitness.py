"""Fitness for a purpose: which quantities of an FMU stay within a part of their largest value.

The verdict asks whether an FMU solves the equations; fitness asks how far off it is. Jump, stick,
slip, period and forces are compared with the exact motion at the same moment of the same stick or
slip (`drive.moments`), so that a shift of the events in time, which adds up over the cycles, is not
taken for an error of the forces. The error is a part of the largest value of the quantity in the
case.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.exact import Exact
from stickslip_verification.drive.moments import Moments
from stickslip_verification.model.run import Run
from stickslip_verification.model.verdict import Table

FITNESS: Final = "Fitness"
"""Title of the table that answers for each quantity; that of the places is longer."""

QUANTITIES: Final[Mapping[str, tuple[str, ...]]] = {
    "jump": ("delta_x",),
    "stick": ("t_stick",),
    "slip": ("t_slip",),
    "period": ("T",),
    "forces": ("F", "F_friction"),
}
"""What fitness is about, and the outputs that show it."""

_COUNT_SLACK: Final = 1
"""Slips by which the count at the end may differ beyond `within`: the last may be under way."""


_FIRST_CYCLE: Final = 2
"""Completed slips after which every meter has a stick, a slip and a period to show."""


@dataclass(frozen=True)
class Fit:
    """How far a quantity is off in a case.

    Attributes
    ----------
    case, quantity
        Id of the case and key of `QUANTITIES`.
    error
        Largest error, as a part of the largest exact value; infinite where there is nothing to
        compare and that is the FMU's fault, None where the quantity does not apply.
    time
        When [s], None where it is about the whole run.
    why
        The reason where no numbers were compared, else "".
    """

    case: str
    quantity: str
    error: float | None
    time: float | None = None
    why: str = ""


def without_run(case: str, answer: Answer[Run]) -> list[Fit]:
    """Return the fits of a case that the FMU cannot run, or did not finish."""
    if answer.not_applicable is not None:
        return [Fit(case, name, None, why=answer.not_applicable) for name in QUANTITIES]
    why = f"the run did not end: {answer.failure}"
    return [Fit(case, name, math.inf, why=why) for name in QUANTITIES]


def fits_of(
    case: str, exact: Exact, run: Run, matched: Answer[Moments], within: float
) -> list[Fit]:
    """Compare the quantities of one case.

    Parameters
    ----------
    case
        Its id.
    exact
        The exact motion.
    run
        What the FMU did.
    matched
        The exact motion at the moments of the run.
    within
        Part of the number of slips that may be missing or too many at the end.
    """
    moments = matched.value
    if moments is None:
        why = matched.not_applicable or f"not compared: {matched.failure}"
        return [Fit(case, name, None, why=why) for name in QUANTITIES]
    wanted, got = (int(side.outputs["n_slips"][-1]) for side in (exact.record, run))
    if abs(got - wanted) > _COUNT_SLACK + within * wanted:
        error = abs(got - wanted) / max(wanted, 1)
        return [Fit(case, name, error, why=f"{got} slips, not {wanted}") for name in QUANTITIES]
    if 2 * moments.lost > len(run.times):
        why = (
            f"{moments.lost} of {len(run.times)} points lie in no stick or slip of the exact motion"
        )
        return [Fit(case, name, math.inf, why=why) for name in QUANTITIES]
    return [_fit(case, name, exact, run, moments) for name in QUANTITIES]


def _fit(case: str, quantity: str, exact: Exact, run: Run, moments: Moments) -> Fit:
    names = [name for name in QUANTITIES[quantity] if name in run.outputs]
    if not names:
        return Fit(case, quantity, None, why=f"it has no output {QUANTITIES[quantity][0]}")
    scales = {name: float(np.max(np.abs(exact.record.outputs[name]))) for name in names}
    if not any(scales.values()):
        return Fit(case, quantity, None, why="there is none in the exact motion")
    if quantity == "forces":
        chosen = moments.dated
        if 2 * np.count_nonzero(chosen) < len(chosen):
            return Fit(case, quantity, None, why="it has no output t_event")
    else:
        # A meter holds its value through the phase. What it shows before the first whole cycle, a
        # number or nothing, is a convention of the start.
        [name] = names
        shows = run.outputs[name][moments.places] != 0.0
        late = run.outputs["n_slips"][moments.places] >= _FIRST_CYCLE
        chosen = late | (shows == (moments.exact[name] != 0.0))
    places = moments.places[chosen]
    if not len(places):
        return Fit(case, quantity, None, why="no moments to compare")
    errors = np.zeros(places.shape)
    for name in names:
        if scales[name]:
            difference = np.abs(run.outputs[name][places] - moments.exact[name][chosen])
            errors = np.maximum(errors, difference / scales[name])
    errors = np.where(np.isfinite(errors), errors, np.inf)
    worst = int(np.argmax(errors))
    return Fit(case, quantity, float(errors[worst]), float(run.times[places[worst]]))


def tables_of(fits: Sequence[Fit], within: float) -> list[Table]:
    """Return the answer for each quantity, and the places where one is not within."""
    share = f"{100.0 * within:g} %"
    answer = Table(
        f"{FITNESS}: within {share}?",
        "Jump, stick, slip, period and forces of the FMU against the exact motion, whatever the "
        "verdict.",
        ("quantity", f"within {share}", "cases within", "largest error [%]", "in the case"),
        [_row(name, [fit for fit in fits if fit.quantity == name], within) for name in QUANTITIES],
        "Compared at the same moment of the same stick or slip, numbered by the completed slips; "
        "the error is a part of the largest value in the case. Cases of conventions of the "
        "interface are left out. A curve without a meter is judged by stickslip score.",
    )
    outside = sorted(
        (fit for fit in fits if fit.error is not None and not fit.error <= within),
        key=lambda fit: (list(QUANTITIES).index(fit.quantity), -(fit.error or 0.0)),
    )
    if not outside:
        return [answer]
    places = Table(
        f"{FITNESS}: where not within {share}",
        "Each case and quantity with a larger error, the largest first.",
        ("case", "quantity", "error [%]", "at [s]", "why"),
        list(map(_place, outside)),
    )
    return [answer, places]


def _row(quantity: str, fits: Sequence[Fit], within: float) -> Sequence[str | float]:
    label = f"{quantity} ({', '.join(QUANTITIES[quantity])})"
    errors = {fit: fit.error for fit in fits if fit.error is not None}
    if not errors:
        why = next((fit.why for fit in fits if fit.why), "no case")
        return (label, "not applicable", "0 of 0", "", why)
    good = sum(error <= within for error in errors.values())
    worst = max(errors, key=errors.__getitem__)
    word = "yes" if good == len(errors) else "no"
    return (label, word, f"{good} of {len(errors)}", _percent(errors[worst]), worst.case)


def _place(fit: Fit) -> Sequence[str | float]:
    assert fit.error is not None
    return (
        fit.case,
        fit.quantity,
        _percent(fit.error),
        "" if fit.time is None else fit.time,
        fit.why,
    )


def _percent(error: float) -> str | float:
    return float(f"{100.0 * error:.3g}") if math.isfinite(error) else "no value"
