"""Runs, and what came out: one result per check and side, their counts, what stands behind them."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ..truth.course import Event as Event
from ..truth.course import Step

Series = NDArray[np.float64]
CommunicationStep = Step  # of h [s]; its changes (name to value, SI) are set just before it


def points(lengths: Iterable[float]) -> tuple[float, ...]:
    """Partial sums, each correctly rounded (Neumaier's compensation), starting at 0."""
    total = carry = 0.0
    ends = []
    for h in lengths:
        bigger = total + h
        carry += (total - bigger) + h if abs(total) >= abs(h) else (h - bigger) + total
        total = bigger
        ends.append(total + carry)
    return tuple(ends)


@dataclass(frozen=True)
class Run:
    """The outputs of one run, in SI units, sampled at the end of each communication step.

    ``times`` are the communication points after the start [s], shape ``(n,)``. ``outputs`` are the
    samples by name, shape ``(n,)`` each; integers and Booleans as numbers; an output that the side
    does not have is not among the keys. ``initial`` are the values after initialization,
    ``messages`` what the side logged, in order: warnings of the clamp, for example.
    """

    times: Series
    outputs: Mapping[str, Series]
    initial: Mapping[str, float]
    messages: tuple[str, ...] = field(default=())


class Transition(StrEnum):
    """The kinds of transition: stick to slip, slip to stick, slip to slip the other way."""

    BREAK_AWAY = "break-away"
    RE_STICK = "re-stick"
    REVERSAL = "reversal"


def events_between(samples: NDArray[np.void], v: float) -> tuple[tuple[Event, ...], int]:
    """Recover the transitions between the samples from the outputs, inputs being constant.

    A sample tells the time of the last transition and the length of the last stick and slip; that
    dates up to two transitions in an interval exactly. The mass does not move while it sticks and
    the pulled end moves at constant speed, so the place of each follows without interpolation.

    ``samples``, shape (n,), are structured: ``time`` and the outputs ``mode``, ``n_slips``,
    ``t_event``, ``t_stick``, ``t_slip``, ``delta_x``, ``x``, ``x_pull``; `v` is the velocity of the
    pulled end [m/s]. The second value is the number of intervals that hold more than two
    transitions, or cannot be told for such an interval just before.
    """
    first = samples[0]
    # What an unseen or an unfinished slip began from: the first sample.
    origin = _event(first, float(first["time"]), Transition.BREAK_AWAY, float(first["x"]), v)
    events = [origin] if first["mode"] != 0 and first["x_dot"] == 0.0 else []
    previous: Event | None = origin
    hidden = 0
    changed = np.flatnonzero(
        (np.diff(samples["t_event"]) != 0.0) | (np.diff(samples["n_slips"]) != 0)
    )
    for before, after in zip(samples[changed], samples[changed + 1], strict=True):
        found = _events_in(before, after, previous, v)
        hidden += not found
        events.extend(found)
        previous = found[-1] if found else None
    return tuple(events), hidden


def _events_in(before: np.void, after: np.void, previous: Event | None, v: float) -> list[Event]:
    """Return the one or two transitions between two samples; nothing where they cannot be told.

    That is where there are more, or where a slip ends whose beginning is hidden: `previous` None.
    """
    time, slips = float(after["t_event"]), int(after["n_slips"]) - int(before["n_slips"])
    slipped, slips_now = before["mode"] != 0, after["mode"] != 0
    if slips == 0 and not slipped and slips_now:
        return [_event(after, time, Transition.BREAK_AWAY, float(before["x"]), v)]
    if slips == 1 and not slips_now:
        stop = _event(after, time, Transition.RE_STICK, float(after["x"]), v, mode=0)
        if slipped:
            return [stop]
        mode, broke_away = 1 if after["delta_x"] > 0 else -1, time - float(after["t_slip"])
        return [_event(after, broke_away, Transition.BREAK_AWAY, float(before["x"]), v, mode), stop]
    if slips == 1 and slipped and previous is not None:
        x = previous.x + float(after["delta_x"])
        t_stick = float(after["t_stick"])
        after_slip = time - previous.time - float(after["t_slip"])
        # A break-away the other way needs a stick in which the spring comes over: after a slip
        # that ended just now it was none.
        reversed_at_once = abs(after_slip) <= abs(after_slip - t_stick)
        if after["mode"] == -before["mode"] and reversed_at_once:
            return [_event(after, time, Transition.REVERSAL, x, v)]
        return [
            _event(after, time - t_stick, Transition.RE_STICK, x, v, mode=0),
            _event(after, time, Transition.BREAK_AWAY, x, v),
        ]
    return []


def _event(
    sample: np.void, time: float, kind: Transition, x: float, v: float, mode: int | None = None
) -> Event:
    x_pull = float(sample["x_pull"]) - v * (float(sample["time"]) - time)
    return Event(time, kind, int(sample["mode"]) if mode is None else mode, x, x_pull - x)


SEQUENCE: Final = "sequence-"  # start of the case id of a random sequence; the rest is its number


class Kind(StrEnum):
    """The four kinds of truth, never mixed; strongest first."""

    CLOSED_FORM = "closed_form"
    INVARIANT = "invariant"
    CONVERGENCE = "convergence"
    CROSS_CODE = "cross_code"


class Klass(StrEnum):
    """What a check is about: physics, or a convention of the interface."""

    PHYSICS = "physics"
    CONTRACT = "contract"


class Measure(StrEnum):
    """The measure of an error: part of the value, part of the scale, or in the unit."""

    RELATIVE = "relative"
    OF_SCALE = "of_scale"
    ABSOLUTE = "absolute"


class Outcome(StrEnum):
    """The outcome of a check; ``noted`` is a failure that does not decide."""

    PASS = "pass"
    FAIL = "fail"
    NOTED = "noted"
    NOT_APPLICABLE = "not applicable"


@dataclass(frozen=True, kw_only=True)
class CheckResult:
    """One check on one side.

    ``case`` and ``check`` are ids; the case is "" where a check is about the FMU and not about a
    motion. ``side`` is fmu, reference, or both where the two are compared. ``expected`` and ``got``
    are in ``unit``, at the worst place where a check looks at many; ``error`` and ``tolerance``,
    which comes from ``because``, are in the measure of the check. ``got`` and ``error`` are None
    where the side gave nothing that can be compared; ``failure`` then says why, else it is None.
    A check that cannot be made on this side is neither passed nor failed: ``not_applicable`` says
    why. ``decides``: a failure fails the verdict. ``late``: the run failed by its time limit.
    """

    case: str
    check: str
    quantity: str = ""
    unit: str = "1"
    truth: Kind
    side: str
    expected: float | None = None
    got: float | None = None
    error: float | None = None
    tolerance: float = 0.0
    because: str = ""
    passed: bool = False
    failure: str | None = None
    klass: Klass = Klass.PHYSICS
    measure: Measure = Measure.ABSOLUTE
    decides: bool = True
    not_applicable: str | None = None
    late: bool = False

    @property
    def verdict(self) -> Outcome:
        """One word: pass, fail, noted (failed, and does not decide) or not applicable."""
        if self.not_applicable is not None:
            return Outcome.NOT_APPLICABLE
        if not self.passed:
            return Outcome.FAIL if self.decides else Outcome.NOTED
        return Outcome.PASS

    @property
    def margin(self) -> float | None:
        """Error over tolerance, see `margin`; None where the check does not apply."""
        return None if self.not_applicable is not None else margin(self.error, self.tolerance)

    @property
    def failed(self) -> bool:
        """Whether this result alone fails the verdict."""
        return self.verdict == Outcome.FAIL


class CaseGroup(StrEnum):
    """The groups of cases, in the order of the report."""

    DEFAULT = "Default parameters"
    SETTINGS = "Other settings"
    DAMPING = "Damping"
    CHANGES = "Changes in the run"
    STARTS = "Start values"
    DWELL = "Static friction that grows at rest"
    LAWS = "Other friction laws"
    CONVENTIONS = "Conventions of the interface"


@dataclass(frozen=True)
class Motion:
    """What the sides that ran did in a case, by name, with the exact motion: for its plot.

    ``events`` are exact. ``group`` is where the report shows the case.
    """

    case: str
    title: str
    about: str
    exact: Run
    events: Sequence[Event]
    records: Mapping[str, Run]
    group: CaseGroup = CaseGroup.SETTINGS


@dataclass(frozen=True)
class ObservedOrder:
    """How an error of the reference falls with its tolerance.

    ``orders[i]`` is the slope of log error over log tolerance from level ``i`` to ``i + 1``;
    ``expected`` is the order that the method promises.
    """

    case: str
    quantity: str
    tolerances: Sequence[float]
    errors: Sequence[float]
    orders: Sequence[float]
    expected: float


@dataclass(frozen=True)
class Detection:
    """What became of one planted fault.

    ``caught``: one of the checks ``wanted``, which its description names in advance, failed.
    ``failing`` gives, per check that failed, in how many cases; ``broken`` says why the mutant
    could not be judged.
    """

    mutant: str
    about: str
    wanted: Sequence[str]
    failing: Mapping[str, int]
    caught: bool
    broken: str | None = None


@dataclass(frozen=True)
class KillMatrix:
    """Every planted fault against every check, in the order of the suite.

    ``kills_nothing`` gives, for each check that kills no mutant, why it stays ("" where nothing
    says why, which fails the suite). Where it is not ``whole``, each fault was tried on the
    foretold checks, up to the first that failed.
    """

    checks: Sequence[str]
    rows: Sequence[Detection]
    kills_nothing: Mapping[str, str]
    whole: bool = True

    @property
    def passed(self) -> bool:
        """Whether every fault was caught as foretold and each check without a kill has a reason."""
        return all(row.caught for row in self.rows) and all(self.kills_nothing.values())


LIKELIEST = "What is it likeliest to do instead?"  # asked of a model that is wrong


@dataclass(frozen=True)
class Question:
    """A question that a verdict answers in a sentence, and whether the answer is a good one."""

    asked: str
    good: bool
    answer: str


@dataclass(frozen=True)
class Table:
    """A table of the report: a heading, a sentence above, a text below it.

    The first cell of a row names it; a cell without a count holds the reason as text.
    """

    title: str
    about: str
    head: Sequence[str]
    rows: Sequence[Sequence[str | int | float]]
    note: str = ""


@dataclass(frozen=True)
class ChosenContract:
    """The contract of an FMU: exact, physics or strict, and where the choice comes from."""

    name: str
    why: str


@dataclass(frozen=True)
class Verdict:
    """All results of a run, what stands behind them, and where they come from.

    ``kills`` is None where no faults were planted.
    """

    checks: Sequence[CheckResult]
    provenance: Mapping[str, Any] = field(default_factory=dict)
    motions: Sequence[Motion] = ()
    orders: Sequence[ObservedOrder] = ()
    kills: KillMatrix | None = None
    contract: ChosenContract = ChosenContract("exact", "no other one was chosen")
    tables: Sequence[Table] = ()
    questions: Sequence[Question] = ()

    def __repr__(self) -> str:
        return f"<Verdict: {self.summary}>"

    @property
    def exact(self) -> bool:
        """Whether the FMU is held to the exact contract."""
        return self.contract.name == "exact"

    @property
    def summary(self) -> dict[str, int]:
        """Counts: passed, failed, noted, not_applicable."""
        return count(self.checks)

    @property
    def by_kind(self) -> dict[str, dict[str, int]]:
        """The same counts for each kind of truth that occurs, in the order of `Kind`."""
        sorted_out = {kind: [r for r in self.checks if r.truth == kind] for kind in Kind}
        return {kind: count(results) for kind, results in sorted_out.items() if results}

    @property
    def cases(self) -> list[str]:
        """Ids of the cases, random sequences and the FMU as a whole left out, as they ran."""
        return [case for case in self._places if case and not case.startswith(SEQUENCE)]

    @property
    def sequences(self) -> list[str]:
        """Ids of the random sequences, as they ran."""
        return [case for case in self._places if case.startswith(SEQUENCE)]

    @property
    def _places(self) -> dict[str, None]:
        return dict.fromkeys(result.case for result in self.checks)

    @property
    def proven(self) -> bool:
        """Whether the FMU met a truth about a motion at all.

        That FMU and reference agree, that the reference is right, or that calls are answered as
        they should be, makes no FMU green.
        """
        of_fmu = [r for r in self.checks if r.case and r.decides and r.side == "fmu"]
        truths = (Kind.CLOSED_FORM, Kind.INVARIANT)
        return any(r.verdict == Outcome.PASS and r.truth in truths for r in of_fmu)

    @property
    def passed(self) -> bool:
        """Whether nothing that decides failed, the FMU met a truth, and every fault was caught."""
        detected = self.kills is None or self.kills.passed
        answered = all(question.good for question in self.questions)
        failed = any(result.failed for result in self.checks)
        return self.proven and detected and answered and not failed


def count(results: Sequence[CheckResult]) -> dict[str, int]:
    """Count results by verdict: passed, failed, noted, not_applicable."""
    verdicts = [result.verdict for result in results]
    names = ("passed", "failed", "noted", "not_applicable")
    return {name: verdicts.count(each) for name, each in zip(names, Outcome, strict=True)}


def margin(error: float | None, tolerance: float) -> float:
    """Return error over tolerance: 0 is exact, 1 the edge, infinity where nothing was comparable.

    A tolerance of 0 allows only an error of 0.
    """
    if error is None or not math.isfinite(error):
        return math.inf
    if tolerance == 0.0:
        return 0.0 if error == 0.0 else math.inf
    return error / tolerance


def value_text(value: float | None, digits: int = 9) -> str:
    """Write a value with nine digits."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0.0 else "−∞"
    # Rounded first, so that 480 is not written 4.8e2.
    text = format(float(format(value, f".{digits}g")), f".{max(digits, 6)}g")
    return "0" if value == 0.0 else text.replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def error_text(value: float | None) -> str:
    """Write an error or a tolerance with two digits."""
    return value_text(value, 2)
