"""The calls that an importer makes to the FMU, written down by the FMU itself."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_WATCHER = Path(__file__).with_name("record_calls.py")
_WATCH = "\nfrom record_calls import watch\n\nwatch(Packed)\n"


@dataclass(frozen=True)
class Call:
    """One call to one instance.

    Attributes
    ----------
    instance
        Which instance, by a name of its own.
    what
        The slave's method that the FMU's binary called, such as do_step; `make` for a new one.
    arguments
        As they came in: numbers, or lists of value references and of numbers.
    answer
        What the method returned.
    """

    instance: str
    what: str
    arguments: tuple[Any, ...]
    answer: Any = None


def recording_fmu(fmu: Path, target: Path) -> Path:
    """Write an FMU that does what `fmu` does and writes down every call."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as copy:
        slave = source.read("resources/slavemodule.txt").decode().strip()
        for name in source.namelist():
            content = source.read(name)
            if name == f"resources/{slave}.py":
                content += _WATCH.encode()
            elif name == "modelDescription.xml":
                # Importers may keep what they unpacked under its GUID, and this is another FMU.
                content = content.replace(b'guid="', b'guid="recording-', 1)
            copy.writestr(name, content)
        copy.write(_WATCHER, "resources/record_calls.py")
    return target


def environment(record: Path) -> dict[str, str]:
    """Return the environment variables with which a recording FMU writes to `record`."""
    return {"STICKSLIP_CALLS": str(record)}


def read(record: Path) -> list[Call]:
    """Return the calls in the order in which they were made."""
    calls = []
    for line in record.read_text(encoding="utf-8").splitlines():
        instance, what, arguments, answer = json.loads(line)
        calls.append(Call(instance, what, tuple(arguments), answer))
    return calls


def instances(calls: Sequence[Call]) -> list[str]:
    """Return the instances in the order in which they were made."""
    return list(dict.fromkeys(call.instance for call in calls))


def steps(calls: Sequence[Call], instance: str) -> list[tuple[float, float]]:
    """Return communication point [s] and length [s] of every step of an instance."""
    return [
        (call.arguments[0], call.arguments[1])
        for call in calls
        if call.instance == instance and call.what == "do_step"
    ]


def points(calls: Sequence[Call], instance: str) -> list[dict[int, Any]]:
    """Return what an instance has shown by the start and by the end of each step.

    Values by value reference, each as it was read last.
    """
    shown: dict[int, Any] = {}
    found: list[dict[int, Any]] = []
    for call in calls:
        if call.instance != instance:
            continue
        if call.what == "do_step":
            found.append(dict(shown))
        elif call.what.startswith("get_"):
            shown.update(zip(call.arguments[0], call.answer, strict=True))
    return [*found, shown]
