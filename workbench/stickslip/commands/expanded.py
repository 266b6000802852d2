"""What makes a command of a function: dataclasses become options, and errors one line."""

import contextlib
import functools
import inspect
import os
import sys
import tempfile
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import typer
from typer.models import ArgumentInfo

from stickslip.errors import CommandError
from stickslip.parameters import ParameterError, Quantity

_TABLE: Final = Path(__file__).with_name("options.toml").read_text(encoding="utf-8")
_ROWS: Final[dict[str, dict[str, dict[str, Any]]]] = tomllib.loads(_TABLE)
"""What help says of each option, by command or dataclass and name."""
_PANELS: Final = {
    "parameter": "Parameters (a number in SI, or with a unit: 1kN/m, 0.5 N/um, 2 kg)",
    "input": "Inputs, held over the run (20mm/s, 5 N)",
}
_OURS: Final = ("stickslip", "fmi")
_DASH: Final = Path("-")


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

    What it takes by name alone is an option, the rest are arguments; `options.toml` says what each
    means. A dataclass becomes an option for each of its fields, or for those that are named beside
    it, parted by blanks; behind a name, ``?`` says that its default is not used. A mapping is
    written NAME=VALUE, again and again. A flag has no opposite. What the function refuses ends in
    one line.
    """
    options: list[inspect.Parameter] = []
    made: dict[str, tuple[Any, list[str]]] = {}
    hints = _hints(function)
    for parameter in inspect.signature(function).parameters.values():
        kind, chosen = hints[parameter.name], None
        if get_origin(kind) is Annotated:
            kind, names = get_args(kind)
            chosen = names.split()
        if not is_dataclass(kind):
            row = _ROWS[function.__name__][parameter.name]
            make = _option if parameter.kind is parameter.KEYWORD_ONLY else typer.Argument
            options.append(_typed(parameter.name, kind, parameter.default, make(**row)))
            continue
        chosen = chosen or [each.name for each in fields(kind)]
        of_fields = [
            _of_field(kind, each, has_default=each.name in chosen)
            for each in fields(kind)
            if each.init and (each.name in chosen or f"{each.name}?" in chosen)
        ]
        made[parameter.name] = (kind, [each.name for each in of_fields])
        options += of_fields
    infos = {each.name: get_args(each.annotation)[1] for each in options}
    mappings = [each for each, info in infos.items() if info.is_mapping]

    @functools.wraps(function)
    def run(**given: Any) -> None:
        with _refusals(tuple(given)), contextlib.ExitStack() as stack:
            # Python imports from the folder that the command runs in, as by `python -m`.
            sys.path.append(folder := str(Path.cwd()))
            stack.callback(sys.path.remove, folder)
            stack.enter_context(warnings.catch_warnings())
            warnings.showwarning = lambda message, *_: print(
                f"stickslip: warning: {message}", file=sys.stderr
            )
            for name in [name for name, value in given.items() if value == _DASH]:
                # An argument is a file that is read, maybe twice; an option one that is written.
                is_read = isinstance(infos[name], ArgumentInfo)
                given[name] = _standard_input(stack) if is_read else Path("/dev/stdout")
                if not is_read:
                    # Where a file goes, nothing else does.
                    stack.enter_context(contextlib.redirect_stdout(sys.stderr))
            for name in mappings:
                given[name] = named(given[name] or (), infos[name].param_decls[0])
            for name, (kind, names) in made.items():
                typed = {each: given.pop(each) for each in names}
                given[name] = kind(**{k: value for k, value in typed.items() if value is not None})
            function(**given)

    run.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
    run.__annotations__ = {option.name: option.annotation for option in options}
    return run


_hints = functools.cache(functools.partial(get_type_hints, include_extras=True))


def _option(names: Sequence[str] = (), **row: Any) -> Any:
    """Return an option as typer takes it; without names it is written by that of its parameter."""
    info = typer.Option(**row)
    info.param_decls = tuple(names)
    return info


def _of_field(kind: Any, field: Field[Any], *, has_default: bool) -> inspect.Parameter:
    """Return the option of a field of a dataclass; a quantity is typed as a text."""
    quantity = vars(kind).get(field.name)
    if not isinstance(quantity, Quantity):
        hint = _hints(kind)[field.name]
        default = False if hint is bool else None
        info = _option(**_ROWS[kind.__name__][field.name])
        return _typed(field.name, hint if hint is bool else hint | None, default, info)
    text, row = "--" + field.name.replace("_", "-"), quantity.variable
    unit = "" if row.unit == "1" else f" [{row.unit}]"
    limits = "" if row.minimum is None else f", {row.range}"
    start = f"default {row.start:g}" if has_default else "no default"
    info = _option(
        sorted({text, text.lower()} if len(field.name) > 1 else {text}),
        help=f"{row.description}{unit}{limits}; {start}.",
        metavar="VALUE",
        rich_help_panel=_PANELS[row.causality],
    )
    return _typed(field.name, str | None, None, info)


def _typed(name: str, kind: Any, default: Any, info: Any) -> inspect.Parameter:
    """Return a parameter of a function as typer takes it."""
    kinds = set(get_args(kind | None)) - {type(None)}
    info.is_mapping = any(get_origin(each) is Mapping for each in kinds)
    if not isinstance(info, ArgumentInfo):
        info.param_decls = info.param_decls or ("--" + name.strip("_").replace("_", "-"),)
    if info.is_mapping:
        kind, default = list[str] | None, None
    elif kinds == {float, str}:
        kind = str | None
    elif kinds == {Path} and "DIR" not in (info.metavar or ""):
        info.parser = _file
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info]
    )


def _file(text: str | Path) -> Path:
    """Return the file that is named; what ends as a folder does is none, unless there is one."""
    if str(text).endswith(("/", os.sep)) and not Path(text).is_dir():
        raise typer.BadParameter(f"{text}: there is no such folder; name a file")
    return Path(text)


def _standard_input(stack: contextlib.ExitStack) -> Path:
    file = Path(stack.enter_context(tempfile.TemporaryDirectory()), "stdin")
    file.write_bytes(sys.stdin.buffer.read())
    return file


@contextlib.contextmanager
def _refusals(names: Sequence[str]) -> Iterator[None]:
    """Turn what our own code refuses into a `CommandError`; other errors are internal."""
    try:
        yield
    except typer.Exit:
        raise
    except ParameterError as error:
        option = error.name.replace("_", "-")
        # The name of an option that is a word of Python ends with a line: from_.
        known = {error.name, f"{error.name}_"} & {*names}
        option = f"--{option}" if known else f"--law-parameter {error.name}"
        raise CommandError(option + error.reason) from error
    except (ValueError, RuntimeError, ImportError) as error:
        frame = error.__traceback__
        while frame is not None and frame.tb_next is not None:
            frame = frame.tb_next
        where = "" if frame is None else frame.tb_frame.f_globals.get("__name__", "")
        if not where.startswith(_OURS):
            raise
        raise CommandError(" ".join(str(error).split())) from error


@dataclass(frozen=True, kw_only=True)
class Computing:
    """How a study is computed."""

    workers: int | None = None
    cluster: str | None = None
    fresh: bool = False
    yes: bool = False
