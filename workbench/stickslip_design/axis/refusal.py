"""The one kind of error that an axis file raises."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(eq=False, repr=False)
class AxisError(ValueError):
    """An axis file cannot be used.

    The message is one line: file, line, key, value and reason, range, remedy.
    """

    reason: str
    """What is wrong."""
    key: str = ""
    """Name in the file, such as ``axis.mass``; empty where no key is meant."""
    value: str = ""
    """What stands there, as it is written; empty where nothing does."""
    within: str = ""
    """What is allowed there, in words."""
    remedy: str = ""
    """What to do."""
    name: str = ""
    """The file."""
    line: int = 0
    """Number of the line, from 1; 0 where the file cannot be read at all."""

    def __str__(self) -> str:
        line = f"line {self.line}" if self.line else ""
        subject = " = ".join(filter(None, (self.key, self.value)))
        what = f"{subject} {self.reason}".lstrip()
        first = ": ".join(filter(None, (self.name, line, what)))
        expected = f"expected {self.within}" if self.within else ""
        return "; ".join(filter(None, (first, expected, self.remedy)))
