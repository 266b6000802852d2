"""Probes of refusals and warnings: values and steps out of range, and what follows."""

import re
from collections.abc import Callable, Mapping, Sequence

from stickslip_verification.drive.fmu.archive import FmuFile, available
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance
from stickslip_verification.drive.stepping import defaults, need, need_instances
from stickslip_verification.model.quantities import OUTPUT_NAMES

_STEP = 0.001
"""An ordinary communication step [s]."""

_LONG = 1.0
"""A step that holds several cycles of the default block, so that the meter has counted [s]."""


def refuses(
    fmu: FmuFile,
    set: Mapping[str, float],  # noqa: A002
    running: bool = False,
    step: float = _STEP,
) -> list[str]:
    """Complain if values are taken that must be refused, or a step [s]: before the start, or after.

    A refusal must name the variables.
    """
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
    need_instances(fmu)
    names = available(fmu, OUTPUT_NAMES)
    with fmu.instantiate() as fresh:
        expected = _long_step(fmu, fresh, names)()
    with fmu.instantiate() as instance:
        read = _long_step(fmu, instance, names)
        if _refusal(lambda: instance.set(set), lambda: instance.step(_LONG, _STEP)) is None:
            return [f"{_text(set)} was taken"]
        calls = {"read outputs": read, "step": lambda: instance.step(_STEP, _STEP)}
        complaints = [
            f"after a refusal it can still {what}"
            for what, call in calls.items()
            if _refusal(call) is None
        ]
        instance.reset()
        got = _long_step(fmu, instance, names)()
    differ = [name for name, a, b in zip(names, got, expected, strict=True) if a != b]
    return complaints + [f"after reset {name} is not that of a fresh instance" for name in differ]


def _long_step(
    fmu: FmuFile, instance: FmuInstance, names: Sequence[str]
) -> Callable[[], list[float]]:
    """Make a long step from the defaults; return what reads the outputs."""
    instance.start(defaults(fmu))
    instance.step(0.0, _LONG)
    return instance.reader(names)


def _refusal(*calls: Callable[[], object]) -> str | None:
    """Return the message of the first call that is refused; None if all are taken."""
    try:
        for call in calls:
            call()
    except FmuError as error:
        return str(error)
    return None


def _text(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())
