"""Where the keys of an axis file stand."""

from __future__ import annotations

import re
from collections import Counter
from typing import Final

_NAME: Final = r"""(?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')"""
_NAMES: Final = rf"({_NAME}(?:\s*\.\s*{_NAME})*)"
_ARRAY: Final = re.compile(rf"\s*\[\[\s*{_NAMES}\s*\]\]")
_TABLE: Final = re.compile(rf"\s*\[\s*{_NAMES}\s*\]")
_KEY: Final = re.compile(rf"\s*{_NAMES}\s*=")


class Lines:
    """The lines of a TOML text by the names in it: ``axis.mass``, ``drive.filter[2].kind``."""

    def __init__(self, text: str) -> None:
        self._found: dict[str, int] = {}
        arrays: Counter[str] = Counter()
        table = ""
        lines = text.splitlines()
        self._last = max(1, len(lines))
        for number, line in enumerate(lines, 1):
            if header := _ARRAY.match(line):
                name = _plain(header[1])
                arrays[name] += 1
                table = f"{name}[{arrays[name]}]"
                self._found.setdefault(name, number)
                self._found.setdefault(table, number)
            elif header := _TABLE.match(line):
                table = _plain(header[1])
                self._found.setdefault(table, number)
            elif key := _KEY.match(line):
                path = _plain(key[1])
                self._found.setdefault(f"{table}.{path}" if table else path, number)

    def of(self, path: str) -> int:
        """Return the line of a name, else that of what it stands in, else the last one."""
        while path and path not in self._found:
            path = re.sub(r"(\[|^|\.)[^.\[]*\Z", "", path)
        return self._found.get(path, self._last)


def _plain(names: str) -> str:
    return ".".join(part.strip("\"'") for part in re.split(r"\s*\.\s*", names))
