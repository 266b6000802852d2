"""Data files that people write: TOML, under a JSON schema, refused with file, place and reason."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jsonschema


class DataError(ValueError):
    """A data file cannot be used; one line with the file, the line or field, and the reason."""

    def __init__(self, file: Path, where: str, reason: str) -> None:
        self.file = file
        self.where = where
        self.reason = reason
        super().__init__(": ".join(part for part in (str(file), where, reason) if part))


def read_text(file: Path, error: type[DataError]) -> str:
    """Read a text; raises `error` where it cannot be read or is no UTF-8."""
    try:
        return file.read_text(encoding="utf-8")
    except OSError as fault:
        raise error(file, "", (fault.strerror or str(fault)).lower()) from None
    except UnicodeDecodeError as fault:
        raise error(file, "", f"is not UTF-8: {fault.reason}") from None


def read_toml(file: Path, error: type[DataError]) -> dict[str, Any]:
    """Read a TOML file; raises `error` with the line where it is none."""
    try:
        return tomllib.loads(read_text(file, error))
    except tomllib.TOMLDecodeError as fault:
        message = str(fault)
        place = re.search(r" \(at (line \d+)[^)]*\)$", message)
        where, reason = (place[1], message[: place.start()]) if place else ("", message)
        raise error(file, where, reason) from None


def objection(data: Any, schema: Mapping[str, Any]) -> tuple[Sequence[str | int], str] | None:
    """Return the path and the reason of what in `data` offends a schema most, or None."""
    fault = jsonschema.exceptions.best_match(
        jsonschema.Draft202012Validator(schema).iter_errors(data)
    )
    return None if fault is None else (list(fault.absolute_path), fault.message)


def where_is(file: Path, path: Sequence[str | int]) -> str:
    """Say where a field of a TOML file is: its line, as far as it is written out, and its name."""
    line = _line(file.read_text(encoding="utf-8").splitlines(), path)
    return ", ".join(filter(None, (f"line {line}" if line else "", field(path))))


def _line(lines: Sequence[str], path: Sequence[str | int]) -> int:
    """Find the line of a field from the outside in; 0 where nothing of it stands in the file."""
    found, begin, table = 0, 0, ""
    for part in path:
        if isinstance(part, int):
            header = re.compile(rf"\s*\[\[{re.escape(table)}\]\]")
            heads = [n for n, line in enumerate(lines) if header.match(line)]
            if part < len(heads):
                begin = found = heads[part] + 1
            continue
        table = f"{table}.{part}" if table else part
        names = rf"\s*(\[{re.escape(table)}\]|{re.escape(table)}\s*=|{re.escape(part)}\s*=)"
        header = re.compile(names)
        here = next((n for n in range(begin, len(lines)) if header.match(lines[n])), None)
        if here is not None:
            begin = found = here + 1
    return found


def field(path: Sequence[str | int]) -> str:
    """Write the path of a field as a person does: ``checks[3].at``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text
