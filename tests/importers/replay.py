"""Makes calls that were written down once more, to the FMU in another importer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from stickslip_fmu.spec import TABLE
from tests.importers.host_c import Host, line
from tests.importers.record import Call
from tests.importers.running import ask

_LINES = {
    "setup_experiment": "setup",
    "enter_initialization_mode": "enter",
    "exit_initialization_mode": "exit",
    "do_step": "step",
    "terminate": "terminate",
}


def bits(values: Sequence[Any]) -> list[str]:
    """Return numbers and truth values so that two are equal only if every bit is."""
    return [float(value).hex() for value in values]


def asked(calls: Sequence[Call]) -> list[list[str]]:
    """Return what calls that read something have returned, to the bit."""
    return [bits(call.answer) for call in calls if _reads(call)]


def by_fmpy(calls: Sequence[Call], fmu: Path, folder: Path) -> list[list[str]]:
    """Make the calls through FMPy; return what those that read something return."""
    order = [[call.instance, call.what, call.arguments] for call in calls]
    answers = ask("by_replay", "run", fmu, folder, argument=order).answer
    return [bits(answer) for call, answer in zip(calls, answers, strict=True) if _reads(call)]


def in_c(calls: Sequence[Call], host: Host) -> list[list[str]]:
    """Make the calls in the host written in C; return what those that read something return."""
    return [bits(answer) for answer in host.answers("".join(_script(calls)))]


def _reads(call: Call) -> bool:
    return call.what.startswith("get_") and bool(call.arguments[0])


def _script(calls: Sequence[Call]) -> Iterator[str]:
    used = None
    for call in calls:
        if call.instance != used:
            used = call.instance
            yield line("use", used)
        if call.what in _LINES:
            yield line(_LINES[call.what], *(each for each in call.arguments if each is not None))
        elif call.what.startswith(("get_", "set_")):
            references = call.arguments[0]
            columns = [[TABLE.rows[each].name for each in references], *call.arguments[1:]]
            words = [word for row in zip(*columns, strict=True) for word in row]
            if words:
                yield line(call.what[:3], *words)
        elif call.what != "make":
            raise AssertionError(f"a call that is not replayed: {call.what}")
