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
    line
        Number of the line, from 1; 0 where the file cannot be read at all.
    """

    def __init__(
        self,
        reason: str,
        *,
        key: str = "",
        value: str = "",
        within: str = "",
        remedy: str = "",
        name: str = "",
        line: int = 0,
    ) -> None:
        self.reason, self.key, self.value = reason, key, value
        self.within, self.remedy, self.line = within, remedy, line
        place = f"{name}: line {line}: " if line else f"{name}: " if name else ""
        subject = " = ".join(part for part in (key, value) if part)
        first = f"{place}{subject} {reason}" if subject else f"{place}{reason}"
        expected = f"expected {within}" if within else ""
        super().__init__("; ".join(part for part in (first, expected, remedy) if part))

    def at(self, name: str, line: int, value: str = "") -> AxisError:
        """Return the error with the name of its file, its line and what is written there."""
        return AxisError(
            self.reason, key=self.key, value=self.value or value, within=self.within,
            remedy=self.remedy, name=name, line=line,
        )  # fmt: skip
