"""What makes a command of a function: dataclasses become options, and errors one line."""

import contextlib
import functools
import inspect
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import typer
from typer.models import ArgumentInfo

from stickslip.errors import CommandError
from stickslip.parameters import ParameterError, Quantity

_PANELS: Final = {
    "parameter": "Parameters (a number in SI, or with a unit: 1kN/m, 0.5 N/um, 2 kg)",
    "input": "Inputs, held over the run (20mm/s, 5 N)",
}
_OURS: Final = ("stickslip", "fmi")
_DASH: Final = Path("-")


@dataclass(frozen=True)
class Only:
    """Leaves a dataclass the fields of these names, parted by blanks."""

    names: str


def named(texts: Sequence[str], option: str) -> dict[str, str]:
    """Return what stands behind each name of ``NAME=VALUE``; `CommandError` where there is none."""
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            raise CommandError(f"{option} {text}: write NAME=VALUE")
        if name in found:
            raise CommandError(f"{option} {text}: {name} stands twice")
        found[name] = value
    return found


def command(function: Callable[..., None]) -> Callable[..., None]:
    """Return a function as typer takes it.

    An argument that is a dataclass becomes an option for each of its fields; what the function
    refuses ends in one line.
    """
    hints = get_type_hints(function, include_extras=True)
    options: list[inspect.Parameter] = []
    made: dict[str, tuple[Any, dict[str, str]]] = {}
    for argument in inspect.signature(function).parameters.values():
        hint = hints[argument.name]
        kind: Any
        kind, *extra = get_args(hint) if get_origin(hint) is Annotated else (hint,)
        if not is_dataclass(kind):
            keyword = inspect.Parameter.KEYWORD_ONLY
            options.append(argument.replace(annotation=hint, kind=keyword))
            continue
        names = next((each.names.split() for each in extra if isinstance(each, Only)), None)
        of_fields = {
            field.name: _option(field, vars(kind).get(field.name), get_type_hints(kind))
            for field in fields(kind)
            if field.init and (names is None or field.name in names)
        }
        made[argument.name] = (kind, {name: text for name, (text, _) in of_fields.items()})
        options += [option for _, option in of_fields.values()]

    read = {
        option.name
        for option in options
        if any(isinstance(each, ArgumentInfo) for each in get_args(option.annotation))
    }

    @functools.wraps(function)
    def run(**given: Any) -> None:
        with _refusals(tuple(given)), _here_on_path(), contextlib.ExitStack() as stack:
            for name in [name for name, value in given.items() if value == _DASH]:
                # An argument is a file that is read, maybe twice; an option one that is written.
                given[name] = _standard_input(stack) if name in read else Path("/dev/stdout")
            for name, (kind, names) in made.items():
                typed = {each: given.pop(each) for each in names}
                for each, value in typed.items():
                    if isinstance(value, list):
                        typed[each] = named(value, names[each])
                given[name] = kind(**{k: value for k, value in typed.items() if value is not None})
            function(**given)

    run.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    run.__annotations__ = {option.name: option.annotation for option in options}
    return run


def _option(
    field: Field[Any], quantity: object, hints: Mapping[str, Any]
) -> tuple[str, inspect.Parameter]:
    """Return the option of a field: how it is written, and what typer takes for it."""
    text = field.metadata.get("option", "--" + field.name.replace("_", "-"))
    spellings = {text, text.lower()} if len(field.name) > 1 else {text}
    about: Mapping[str, Any] = field.metadata
    hint: Any = str
    if isinstance(quantity, Quantity):
        row = quantity.variable
        unit = "" if row.unit == "1" else f" [{row.unit}]"
        limits = "" if row.minimum is None else f", {row.range}"
        about = {
            "help": f"{row.description}{unit}{limits}; default {row.start:g}.",
            "metavar": "VALUE",
            "panel": _PANELS[row.causality],
        }
    else:
        hint = _typed(hints[field.name])
    info = typer.Option(
        *sorted(spellings),
        help=about["help"],
        metavar=about.get("metavar"),
        rich_help_panel=about.get("panel"),
        show_default=False,
    )
    is_flag = hint is bool
    option: Any = Annotated[hint if is_flag else hint | None, info]
    return text, inspect.Parameter(
        field.name,
        inspect.Parameter.KEYWORD_ONLY,
        default=False if is_flag else None,
        annotation=option,
    )


def _typed(hint: Any) -> Any:
    """Return the type in which a field is typed: a mapping as texts, a quantity as one."""
    if get_origin(hint) is Mapping:
        return list[str]
    kinds = set(get_args(hint)) - {type(None)} or {hint}
    return next(kind for kind in (bool, Path, str, int, float) if kind in kinds)


def _standard_input(stack: contextlib.ExitStack) -> Path:
    file = Path(stack.enter_context(tempfile.TemporaryDirectory()), "stdin")
    file.write_bytes(sys.stdin.buffer.read())
    return file


@contextlib.contextmanager
def _here_on_path() -> Iterator[None]:
    """Let Python import from the folder that the command runs in, as `python -m` does."""
    sys.path.append(str(Path.cwd()))
    try:
        yield
    finally:
        sys.path.remove(str(Path.cwd()))


@contextlib.contextmanager
def _refusals(names: Sequence[str]) -> Iterator[None]:
    """Turn what our own code refuses into a `CommandError`; other errors are internal."""
    try:
        yield
    except typer.Exit:
        raise
    except ParameterError as error:
        option = error.name.replace("_", "-")
        option = f"--{option}" if error.name in names else f"--law-parameter {error.name}"
        raise CommandError(option + error.reason) from error
    except (ValueError, RuntimeError, ImportError) as error:
        frame = error.__traceback__
        while frame is not None and frame.tb_next is not None:
            frame = frame.tb_next
        where = "" if frame is None else frame.tb_frame.f_globals.get("__name__", "")
        if not where.startswith(_OURS):
            raise
        raise CommandError(" ".join(str(error).split())) from error
