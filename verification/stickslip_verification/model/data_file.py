"""Files that people write: TOML, read into frozen typed models, refused with place and reason.

Unit, bounds and help of a field stand once, in its type; they make the reader, the error and the
document. What fields ask of one another is a table of the model: `Written`.
"""

import re
import secrets
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, lru_cache
from itertools import product
from pathlib import Path
from typing import IO, Annotated, Any, ClassVar, Self, TypeVar

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

_PART = ".part"


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """Open a file that takes the place of `path` when the block ends well.

    It is written next to its place, in a folder that exists. Where the block fails, `path` is left
    as it was. `OSError`, which names `path`, if the file cannot be written, as on a full disk.
    """
    part = path.parent / f".{secrets.token_hex(8)}{_PART}"
    try:
        try:
            with part.open("xb") as stream:
                yield stream
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        # A full disk names no file.
        if error.errno is None or not str(error.filename or _PART).endswith(_PART):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def write_whole(path: Path, content: str | bytes) -> None:
    """Write `path`, making its folder; an interrupted write leaves the old file as it was."""
    write_all({path: content})


def write_all(files: Mapping[Path, str | bytes]) -> None:
    """Write files as `write_whole` does; none takes its place before all are written."""
    with ExitStack() as stack:
        for path, content in files.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            # What an FMU said may hold half a character; that must not cost the report.
            whole = content.encode("utf-8", "replace") if isinstance(content, str) else content
            stream = stack.enter_context(replacing(path))
            stream.write(whole)
            # What is still in a buffer might not fit.
            stream.flush()


Place = Sequence[str | int]  # path of a field: names, and numbers in lists

Shape = TypeVar("Shape")

WRITTEN = ConfigDict(extra="forbid", validate_by_name=True, allow_inf_nan=False)
"""The configuration of models of files: nothing that they do not name, and only finite numbers."""

Text = Annotated[str, Field(pattern=r"\S")]
Prose = Annotated[Text, AfterValidator(lambda text: " ".join(text.split()))]
Id = Annotated[str, Field(pattern=r"^[A-Za-z0-9]+([_.-][A-Za-z0-9]+)*$")]
Number = Annotated[float, Field(strict=True)]
Amount = Annotated[Number, Field(ge=0.0)]
Positive = Annotated[Number, Field(gt=0.0)]
Count = Annotated[int, Field(strict=True, ge=0)]
Ordinal = Annotated[int, Field(strict=True, ge=1)]


def listed(name: str, short: str = "") -> BeforeValidator:
    """Return the rule that makes a list of tables, each with its own name as the field `name`.

    An entry that is no table is the field `short`.
    """

    def tables(data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        return [
            {**(entry if isinstance(entry, dict) else {short: entry}), name: key}
            for key, entry in data.items()
        ]

    return BeforeValidator(tables)


ById = Annotated[Sequence[Shape], listed("id")]
"""Tables whose names are the ids of what they describe."""


def keyed(*names: str) -> AfterValidator:
    """Return the rule that a table has these keys and no other."""

    def check(table: Mapping[str, Any]) -> Mapping[str, Any]:
        if set(table) != set(names):
            raise ValueError(f"has the keys {', '.join(table)}, and not {' and '.join(names)}")
        return table

    return AfterValidator(check)


def known(what: str, names: Mapping[str, Any] | Sequence[str]) -> AfterValidator:
    """Return the rule that a text is one of these names."""

    def check(name: str) -> str:
        if name not in names:
            raise ValueError(f"{name!r} is not a known {what}: {', '.join(names)}")
        return name

    return AfterValidator(check)


@dataclass(frozen=True)
class Written:
    """What stands in a file: base of the models, which are dataclasses of pydantic."""

    NEEDS: ClassVar[Mapping[str, Sequence[str]]] = {}
    """Where a field is written, these are too."""

    EXCLUDES: ClassVar[Mapping[str, Sequence[str]]] = {}
    """Where a field is written, these are not."""

    SOME: ClassVar[Sequence[str]] = ()
    """At least one of these fields is written."""

    @model_validator(mode="wrap")
    @classmethod
    def _together(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Find what fields ask of one another as well, whether or not they are right alone."""
        made, errors = None, []
        try:
            made = handler(data)
        except ValidationError as error:
            errors = [_detail(each["loc"], _reason(cls, dict(each))) for each in error.errors()]
        if isinstance(data, dict):
            for name in data:
                needs, excludes = cls.NEEDS.get(name, ()), cls.EXCLUDES.get(name, ())
                errors += [_detail([name], f"needs {o}") for o in needs if o not in data]
                errors += [_detail([name], f"does not go with {o}") for o in excludes if o in data]
            if cls.SOME and not set(cls.SOME) & data.keys():
                errors.append(_detail((), f"needs {' or '.join(cls.SOME)}"))
        if made is None or errors:
            raise ValidationError.from_exception_data(cls.__name__, errors)
        return made


def _detail(place: Place, reason: str) -> InitErrorDetails:
    kind = PydanticCustomError("written", "{reason}", {"reason": reason})
    return InitErrorDetails(type=kind, loc=tuple(place), input=None)


def _reason(model: type, error: Mapping[str, Any]) -> str:
    if error["type"] == "written":
        return str(error["msg"])
    if error["type"] == "missing":
        return "is missing"
    if error["type"] == "unexpected_keyword_argument":
        there = f"; there are {', '.join(each.name for each in fields(model))}"
        return f"is no field{there if is_dataclass(model) else ''}"
    reason = str(error["msg"]).removeprefix("Value error, ")
    if error["type"] == "value_error":
        return reason
    value = "" if isinstance(error["input"], dict | list) else f"{error['input']!r} "
    return value + re.sub(r"^\w+ should", "should", reason)


class DataError(ValueError):
    """A data file cannot be used; a line for each reason, with the file and the line or field."""

    def __init__(self, file: Path, where: str, reason: str, *more: tuple[str, str]) -> None:
        self.file = file
        self.where = where
        self.reason = reason
        lines = [": ".join(filter(None, (str(file), *each))) for each in ((where, reason), *more)]
        super().__init__("\n".join(lines))


class DataFile:
    """A TOML file: its text, its data, and refusals of what stands in it, of the kind `error`.

    It is refused where it cannot be read, is no UTF-8 or no TOML.
    """

    def __init__(self, path: Path, error: type[DataError]) -> None:
        self.path = path
        self._error = error
        self._text = read_text(path, error)
        try:
            self.data: dict[str, Any] = tomllib.loads(self._text)
        except tomllib.TOMLDecodeError as fault:
            line, reason = fault_of(fault, self._text)
            raise error(path, f"line {line}", reason) from None

    def read(self, shape: Any, *place: str) -> Any:
        """Return the data, or the table at a place, as a model; refuse all that is wrong in it."""
        data: Any = self.data
        for part in place:
            data = data[part]
        try:
            return _adapter(shape).validate_python(data)
        except ValidationError as fault:
            first, *others = [
                (self._where((*place, *each["loc"])), _reason(shape, dict(each)))
                for each in fault.errors()
            ]
            raise self._error(self.path, *first, *others) from None

    def refusal(self, reason: str, *place: str | int) -> DataError:
        """Return the error that refuses a field for a reason."""
        return self._error(self.path, self._where(place), reason)

    def _where(self, place: Place) -> str:
        """Say where a field is: its line, as far as it is written out, and its name."""
        named: tuple[str | int, ...] = ()
        name = ""
        data: Any = self.data
        for part in place:
            if isinstance(data, dict) and isinstance(part, int):
                # The tables that `listed` made a list of.
                part = list(data)[part]
            named = (*named, part)
            name += f"[{part}]" if isinstance(part, int) else f".{part}" if name else part
            data = data.get(part) if isinstance(data, dict) else None
        line = line_of(self._text, named)
        return ", ".join(filter(None, (f"line {line}" if line else "", name)))


def line_of(text: str, place: Place) -> int:
    """Return the line of a field of a TOML text, else of what it stands in; 0 without either."""
    places = [place[:n] for n in range(len(place), 0, -1)]
    beginnings = _beginnings(text)
    return next((n for of in places for n, data in beginnings.items() if _has(data, of)), 0)


@lru_cache(1)
def _beginnings(text: str) -> Mapping[int, Any]:
    """Return what the first lines of a text say, by number; what they leave open is closed."""
    lines = text.splitlines()
    beginnings: dict[int, Any] = {}
    for n, end in product(range(1, len(lines) + 1), ("", "]", '"""', "'''")):
        with suppress(tomllib.TOMLDecodeError):
            beginnings.setdefault(n, tomllib.loads("\n".join((*lines[:n], end))))
    return beginnings


def _has(data: Any, place: Place) -> bool:
    for part in place:
        if part not in (range(len(data)) if isinstance(data, list) else data):
            return False
        data = data[part]
    return True


_adapter: Callable[[Any], TypeAdapter[Any]] = cache(TypeAdapter)


def fault_of(error: tomllib.TOMLDecodeError, text: str) -> tuple[int, str]:
    """Return the line of what is no TOML, and the reason."""
    reason, _, place = str(error).rpartition(" (at ")
    line = re.match(r"line (\d+)", place)
    return int(line[1]) if line else text.rstrip().count("\n") + 1, reason


def read_text(file: Path, error: type[DataError]) -> str:
    """Read a text; raises `error` where it cannot be read or is no UTF-8."""
    try:
        return file.read_text(encoding="utf-8")
    except OSError as fault:
        raise error(file, "", (fault.strerror or str(fault)).lower()) from None
    except UnicodeDecodeError as fault:
        raise error(file, "", f"is not UTF-8: {fault.reason}") from None
