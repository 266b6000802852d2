"""Motions on one FMU instance that is used again and again, for the random tests."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.fmu.errors import FmuError
from stickslip_verification.drive.fmu.instance import FmuInstance

State = dict[str, float]


class Mover:
    """Runs motions on an FMU, resetting one instance between them.

    After an `FmuError` the instance is replaced, so that one refusal does not spoil what follows.
    """

    def __init__(self, path: Path, names: Sequence[str]) -> None:
        self._file = FmuFile(path)
        self._names = tuple(names)
        self._instance: FmuInstance | None = None
        self._read: Callable[[], list[float]] = list

    def begin(self, parameters: Mapping[str, float]) -> Motion:
        """Start a motion from these values (SI); a motion under way ends."""
        try:
            if self._instance is None:
                self._instance = self._file.instantiate()
                self._read = self._instance.reader(self._names)
            else:
                self._instance.reset()
            self._instance.start(parameters)
        except FmuError:
            self.drop()
            raise
        return Motion(self, self._instance)

    def state(self) -> State:
        """Read the outputs."""
        return dict(zip(self._names, self._read(), strict=True))

    def drop(self) -> None:
        """Free the instance; the next motion gets a new one."""
        if self._instance is not None:
            self._instance.free()
            self._instance = None

    def __enter__(self) -> Mover:
        return self

    def __exit__(self, *_: object) -> None:
        self.drop()
        self._file.close()


class Motion:
    """One run in progress; `time` [s] is what the importer believes, a plain running sum."""

    def __init__(self, mover: Mover, instance: FmuInstance) -> None:
        self._mover = mover
        self._instance = instance
        self.time = 0.0

    def advance(self, steps: Iterable[float], changes: Mapping[str, float] | None = None) -> None:
        """Set the changes, then take the steps [s]."""
        try:
            if changes:
                self._instance.set(changes)
            for h in steps:
                self._instance.step(self.time, h)
                self.time += h
        except FmuError:
            self._mover.drop()
            raise

    def state(self) -> State:
        """Read the outputs by name, at the end of the last step."""
        return self._mover.state()
