"""Random sequences: every change of inputs and parameters meets every phase, at every damping.

A sequence is a case without checks of its own. It is drawn along its motion: of the changes that
the next moments allow, the one that has happened least so far comes next. So a few hundred
sequences fill the whole table of `coverage`, whatever the seed.
"""

import itertools
import math
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random
from typing import NamedTuple

from .. import truth
from ..model.verdict import CommunicationStep, Table
from ..truth.parameters import CHANGEABLE, START_VALUES
from .cases import Case, follow
from .invariants import Manner

SEED = 1  # of the sequences that run by default
COUNT = 320  # sequences that run by default
PLAIN = "plain"  # the manner that every sequence is run in

STICK, FORWARD, BACKWARD = "stick", "forward slip", "backward slip"
REVERSED = "slip after a reversal"
PHASES = (STICK, FORWARD, BACKWARD, REVERSED)
_OF_MODE = {0: STICK, 1: FORWARD, -1: BACKWARD}

UNDAMPED, BELOW, CRITICAL, ABOVE = "c = 0", "below critical", "critical", "above critical"
DAMPINGS = (UNDAMPED, BELOW, CRITICAL, ABOVE)

CHANGES: Mapping[str, tuple[str, ...]] = {
    "v": ("v",),
    "v to 0": ("v",),
    "load": ("load",),
    "F_ext": ("F_ext",),
    "F_ext to 0": ("F_ext",),
    "load and F_ext that cancel": ("load", "F_ext"),
    "v, load and F_ext": ("v", "load", "F_ext"),
    "k": ("k",),
    "c": ("c",),
    "mu_s": ("mu_s",),
    "mu_k": ("mu_k",),
    "mu_s and mu_k": ("mu_s", "mu_k"),
    "k, c, mu_s, mu_k and v": ("k", "c", "mu_s", "mu_k", "v"),
    "the same values again": (),
}
"""Names of the changes, and what each of them sets."""

_BALANCED = "load and F_ext that cancel"  # the force beyond friction stays, in slip or break-away
_TO_ZERO = {"v to 0": "v", "F_ext to 0": "F_ext"}

LOADED = "load and F_ext from the start"
MOVING = "x_dot_start"
ABOVE_ONE = "any change, mu_s above 1"
UNPULLED = "any change, v = 0"
_AT_START = {LOADED: frozenset({"load", "F_ext"}), MOVING: frozenset({"x_dot_start"})}
ROWS = (*CHANGES, LOADED, MOVING, ABOVE_ONE, UNPULLED)
"""What `coverage` counts, apart from phase and damping."""
_SMALLEST_MARGIN = 1e-6  # `truth.Run.margin` below which a sequence is drawn anew
_NEAREST = 0.02  # of 1/w: no change comes nearer to an event
_HORIZON, _FARTHEST = 12.0, 60.0  # of 1/w: where the next change is; heavily damped, at most
_SLOWEST, _QUICKEST = 20.0, 150.0  # angular frequency [rad/s]; the default's is 32
_GRID = 16.0
"""Angular frequencies are multiples of 1/16 and masses of 1/64, so that k = m w^2 and the critical
c = 2 m w are doubles, and critical damping is met exactly."""


class Cell(NamedTuple):
    """A cell of the coverage: what happens, in which phase, and the damping from then on."""

    row: str
    phase: str
    damping: str


@dataclass(frozen=True)
class RandomSequence:
    """A random motion."""

    case: Case  # without checks
    cells: tuple[Cell, ...]  # what happens in it, once for each time


class _Span(NamedTuple):
    start: float  # [s]
    stop: float  # [s]
    phase: str


class Scope(NamedTuple):
    """The parameters and inputs that an FMU lets be set."""

    settable: frozenset[str]  # at the start
    changeable: frozenset[str]  # on the way

    def hindrance(self, cell: Cell) -> str | None:
        """Return why a cell cannot be reached, or None if it can."""
        needs = _AT_START.get(cell.row, frozenset()) - self.settable
        needs |= frozenset(CHANGES.get(cell.row, ())) - self.changeable
        if cell.damping != UNDAMPED:
            needs |= {"c"} - self.settable
        # Only a force turns a pulled mass round in every state.
        if cell.phase in (BACKWARD, REVERSED) or cell.row == UNPULLED:
            needs |= {"v", "F_ext"} - self.changeable
        return f"it cannot set {', '.join(sorted(needs))}" if needs else None


EVERYTHING = Scope(frozenset(START_VALUES), CHANGEABLE)
"""The scope of an FMU with the whole interface."""

CELLS = tuple(itertools.starmap(Cell, itertools.product(ROWS, PHASES, DAMPINGS)))


def draw_sequences(
    seed: int = SEED, count: int = COUNT, scope: Scope = EVERYTHING
) -> list[RandomSequence]:
    """Draw random sequences; the same seed gives the same.

    From `COUNT` on, more than `count` are drawn where cells of the coverage are still empty, up to
    half as many again.
    """
    counts: Counter[Cell] = Counter()
    drawn: list[RandomSequence] = []
    for number in range(count + count // 2 if count >= COUNT else count):
        if number >= count and not empty_cells(drawn, scope):
            break
        drawn.append(_draw(seed, number, counts, scope))
        counts.update(drawn[-1].cells)
    return drawn


def tried(cases: Sequence[Case], manners: Sequence[Manner]) -> list[tuple[Case, Manner]]:
    """Return which sequence is run in which manner: each plainly, and in one of the others."""
    plain = [(case, manner) for manner in manners if manner.manner == PLAIN for case in cases]
    others = itertools.cycle([manner for manner in manners if manner.manner != PLAIN])
    return [*plain, *zip(cases, others, strict=False)]


def coverage(sequences: Iterable[RandomSequence]) -> Counter[Cell]:
    """Count how often each cell occurs in sequences."""
    return Counter(cell for sequence in sequences for cell in sequence.cells)


def empty_cells(sequences: Iterable[RandomSequence], scope: Scope) -> list[Cell]:
    """Return the cells that sequences leave empty although an FMU of this scope reaches them."""
    counts = coverage(sequences)
    return [cell for cell in CELLS if not counts[cell] and scope.hindrance(cell) is None]


def coverage_table(sequences: Sequence[RandomSequence], seed: int, scope: Scope) -> Table:
    """Count how often what changed in which phase, at which damping."""
    counts = coverage(sequences)
    reasons = Counter(scope.hindrance(cell) for cell in CELLS if not counts[cell])
    return Table(
        title="Random sequences",
        about="How often what changed in which phase, at which damping from then on: "
        f"{len(sequences)} sequences of seed {seed}.",
        head=("what changes, and when", *DAMPINGS),
        rows=[
            [f"{row}, in {phase}", *(counts[Cell(row, phase, damping)] for damping in DAMPINGS)]
            for row, phase in itertools.product(ROWS, PHASES)
        ],
        note=" ".join(f"{n} cells cannot be filled: {why}." for why, n in reasons.items() if why),
    )


def _draw(seed: int, number: int, counts: Mapping[Cell, int], scope: Scope) -> RandomSequence:
    for attempt in itertools.count():
        draw = Random(f"sequence {number} of {seed}, attempt {attempt}")
        plan = _Plan(draw, counts, scope)
        for _ in range(draw.randint(4, 7)):
            plan.add_change()
        if well_decided(plan.finish()):
            break
    case = Case(
        id=f"sequence-{number:03d}",
        title=f"Random sequence {number} of seed {seed}",
        about="Inputs and parameters change at random moments of every phase.",
        parameters=plan.parameters,
        steps=tuple(plan.steps),
        checks=(),
        file=Path(__file__),
    )
    return RandomSequence(case, tuple(plan.cells))


class _Plan:
    def __init__(self, draw: Random, counts: Mapping[Cell, int], scope: Scope) -> None:
        self._draw = draw
        self._counts = Counter(counts)
        self._scope = scope
        drawn = self._start()
        self._values = {**START_VALUES, **{n: drawn[n] for n in drawn if n in scope.settable}}
        self._m = self._values["m"]
        self.parameters = dict(self._values)
        self.steps: list[CommunicationStep] = []
        self._pending: dict[str, float] = {}
        self._made: list[tuple[float, list[Cell]]] = []
        self._now = 0.0
        if draw.random() < 0.3:
            self._set_late()

    def add_change(self) -> None:
        """Add the change that has happened least, of those that the next moments allow."""
        cells = {
            Cell(kind, span.phase, damping): span
            for span in self._spans()
            for kind, names in CHANGES.items()
            if self._scope.changeable.issuperset(names)
            if kind not in _TO_ZERO or self._values[_TO_ZERO[kind]] != 0.0
            for damping in self._dampings(names)
        }
        if not cells:
            return
        cell = min(cells, key=lambda cell: (self._counts[cell], self._draw.random()))
        self._counts[cell] += 1
        kind, phase, damping = cell
        self._advance(cells[cell])
        self._pending = self._changed(kind, phase, damping)
        self._values |= self._pending
        extra = {ABOVE_ONE: self._values["mu_s"] > 1.0, UNPULLED: self._values["v"] == 0.0}
        rows = [kind, *(row for row, applies in extra.items() if applies)]
        damping = _damping(self._values)
        self._made.append((self._now, [Cell(row, phase, damping) for row in rows]))

    def finish(self) -> truth.Run:
        spans = self._spans()
        if spans:
            self._advance(self._draw.choice(spans))
        else:
            self._made = self._made[:-1]
        course = follow(self.parameters, self.steps, in_doubles=True)
        first = self._made[0][0] if self._made else self._now
        start = {**self.parameters, **self.steps[0].changes}
        self.cells = [
            Cell(row, span.phase, _damping(start))
            for row, names in _AT_START.items()
            if all(start[name] != 0.0 for name in names)
            for span in _spans(course)
            if span.start < first
        ]
        self.cells += [cell for _, cells in self._made for cell in cells]
        return course

    def _start(self) -> dict[str, float]:
        draw = self._draw
        m = draw.randint(8, 640) / 64.0
        w = _on_grid(draw.uniform(_SLOWEST, _QUICKEST))
        g = draw.choice((9.81, _on_grid(draw.uniform(1.0, 20.0)), draw.uniform(1.0, 20.0)))
        mu_s = _log_uniform(draw, *((1.05, 2.0) if draw.random() < 0.3 else (0.1, 1.0)))
        mu_k = mu_s * (1.0 - _log_uniform(draw, 0.05, 1.0))
        if draw.random() < 0.5:
            mu_s = _on_grid(mu_s, 64.0)
            mu_k = min(_on_grid(mu_k, 64.0), mu_s - 1.0 / 64.0)
        values = {"m": m, "k": m * w * w, "g": g, "mu_s": mu_s, "mu_k": mu_k}
        values["c"] = self._damper(m, w, draw.choice(DAMPINGS))
        weight = m * g
        if draw.random() < 0.6:
            values["load"] = _on_grid(weight * draw.uniform(-0.5, 1.0), 1024.0)
            values["F_ext"] = _on_grid(mu_s * weight * draw.uniform(-0.6, 0.6), 1024.0)
        N = weight + values.get("load", 0.0)
        self._speed = (mu_s - mu_k) * N / (m * w * _log_uniform(draw, 0.1, 5.0))
        values["v"] = self._speed * draw.choice((1.0, 1.0, -1.0))
        force = mu_s * N * draw.choice((draw.uniform(-1.2, 1.2), draw.uniform(0.6, 0.99)))
        values["z_start"] = (force - values.get("F_ext", 0.0)) / values["k"]
        values["x_start"] = draw.choice(
            (0.0, draw.uniform(-1.0, 1.0) * mu_s * weight / values["k"])
        )
        if draw.random() < 0.35:
            values["x_dot_start"] = draw.choice((1.0, -1.0)) * self._speed * draw.uniform(0.3, 4.0)
        return values

    def _set_late(self) -> None:
        """Start with other values, set the drawn ones after initialization."""
        weight = self._m * self._values["g"]
        late = {
            "v": -2.0 * self._values["v"],
            "load": self._values["load"] + weight * self._draw.uniform(-0.3, 1.0),
            "F_ext": self._values["mu_s"] * weight * self._draw.uniform(-2.0, 2.0),
            "c": self._values["c"] + self._m,
        }
        for name, value in late.items():
            if name in self._scope.settable & self._scope.changeable:
                self._pending[name] = self._values[name]
                self.parameters[name] = value

    def _advance(self, span: _Span) -> None:
        """Go on to a moment within a span, in one step or in a few, under the pending changes."""
        draw = self._draw
        edge = _NEAREST / self._w
        moment = draw.uniform(max(span.start, self._now) + edge, span.stop - edge)
        cuts = sorted(draw.uniform(self._now, moment) for _ in range(draw.choice((0, 0, 1, 3))))
        for end in (*cuts, moment):
            if (h := end - self._now) > 0.0:
                self.steps.append(CommunicationStep(h, self._pending))
                self._pending = {}
                self._now += h

    def _spans(self) -> list[_Span]:
        """Return the phases of the next moments that are long enough for a change."""
        # A heavily damped slip is slow: c/k is its time.
        slow = self._values["c"] * self._w / self._values["k"]
        ahead = min(_HORIZON * max(1.0, slow), _FARTHEST) / self._w
        steps = [*self.steps, CommunicationStep(ahead, self._pending)]
        course = follow(self.parameters, steps, in_doubles=True)
        shortest = 3.0 * _NEAREST / self._w
        spans = (span._replace(start=max(span.start, self._now)) for span in _spans(course))
        return [span for span in spans if span.stop - span.start > shortest]

    @property
    def _w(self) -> float:
        return math.sqrt(self._values["k"] / self._m)

    def _dampings(self, names: Collection[str]) -> Iterable[str]:
        if "c" in names:
            return DAMPINGS
        if names == ("k",) and self._values["c"] > 0.0:
            return [damping for damping in DAMPINGS[1:] if self._frequencies(damping)]
        return (_damping(self._values),)

    def _changed(self, kind: str, phase: str, damping: str) -> dict[str, float]:
        draw, values, names = self._draw, self._values, CHANGES[kind]
        if not names:
            return {name: values[name] for name in sorted(CHANGEABLE & self._scope.changeable)}
        weight = self._m * values["g"]
        new: dict[str, float] = {}
        if "v" in names:
            size = draw.choice((1.0, 1.0, -1.0)) * draw.uniform(0.3, 4.0)
            new["v"] = self._about("v", self._speed * size, self._speed)
        if "load" in names:
            new["load"] = self._about("load", weight * draw.uniform(-0.7, 1.5), weight)
        if "F_ext" in names:
            force = values["mu_s"] * (weight + new.get("load", values["load"]))
            new["F_ext"] = self._about("F_ext", force * draw.uniform(-2.5, 2.5), force)
        if "k" in names:
            bounds = self._frequencies(UNDAMPED if "c" in names else damping)
            assert bounds is not None
            w = _on_grid(draw.uniform(*bounds))
            new["k"] = self._m * w * w
        if "c" in names:
            w = math.sqrt(new.get("k", values["k"]) / self._m)
            new["c"] = self._damper(self._m, w, damping)
        if kind == _BALANCED:
            # Exact in doubles where all values are on a grid, as now and then they are.
            coefficient = values["mu_s" if phase == STICK else "mu_k"]
            more = _on_grid(weight * draw.uniform(0.1, 1.0))
            along = -more if phase == BACKWARD else more
            new = {"load": values["load"] + more, "F_ext": values["F_ext"] + coefficient * along}
        if kind in _TO_ZERO:
            new[_TO_ZERO[kind]] = 0.0
        gap = _log_uniform(draw, 0.05, 0.8)
        if "mu_s" in names:
            above = min(values["mu_k"] / (1.0 - gap), 2.5)
            new["mu_s"] = max(above, 1.02 * values["mu_k"], 0.05)
        if "mu_k" in names:
            new["mu_k"] = new.get("mu_s", values["mu_s"]) * (1.0 - gap)
        return new

    def _about(self, name: str, drawn: float, scale: float) -> float:
        """Return a drawn value, now and then one next to the present one, its opposite, or 0."""
        draw, present = self._draw, self._values[name]
        way = draw.random()
        if way < 0.2:
            return present + draw.choice((-1.0, 1.0)) * scale * _log_uniform(draw, 1e-6, 1e-2)
        if way < 0.35:
            return -present if name != "load" else abs(present)
        return 0.0 if way < 0.45 and name != "v" else drawn

    def _damper(self, m: float, w: float, damping: str) -> float:
        ratio = {
            UNDAMPED: 0.0,
            BELOW: _log_uniform(self._draw, 3e-4, 0.9),
            CRITICAL: 1.0,
            ABOVE: _log_uniform(self._draw, 1.1, 60.0),
        }[damping]
        if damping in (BELOW, ABOVE) and self._draw.random() < 0.2:
            off = _log_uniform(self._draw, 1e-6, 1e-2)
            return 2.0 * m * w * (1.0 + off if damping == ABOVE else 1.0 - off)
        return 2.0 * m * _on_grid(ratio * w)

    def _frequencies(self, damping: str) -> tuple[float, float] | None:
        """Return the bounds of the angular frequency [rad/s] at which c gives a damping, if any."""
        critical = self._values["c"] / (2.0 * self._m)
        lowest, highest = {
            UNDAMPED: (_SLOWEST, _QUICKEST),
            BELOW: (1.05 * critical, 10.0 * critical),
            CRITICAL: (critical, critical),
            ABOVE: (0.4 * critical, 0.95 * critical),
        }[damping]
        lowest, highest = max(lowest, _SLOWEST), min(highest, _QUICKEST)
        return (lowest, highest) if lowest <= highest else None


def _spans(course: truth.Run) -> Iterator[_Span]:
    events = course.events
    mode = (course.initial if events else course.samples[0])["mode"]
    phase = STICK if events and events[0].kind == "break-away" else _OF_MODE[mode]
    start = 0.0
    for event in events:
        if event.time > start:
            yield _Span(start, float(event.time), phase)
        start = float(event.time)
        phase = REVERSED if event.kind == "reversal" else _OF_MODE[event.mode]
    yield _Span(start, float(course.times[-1]), phase)


def well_decided(course: truth.Run) -> bool:
    """Tell whether a numerical solution decides each event of a course as the exact motion does.

    Not where a slip becomes so slow that only rounding decides when it ends.
    """
    fastest = max(abs(sample["x_dot"]) for sample in course.samples)
    slips = (abs(sample["x_dot"]) for sample in course.samples if sample["mode"])
    slowest = min(slips, default=math.inf)
    return bool(min(course.margin, slowest / fastest if fastest else 1.0) >= _SMALLEST_MARGIN)


def _damping(values: Mapping[str, float]) -> str:
    if values["c"] == 0.0:
        return UNDAMPED
    excess = values["c"] * values["c"] - 4.0 * values["k"] * values["m"]
    return CRITICAL if excess == 0.0 else ABOVE if excess > 0.0 else BELOW


def _on_grid(value: float, grid: float = _GRID) -> float:
    return math.ceil(value * grid) / grid


def _log_uniform(draw: Random, lowest: float, highest: float) -> float:
    return math.exp(draw.uniform(math.log(lowest), math.log(highest)))


SHARE = 8
"""Of the sequences of Coulomb's law every eighth is tried under another one, whose exact motion is
marched and not in closed form."""
_MOST_POINTS = 5  # of a drawn friction curve
_ATTEMPTS = 10  # draws of growing friction for one sequence, until rounding decides no event


def under_law(cases: Sequence[Case], law: str, seed: int) -> list[Case]:
    """Return every `SHARE`th of these cases under the friction law of this name."""
    own = tuple(truth.friction_law(law).parameters)
    drawn = []
    for case in cases[::SHARE]:
        new = _DRAWS[law](Random(f"{law} {seed} {case.id}"), case)
        drawn.append(replace(case, parameters={**case.parameters, **new}, law=law, own=own))
    return drawn


def with_dwell(cases: Sequence[Case], seed: int) -> list[Case]:
    """Return every `SHARE`th of these cases of Coulomb's law with a friction that grows at rest."""
    found = []
    for case in cases[::SHARE]:
        for attempt in range(_ATTEMPTS):
            drawn = _growing(Random(f"dwell {seed} {case.id} {attempt}"), case)
            if well_decided(follow(drawn.parameters, drawn.steps, in_doubles=True)):
                found.append(drawn)
                break
    return found


def _growing(draw: Random, case: Case) -> Case:
    """Draw a growth as quick as the swing, within two decades; it changes at one of the steps."""
    start = case.start
    w, gap = math.sqrt(start["k"] / start["m"]), start["mu_s"] - start["mu_k"]

    def growth() -> dict[str, float]:
        return {
            "tau_s": draw.choice((0.0, 1.0, 1.0)) * 10.0 ** draw.uniform(-2.0, 2.0) / w,
            "B": draw.choice((0.0, 1.0, 1.0)) * gap * 10.0 ** draw.uniform(-2.0, 0.0),
            "t_0": 10.0 ** draw.uniform(-2.0, 1.0) / w,
        }

    old = {"age_start": draw.choice((0.0, 10.0 ** draw.uniform(-1.0, 3.0) / w))}
    changed = draw.choice([n for n, step in enumerate(case.steps) if n == 0 or step.changes])
    steps = [
        replace(step, changes={**step.changes, **growth()}) if n == changed and n else step
        for n, step in enumerate(case.steps)
    ]
    return replace(
        case,
        id=f"{case.id}-dwell",
        title=f"{case.title}, static friction grows at rest",
        parameters={**case.parameters, **growth(), **old},
        steps=tuple(steps),
        own=tuple(truth.COULOMB.parameters),
    )


def _stribeck(draw: Random, case: Case) -> Mapping[str, float]:
    """Draw a shape, its speeds about those of the pull, and a curve below every mu_s to come."""
    settings = [case.start, *(step.changes for step in case.steps)]
    pull = max(abs(values["v"]) for values in settings if "v" in values)
    rest = min(values["mu_s"] for values in settings if "mu_s" in values)
    count = draw.randint(2, _MOST_POINTS)
    drawn = {
        "shape": float(draw.randint(1, 3)),
        "v_s": pull * 10.0 ** draw.uniform(-1.5, 1.0),
        "delta": draw.choice((1.0, 2.0, 3.0, draw.uniform(1.0, 3.0))),
        "n_points": float(count),
        "mu_1": rest * draw.choice((1.0, draw.uniform(0.6, 1.0))),
    }
    speed = 0.0
    for number in range(2, count + 1):
        speed += pull * 10.0 ** draw.uniform(-1.5, 0.5)
        drawn |= {f"u_{number}": speed, f"mu_{number}": rest * draw.uniform(0.3, 1.0)}
    return drawn


_DRAWS: Mapping[str, Callable[[Random, Case], Mapping[str, float]]] = {"stribeck": _stribeck}
