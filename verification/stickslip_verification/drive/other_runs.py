"""Other runs of the same FMU that must give the same motion: docs/theory.md (18), and FMI's own.

Each gives a record that is to equal the plain one: outputs of a scaled run are scaled back.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.stepping import (
    Driver,
    NotApplicableError,
    Setting,
    lacking,
    may_change,
    run,
    setting_of,
)
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.model.symmetries import HEAVIER, MIRROR, QUICKER, Symmetry
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.experiment import CommunicationStep

OtherRun = Callable[[FmuFile, Case], Run]
"""Runs a case in another way. Raises `FmuError`, or `NotApplicableError` with what is lacking."""

_PIECES = (0.3, 0.45)
"""Parts of a step that it is cut into, the rest being the last."""

_ROLLBACKS = 5
_REPEATED = 20
"""How often a run is set back, and over how many steps each time."""


def _symmetric(symmetry: Symmetry) -> OtherRun:
    def symmetric(fmu: FmuFile, case: Case) -> Run:
        plain = setting_of(fmu, case)
        values = symmetry.scaled(case.start, case.own)
        # What the plain run does without, of a friction law's parameters, has no effect.
        own = {each.name for each in case.own}
        absent = lacking(fmu, {n: value for n, value in values.items() if n not in own})
        if absent:
            raise NotApplicableError(f"it has no variable {', '.join(absent)}")
        scaled = Setting(
            {name: value for name, value in values.items() if fmu.has(name)},
            [
                CommunicationStep(step.h * symmetry.pace, symmetry.scaled(step.changes, case.own))
                for step in plain.steps
            ],
        )
        record = run(fmu, scaled)
        back = symmetry.outputs
        return replace(
            record,
            times=np.array(case.times),
            outputs={n: s / back.get(n, 1.0) for n, s in record.outputs.items()},
            initial={n: value / back.get(n, 1.0) for n, value in record.initial.items()},
        )

    symmetric.__doc__ = f"Run the case under a symmetry: {symmetry.name}."
    return symmetric


def splitting(fmu: FmuFile, case: Case) -> Run:
    """Run the case with every step cut in three uneven pieces, read where the whole ones end."""
    whole = setting_of(fmu, case)
    pieces = []
    for step in whole.steps:
        first, second = (step.h * part for part in _PIECES)
        last = step.h - first - second
        pieces += [
            CommunicationStep(first, step.changes),
            CommunicationStep(second, {}),
            CommunicationStep(last, {}),
        ]
    cut = run(fmu, Setting(whole.parameters, pieces))
    outputs = {
        name: samples[len(_PIECES) :: len(_PIECES) + 1] for name, samples in cut.outputs.items()
    }
    return replace(cut, times=np.array(case.times), outputs=outputs)


def rollback(fmu: FmuFile, case: Case) -> Run:
    """Run the case; now and then go on, set the state back, and repeat the same steps."""
    _need(fmu.can_get_and_set_state, "get and set its state")
    with fmu.instantiate() as instance:
        drive = _drive(fmu, case, instance)
        drive.begin()
        done = 0
        for mark in _marks(len(case.steps)):
            drive.go(done, mark)
            state = instance.get_state()
            ahead = min(mark + _REPEATED, len(case.steps))
            drive.go(mark, ahead)
            del drive.rows[mark:]
            instance.set_state(state)
            instance.free_state(state)
            drive.read_again(mark)
            done = mark
        drive.go(done, len(case.steps))
        return drive.run()


def serialized(fmu: FmuFile, case: Case) -> Run:
    """Run the case; now and then go on in another instance, from the state as bytes."""
    _need(fmu.can_get_and_set_state and fmu.can_serialize_state, "serialize its state")
    _need(not fmu.once_per_process, "be instantiated twice in a process")
    with fmu.instantiate() as first, fmu.instantiate() as second:
        here, there = _drive(fmu, case, first), _drive(fmu, case, second)
        here.begin()
        there.begin()
        done = 0
        for mark in _marks(len(case.steps)):
            here.go(done, mark)
            state = here.instance.get_state()
            written = here.instance.serialize(state)
            here.instance.free_state(state)
            restored = there.instance.deserialize(written)
            there.instance.set_state(restored)
            there.instance.free_state(restored)
            there.rows, there.initial = here.rows, here.initial
            there.read_again(mark)
            here, there = there, here
            done = mark
        here.go(done, len(case.steps))
        return here.run()


def reset(fmu: FmuFile, case: Case) -> Run:
    """Run the case, reset the instance, and run it again.

    Before the reset whatever may be set was set, so that what is kept shows.
    """
    with fmu.instantiate() as instance:
        drive = _drive(fmu, case, instance)
        drive.begin()
        drive.go(0, max(len(case.steps) * 2 // 3, 1))
        changes = {"v": 0.05, "load": 1.0}
        instance.set({n: v for n, v in changes.items() if fmu.has(n) and may_change(fmu, n)})
        instance.reset()
        again = _drive(fmu, case, instance)
        again.whole()
        return again.run()


def two_instances(fmu: FmuFile, case: Case) -> Run:
    """Run the case while another instance, pulled at another speed, is stepped in between."""
    _need(not fmu.once_per_process, "be instantiated twice in a process")
    with fmu.instantiate() as instance, fmu.instantiate() as other:
        drive = _drive(fmu, case, instance)
        beside = _drive(fmu, case, other)
        values = {**beside.setting.parameters, "v": 0.037}
        beside.setting = Setting(values, beside.setting.steps)
        drive.begin()
        beside.begin()
        for number in range(len(case.steps)):
            drive.go(number, number + 1)
            beside.go(number, number + 1)
        return drive.run()


RUNS: dict[str, OtherRun] = {
    "mirror": _symmetric(MIRROR),
    "forces": _symmetric(HEAVIER),
    "time": _symmetric(QUICKER),
    "splitting": splitting,
    "rollback": rollback,
    "serialized": serialized,
    "reset": reset,
    "two_instances": two_instances,
}
"""What an invariant can name as ``run``."""


def _drive(fmu: FmuFile, case: Case, instance: FmuInstance) -> Driver:
    return Driver(instance, setting_of(fmu, case), available(fmu, OUTPUT_NAMES))


def _need(able: bool, what: str) -> None:
    if not able:
        raise NotApplicableError(f"it cannot {what}, by its description")


def _marks(steps: int) -> list[int]:
    """Return the numbers of the steps before which a run is set back, in order, none twice."""
    return sorted({steps * n // (_ROLLBACKS + 1) for n in range(1, _ROLLBACKS + 1)})
