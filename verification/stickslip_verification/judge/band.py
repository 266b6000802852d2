"""What of an exact motion is physics, and how large the quantities in it are.

What our interface merely agreed on is not physics: values of the start, and what the meter counts
of a start in motion.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.drive.exact import Exact
from stickslip_verification.model.events import Transition
from stickslip_verification.model.quantities import OUTPUTS, QUANTITIES
from stickslip_verification.model.run import Run, Series

Mask = NDArray[np.bool_]

_METER = (
    *("delta_x", "spring_drop", "t_stick", "t_slip", "T", "f", "x_dot_peak"),
    *("n_slips", "t_event"),
)
"""Outputs of the meter, whose beginning is a matter of agreement."""


@dataclass(frozen=True)
class Band:
    """What a run of a case is compared with at each point, with what was ``agreed`` on or not."""

    exact: Exact
    agreed: bool = False

    def judged(self, quantity: str) -> Mask:
        """Return the points at which a quantity is physics."""
        meant = [self._meant(output) for output in QUANTITIES[quantity].needs]
        finite = np.isfinite(self._samples(quantity, self.exact.record))
        return np.asarray(finite & np.all(meant, axis=0))

    def pair(self, quantity: str, run: Run) -> tuple[NDArray[np.intp], Series, Series, Mask]:
        """Return a quantity in the exact motion and in a run, at the points that the run has.

        First the indices of these points, last where the quantity is physics. Slips are counted
        from the first event where the start counts none: NaN before, and everywhere in a run that
        does not have that point.
        """
        read = np.minimum(np.searchsorted(self._times, run.times), self._times.size - 1)
        expected = self._samples(quantity, self.exact.record)[read]
        got = self._samples(quantity, run)
        if quantity == "x_pull" and not self.agreed and read.size > 1:
            # Where the pulled end is counted from is a matter of agreement.
            expected, got = expected - expected[0], got - got[0]
        if quantity == "n_slips" and self._starts_in_motion and not self.agreed:
            first = np.flatnonzero(self._meant(quantity))[:1]
            base = np.flatnonzero(np.isin(read, first))
            expected = expected - (expected[base] if base.size else np.nan)
            got = got - (got[base] if base.size else np.nan)
        return read, expected, got, self.judged(quantity)[read] & np.isfinite(expected)

    def _samples(self, quantity: str, run: Run) -> Series:
        with np.errstate(all="ignore"):
            samples = QUANTITIES[quantity].compute(run.outputs, self.exact.start)
        return np.asarray(samples, dtype=np.float64)

    def largest(self, quantity: str) -> float:
        """Return the largest value in play of what has the unit of a quantity, in that unit."""
        unit = QUANTITIES[quantity].unit
        alike = [each.name for each in OUTPUTS if each.unit == unit != "1"] or [quantity]
        values = [self._samples(name, self.exact.record) for name in alike]
        values += [self._pull] if unit == "m/s" else [self._times] if unit == "s" else []
        return float(max(np.max(np.abs(v[np.isfinite(v)]), initial=0.0) for v in values))

    @property
    def _pull(self) -> Series:
        """Mean speed of the pulled end over each step [m/s]."""
        record = self.exact.record
        places = np.concatenate(([record.initial["x_pull"]], record.outputs["x_pull"]))
        return np.asarray(np.diff(places) / np.diff(np.concatenate(([0.0], self._times))))

    @property
    def _times(self) -> Series:
        return self.exact.record.times

    def _meant(self, output: str) -> Mask:
        """Return the points at which an output is physics, and not what our meter agreed on.

        That is whether a start in motion is a slip, the first stick a stick, and a reversal a
        break-away.
        """
        if self.agreed or output not in _METER:
            return np.ones(self._times.size, dtype=np.bool_)
        breaks = self._happened(Transition.BREAK_AWAY)
        if output in ("T", "f"):
            return self._cycled(breaks, 2)
        if output == "t_stick":
            return self._cycled(breaks, 1)
        if output == "t_event":
            return np.asarray(self._times > np.min(self._happened(*Transition), initial=np.inf))
        ends = self._happened(Transition.RE_STICK, Transition.REVERSAL)
        if output == "n_slips":
            began = 0.0 if self._starts_in_motion else -np.inf
        else:
            began = float(np.min(breaks, initial=np.inf))
        first = np.min(ends[ends > began], initial=np.inf)
        whole = output == "n_slips" and not self._starts_in_motion
        return np.asarray(whole | (self._times > first))

    def _cycled(self, breaks: Series, back: int) -> Mask:
        """Return the points after two break-aways at least, the last `back` without a reversal."""
        # A break-away that a change brings about shows after the next step.
        count = np.searchsorted(breaks, self._times)
        since = np.append(breaks, np.inf)[np.where(count >= 2, count - back, -1)]
        reversals = self._happened(Transition.REVERSAL)
        turned = np.searchsorted(reversals, self._times) > np.searchsorted(reversals, since)
        return np.asarray((count >= 2) & ~turned)

    def _happened(self, *kinds: Transition) -> Series:
        """Return the times of these transitions [s], those at the very start left out."""
        events = self.exact.events
        return np.array([each.time for each in events if each.kind in kinds and each.time > 0.0])

    @property
    def _starts_in_motion(self) -> bool:
        first = self.exact.events[0] if self.exact.events else None
        at_once = first is not None and first.time == 0.0
        return at_once or self.exact.start["x_dot_start"] != 0.0
