"""The one kind of error that an axis file raises."""

from __future__ import annotations


class AxisError(ValueError):
    """An axis file cannot be used.

    The message is one line: file, line, key, value and reason, range, remedy.

    Attributes
    ----------
    reason
        What is wrong.
    key
        Name in the file, such as ``axis.mass``; empty where no key is meant.
    value
        What stands there, as it is written; empty where nothing does.
    within
        What is allowed there, in words.
    remedy
        What to do.
    name
        The file.
    line
        Number of the line, from 1; 0 where the file cannot be read at all.
    """

    def __init__(
        self, reason: str, *, key: str = "", value: str = "", within: str = "", remedy: str = "",
        name: str = "", line: int = 0,
    ) -> None:  # fmt: skip
        super().__init__(reason)
        self.reason, self.key, self.value, self.within = reason, key, value, within
        self.remedy, self.name, self.line = remedy, name, line

    def __str__(self) -> str:
        place = f"line {self.line}" if self.line else ""
        what = " ".join(
            filter(None, (" = ".join(filter(None, (self.key, self.value))), self.reason))
        )
        expected = f"expected {self.within}" if self.within else ""
        first = ": ".join(filter(None, (self.name, place, what)))
        return "; ".join(filter(None, (first, expected, self.remedy)))
