"""Probes that play calls of a master, and look at the motion that follows.

The calls are data: see `Call`. A `tolerance` is a part of the largest value in the same unit; None
asks for the same bits.
"""

import math
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import Any

import numpy as np

from ..model.quantities import FORMULAS, OUTPUT_NAMES, OUTPUTS, QUANTITIES
from ..model.verdict import Series
from ..truth.parameters import PARAMETERS, START_VALUES, Kind, complete
from . import masters
from .description import UNITS, FmuError
from .instance import FmuFile, FmuInstance, available
from .masters import NotApplicableError, defaults, lacking, need

Call = Mapping[str, Any]
"""One call of a master: ``{ set = { name = value } }`` sets variables (SI), ``{ start = time }``
initializes at a start time [s], ``{ step = h }`` makes a step of h [s], with ``times`` so many."""
Row = Mapping[str, float]  # outputs at one time, by name (SI)

Calls = Sequence[Call]
Rows = Sequence[Row]

_MOST_COMPLAINTS = 3

_ALIKE = 0.05
"""Difference of mean and of deviation, as a part of the deviation; the points' places in the cycles
make a fifth of it."""
_PARTS = 12  # of a step, where the motion in whole ones changes
_AS_FAR = 0.9  # of the way in whole steps, that one in parts has to come to clear an FMU


class Caller:
    """A master of one instance, which sets our defaults first; it plays calls, knows the time."""

    def __init__(self, fmu: FmuFile, instance: FmuInstance) -> None:
        self.instance = instance
        self.names = available(fmu, OUTPUT_NAMES)
        self.start = 0.0
        self.steps: list[float] = []
        self._read = instance.reader(self.names)
        instance.set(defaults(fmu))

    def play(self, calls: Iterable[Call]) -> list[Row]:
        """Play calls; return the outputs after each step."""
        rows = []
        for call in calls:
            if "set" in call:
                self.instance.set(call["set"])
            elif "start" in call:
                self.start = call["start"]
                self.instance.start({}, self.start)
            else:
                for _ in range(call.get("times", 1)):
                    self.instance.step(self.start + math.fsum(self.steps), call["step"])
                    self.steps.append(call["step"])
                    rows.append(self.row())
        return rows

    def row(self) -> Row:
        """Read the outputs."""
        return dict(zip(self.names, self._read(), strict=True))


@contextmanager
def calling(fmu: FmuFile, calls: Iterable[Call]) -> Iterator[Caller]:
    """Give a caller that has played these calls on an instance of its own."""
    with fmu.instantiate() as instance:
        caller = Caller(fmu, instance)
        caller.play(calls)
        yield caller


def played(fmu: FmuFile, calls: Iterable[Call], then: Iterable[Call]) -> tuple[Caller, list[Row]]:
    """Play calls on an instance of its own; return the outputs after the steps of `then`."""
    with calling(fmu, calls) as caller:
        return caller, caller.play(then)


def check_playable(fmu: FmuFile, calls: Iterable[Call]) -> None:
    """Raise `NotApplicableError` if the FMU lacks a variable that is set, or cannot change it."""
    running = False
    for call in calls:
        running = running or "start" in call
        values = call.get("set", {})
        need(fmu, lacking(fmu, values))
        masters.need_changeable(fmu, values if running else ())


def same_motion(
    fmu: FmuFile,
    calls: Calls,
    like: Calls,
    then: Calls,
    tolerance: float | None = None,
    may_refuse: bool = False,
    ignored: Sequence[str] = (),
) -> list[str]:
    """Complain if `calls` and `like` do not lead to the same outputs after the steps of `then`.

    If the start times differ, `t_event` may count from 0 or from the start; it is not compared bit
    for bit then. The FMU `may_refuse` calls that its own convention excludes.
    """
    check_playable(fmu, chain(calls, then))
    check_playable(fmu, chain(like, then))
    masters.need_instances(fmu)
    other, expected = played(fmu, like, then)
    with calling(fmu, ()) as caller:
        try:
            caller.play(calls)
        except FmuError as error:
            if may_refuse:
                raise NotApplicableError(f"it refuses the calls: {error}") from None
            raise
        got = caller.play(then)
    later = caller.start - other.start
    if later and "t_event" in caller.names:
        if tolerance is None:
            ignored = [*ignored, "t_event"]
        got = [_dated(a, b, later) for a, b in zip(got, expected, strict=True)]
    return differences(got, expected, tolerance, ignored)


def gives(fmu: FmuFile, calls: Calls, outputs: Row, tolerance: float | None = None) -> list[str]:
    """Complain if the outputs after the calls are not these; `tolerance` is a part of the value."""
    check_playable(fmu, calls)
    names = available(fmu, outputs)
    if not names:
        need(fmu, outputs)
    with calling(fmu, calls) as caller:
        row = caller.row()
    return [
        f"{name} is {row[name]!r}, not {outputs[name]!r}"
        for name in names
        if not abs(row[name] - outputs[name]) <= (tolerance or 0.0) * abs(outputs[name])
    ]


def steps_onto_restick(
    fmu: FmuFile,
    calls: Calls,
    into: float,
    over: float,
    then: Calls,
    tolerance: float,
    rests: bool = False,
) -> list[str]:
    """Complain if a step that ends exactly where a slip ends changes what follows.

    The `calls` end in a slip, `into` [s] after its break-away. A step `over` [s] from there ends in
    the stick after it, as does the first step of `then` after one to the end of the slip. With
    `rests` the mass must rest at the end of the slip already.
    """
    check_playable(fmu, chain(calls, then))
    need(fmu, ["t_slip"])
    masters.need_instances(fmu)
    _, (row,) = played(fmu, calls, [{"step": over}])
    t_slip = row["t_slip"]
    first, *others = then
    left = t_slip - into
    if not 0.0 < left < over:
        return [f"{into + over!r} s after the break-away t_slip is {t_slip!r}"]
    _, expected = played(fmu, calls, [{"step": left + first["step"]}, *others])
    _, (end, *got) = played(fmu, calls, [{"step": left}, *then])
    resting = {"sticking": 1.0, "mode": 0.0, "n_slips": 1.0, "x_dot": 0.0} if rests else {}
    complaints = [
        f"at the end of the slip {name} is {end[name]!r}, not {value!r}"
        for name, value in resting.items()
        if name in end and end[name] != value
    ]
    return complaints + differences(got, expected, tolerance)


def starts_at(fmu: FmuFile, time: float) -> list[str]:
    """Complain if `t_event` does not count from the start time [s]."""
    need(fmu, ["t_event"])
    first = time + float(FORMULAS["first_load_up"](complete({})))
    with calling(fmu, [{"start": time}]) as caller:
        begin = caller.row()["t_event"]
        rows = caller.play([{"step": 0.001, "times": 300}])
    if fmu.fmi_version == "3.0":
        # The interface promises it from the first step on: the wrapper tells it no sooner.
        begin = rows[0]["t_event"]
    dated = rows[-1]["t_event"]
    complaints = [] if begin == time else [f"t_event begins with {begin!r}, not {time!r}"]
    # Rounding of absolute times, and of a few additions.
    if not abs(dated - first) <= 16.0 * math.ulp(first):
        complaints.append(f"the first break-away is dated {dated!r}, not {first!r}")
    return complaints


def keeps_its_cycle(
    fmu: FmuFile,
    parameters: Mapping[str, float],
    step: float,
    count: int,
    window: int,
    seconds: float,
) -> list[str]:
    """Complain if the elongation of the spring is another one at the end of a long run.

    Of `count` steps of `step` [s] a `window` is compared at the beginning and at the end. After
    `seconds` of the processor, or twice as much of the clock, it ends with fewer. Where they
    differ, the same in steps of a part decides, for an FMU without steps of its own, in twice the
    time; it clears the FMU only as far as it comes.
    `NotApplicableError` if the FMU is too slow for a long run, or diverges from the beginning.
    """
    need(fmu, lacking(fmu, parameters))
    values = {**defaults(fmu), **parameters}
    start = {name: value for name, value in values.items() if fmu.has(name)}
    reached = 0.0
    for parts, most in ((1, seconds), (_PARTS, 2.0 * seconds)):
        points = masters.Setting(
            start, [masters.CommunicationStep(step / parts, {})] * count * parts
        )
        x = _course(fmu, points, most)
        came = x.size * step / parts
        if x.size < 4 * window * parts:
            raise NotApplicableError(f"{x.size} steps in {most:g} s are too few for a long run")
        stretched = values["v"] * step / parts * np.arange(1, x.size + 1) - x
        windows = stretched[window * parts : 2 * window * parts], stretched[-window * parts :]
        with np.errstate(all="ignore"):  # what diverges
            (mean, spread), (mean_then, spread_then) = ((np.mean(w), np.std(w)) for w in windows)
        if max(abs(mean_then - mean), abs(spread_then - spread)) <= _ALIKE * spread:
            # What comes less far does not clear what has aged later.
            if came < _AS_FAR * reached:
                raise NotApplicableError(f"{came:.0f} s in {most:g} s are too few for a long run")
            return []
        reached = came
    if not np.all(np.isfinite(windows[0])):
        raise NotApplicableError("its steps are too long for this block")
    return [
        f"after {came:.0f} s the spring is stretched otherwise than at the "
        f"beginning: mean {mean_then:.4g}, not {mean:.4g}; deviation {spread_then:.4g}, not "
        f"{spread:.4g}"
    ]


def _course(fmu: FmuFile, points: masters.Setting, seconds: float) -> Series:
    """Return x after each step that fits into `seconds` of the processor."""
    end, last_call = time.process_time() + seconds, time.monotonic() + 2.0 * seconds
    master = masters.Master(fmu, points)
    master.names = ["x"]
    run = master.run(lambda _: time.process_time() > end or time.monotonic() > last_call)
    return run.outputs["x"]


def differences(
    got: Rows, expected: Rows, tolerance: float | None = None, ignored: Iterable[str] = ()
) -> list[str]:
    """Return how two motions differ; what is discrete must be equal, and NaN equals NaN."""
    scales: dict[str, float] = {}
    for row in chain(got, expected):
        for name, value in row.items():
            unit, discrete = QUANTITIES[name].unit, QUANTITIES[name].discrete
            magnitude = abs(value) if math.isfinite(value) and not discrete else 0.0
            scales[unit] = max(scales.get(unit, 0.0), magnitude)
    complaints = []
    for name in got[0]:
        exact = tolerance is None or QUANTITIES[name].discrete
        allowed = 0.0 if exact else (tolerance or 0.0) * scales[QUANTITIES[name].unit]
        for number, (row, other) in enumerate(zip(got, expected, strict=True), start=1):
            a, b = row[name], other[name]
            same = a == b or abs(a - b) <= allowed or (math.isnan(a) and math.isnan(b))
            if not same and name not in ignored:
                complaints.append(f"{name} is {a!r} and not {b!r} after step {number}")
                break
    return complaints[:_MOST_COMPLAINTS]


def _dated(row: Row, like: Row, later: float) -> Row:
    """Return a row with `t_event` as in a run that began earlier, if it counts from 0."""
    dated = row["t_event"] - later
    nearer = abs(dated - like["t_event"]) < abs(row["t_event"] - like["t_event"])
    return {**row, "t_event": dated} if nearer else row


# The interface as it is specified, apart from any table of the FMU's own.
_SORTS = {
    each.name: "input continuous" if each.kind is Kind.INPUT else f"parameter {each.kind}"
    for each in PARAMETERS
} | {each.name: f"output {each.variability}" for each in OUTPUTS}
"""Causality and variability."""

_KINDS = {"Float64": "Real", "Int32": "Integer"}
"""Types of FMI 3.0 and the types of FMI 2.0 that hold the same numbers."""
_STEP, _LONG = 0.001, 1.0
"""An ordinary communication step, and one that holds several cycles of the default block [s]."""


def declared_variables(fmu: FmuFile) -> list[str]:
    """Find variables that are missing and outputs that are not of the interface."""
    complaints = [f"no variable {name}" for name in UNITS if not fmu.has(name)]
    return complaints + [f"an output too many: {name}" for name in fmu.extra_outputs]


def declared(fmu: FmuFile, of: str) -> list[str]:
    """Find variables of the interface with other units, types or starts, as `of` says."""
    kinds: dict[str, str] = {each.name: each.type for each in OUTPUTS}
    if fmu.fmi_version == "3.0":
        kinds["mode"] = "Enumeration"
    complaints = []
    for name, variable in ((name, fmu.variables[name]) for name in UNITS if fmu.has(name)):
        kind, unit = _KINDS.get(variable.kind, variable.kind), variable.unit or "no unit"
        sort = f"{kind} {variable.causality} {variable.variability}"
        right_kind = kinds.get(name, "Real")
        verb, seen, right = {
            "units": ("is declared in", unit, UNITS[name] if right_kind == "Real" else "no unit"),
            "types": ("is", sort, f"{right_kind} {_SORTS[name]}"),
            "starts": ("starts at", variable.start, START_VALUES.get(name, variable.start)),
        }[of]
        if seen != right:
            complaints.append(f"{name} {verb} {seen}, not {right}")
    return complaints


def refuses(
    fmu: FmuFile,
    set: Mapping[str, float],  # noqa: A002
    running: bool = False,
    step: float = _STEP,
) -> list[str]:
    """Complain if values or a step [s] are not refused by name, before the start or `running`."""
    need(fmu, set)
    text = _text(set) or f"a step of {step!r} s"
    with fmu.instantiate() as instance:
        if running:
            instance.start(defaults(fmu))
            instance.step(0.0, _STEP)
        refusal = _refusal(
            lambda: instance.set(set),
            lambda: instance.step(_STEP, step) if running else instance.start({}),
        )
    if refusal is None:
        return [f"{text} was taken"]
    # The suite's own words, before those of the FMU, name every variable.
    said = refusal.partition("failed:")[2] or refusal
    if all(re.search(rf"\b{name}\b", said) for name in set):
        return []
    return [f"{text} was refused without its name: {refusal}"]


def warns(fmu: FmuFile, set: Mapping[str, float], says: Sequence[str]) -> list[str]:  # noqa: A002
    """Complain if the log of a run with these values lacks one of the texts."""
    need(fmu, set)
    with fmu.instantiate() as instance:
        instance.start({**defaults(fmu), **set})
        instance.step(0.0, _STEP)
        log = " ".join(instance.messages)
    return [
        f"the log does not say {text}: {log or 'it is empty'}" for text in says if text not in log
    ]


def fails_until_reset(fmu: FmuFile, set: Mapping[str, float]) -> list[str]:  # noqa: A002
    """Complain if an FMU goes on after a refusal, or does not recover by a reset."""
    need(fmu, set)
    masters.need_instances(fmu)
    long: list[Call] = [{"set": defaults(fmu)}, {"start": 0.0}, {"step": _LONG}]
    _, (expected,) = played(fmu, (), long)
    with calling(fmu, long) as caller:
        instance = caller.instance
        if _refusal(lambda: instance.set(set), lambda: instance.step(_LONG, _STEP)) is None:
            return [f"{_text(set)} was taken"]
        calls = {"read outputs": caller.row, "step": lambda: instance.step(_STEP, _STEP)}
        complaints = [
            f"after a refusal it can still {what}"
            for what, call in calls.items()
            if _refusal(call) is None
        ]
        instance.reset()
        caller.steps.clear()
        (row,) = caller.play(long)
    differ = [name for name in row if row[name] != expected[name]]
    return complaints + [f"after reset {name} is not that of a fresh instance" for name in differ]


def _refusal(*calls: Callable[[], object]) -> str | None:
    try:
        for call in calls:
            call()
    except FmuError as error:
        return str(error)
    return None


def _text(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())
