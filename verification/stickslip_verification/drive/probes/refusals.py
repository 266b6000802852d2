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
"""A step that holds several cycles of the default block [s]."""


def refuses(fmu: FmuFile, set: Mapping[str, float], running: bool = False) -> list[str]:  # noqa: A002
    """Complain if values are taken that must be refused, before the start or while it runs."""
    need(fmu, set)
    with fmu.instantiate() as instance:
        if running:
            instance.start(defaults(fmu))
            instance.step(0.0, _STEP)
        refused = _refusal(instance, set, running)
    if refused is None:
        return [f"{_text(set)} was taken"]
    return [] if _names(refused, set) else [f"{_text(set)} was refused without its name: {refused}"]


def refuses_step(fmu: FmuFile, h: float) -> list[str]:
    """Complain if a step of this length [s] is taken."""
    with fmu.instantiate() as instance:
        instance.start(defaults(fmu))
        instance.step(0.0, _STEP)
        try:
            instance.step(_STEP, h)
        except FmuError:
            return []
    return [f"a step of {h!r} s was taken"]


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
        fresh.start(defaults(fmu))
        fresh.step(0.0, _LONG)
        expected = fresh.reader(names)()
    with fmu.instantiate() as instance:
        instance.start(defaults(fmu))
        # Long enough that the meter has counted.
        instance.step(0.0, _LONG)
        read = instance.reader(names)
        try:
            instance.set(set)
            instance.step(_LONG, _STEP)
        except FmuError:
            complaints = _goes_on(instance, read)
        else:
            return [f"{_text(set)} was taken"]
        instance.reset()
        instance.start(defaults(fmu))
        instance.step(0.0, _LONG)
        got = instance.reader(names)()
    differ = [name for name, a, b in zip(names, got, expected, strict=True) if a != b]
    return complaints + [f"after reset {name} is not that of a fresh instance" for name in differ]


def _goes_on(instance: FmuInstance, read: Callable[[], list[float]]) -> list[str]:
    complaints = []
    calls: tuple[tuple[str, Callable[[], object]], ...] = (
        ("read outputs", read),
        ("step", lambda: instance.step(_STEP, _STEP)),
    )
    for what, call in calls:
        try:
            call()
        except FmuError:
            continue
        complaints.append(f"after a refusal it can still {what}")
    return complaints


def _refusal(instance: FmuInstance, values: Mapping[str, float], running: bool) -> str | None:
    """Return what is said to the values, when they are set or when they act; None if nothing."""
    try:
        instance.set(values)
        if running:
            instance.step(_STEP, _STEP)
        else:
            instance.start({})
    except FmuError as error:
        return str(error)
    return None


def _names(refusal: str, values: Mapping[str, float]) -> bool:
    """Whether what the FMU itself said names every variable."""
    said = refusal.partition("failed:")[2] or refusal
    return all(re.search(rf"\b{name}\b", said) for name in values)


def _text(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value!r}" for name, value in values.items())
