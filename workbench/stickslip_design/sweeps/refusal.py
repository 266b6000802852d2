"""The one kind of error that a sweep raises."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

from ..chunks import StudyError

MOST_SHOWN = 5
"""Nearest names that a refusal lists."""


class SweepError(StudyError):
    """A model, a plan or a table of it cannot be used; one line with file, line, name, reason."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the names most like one that is not known, as the end of a refusal."""
    names = list(known)
    folded = {each.lower(): each for each in names}
    near = get_close_matches(name.lower(), folded, MOST_SHOWN, 0.5)
    shown = [folded[each] for each in near]
    # The last part of a structured name may be all that a person remembers.
    last = name.rpartition(".")[2].lower()
    shown += [each for each in names if each.rpartition(".")[2].lower() == last]
    shown = list(dict.fromkeys(shown))[:MOST_SHOWN]
    if shown:
        return f"nearest: {', '.join(shown)}"
    listed = ", ".join(names[:MOST_SHOWN])
    more = len(names) - MOST_SHOWN
    return f"there is {listed or 'none'}{f' and {more} more' if more > 0 else ''}"
