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


def opt(text: str, metavar: str | None = None, *names: str, **more: Any) -> Any:
    """Return an option as typer takes it: its help, what stands for a value, how it is written."""
    info = typer.Option(help=text, metavar=metavar, **more)
    info.param_decls = names
    return info


def arg(text: str, metavar: str) -> Any:
    """Return an argument as typer takes it: its help, and what stands for it."""
    return typer.Argument(help=text, metavar=metavar)


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

    An argument that is a dataclass becomes an option for each of its fields, or for those that are
    named beside it, parted by blanks. A mapping is written NAME=VALUE, again and again. A flag has
    no opposite. What the function refuses ends in one line.
    """
    options: list[inspect.Parameter] = []
    made: dict[str, tuple[Any, list[str]]] = {}
    hints = _hints(function)
    for parameter in inspect.signature(function).parameters.values():
        hint = hints[parameter.name]
        kind, *extra = get_args(hint) or (hint,)
        if not is_dataclass(kind):
            options.append(_expanded(parameter.name, hint, parameter.default))
            continue
        chosen = next((each.split() for each in extra), None)
        of_fields = [
            _of_field(kind, each)
            for each in fields(kind)
            if each.init and (chosen is None or each.name in chosen)
        ]
        made[parameter.name] = (kind, [each.name for each in of_fields])
        options += of_fields
    infos = {each.name: get_args(each.annotation)[1] for each in options}
    mappings = [each for each, info in infos.items() if getattr(info, "is_mapping", False)]

    @functools.wraps(function)
    def run(**given: Any) -> None:
        with _refusals(tuple(given)), _here_on_path(), contextlib.ExitStack() as stack:
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


def _of_field(kind: Any, field: Field[Any]) -> inspect.Parameter:
    """Return the option of a field of a dataclass; a quantity is typed as a text."""
    hint = _hints(kind)[field.name]
    if get_origin(hint) is Annotated:
        return _expanded(field.name, hint, field.default)
    text = field.metadata.get("option", "--" + field.name.replace("_", "-"))
    spellings = sorted({text, text.lower()} if len(field.name) > 1 else {text})
    quantity = vars(kind).get(field.name)
    if isinstance(quantity, Quantity):
        row = quantity.variable
        unit = "" if row.unit == "1" else f" [{row.unit}]"
        limits = "" if row.minimum is None else f", {row.range}"
        about = f"{row.description}{unit}{limits}; default {row.start:g}."
        info = opt(about, "VALUE", *spellings, rich_help_panel=_PANELS[row.causality])
        hint = str
    else:
        info = opt(field.metadata["help"], field.metadata["metavar"], *spellings)
    return _expanded(field.name, Annotated[hint | None, info], None)


def _expanded(name: str, hint: Any, default: Any) -> inspect.Parameter:
    """Return a parameter of a function as typer takes it."""
    kind, info = get_args(hint)
    kinds = set(get_args(kind | None)) - {type(None)}
    if kinds == {bool} and not info.param_decls and default is False:
        info.param_decls = ("--" + name.strip("_").replace("_", "-"),)
    if any(get_origin(each) is Mapping for each in kinds):
        info.is_mapping = True
        info.param_decls = info.param_decls or ("--" + name,)
        kind, default = list[str] | None, None
    elif kinds == {float, str}:
        kind = str | None
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info]
    )


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


_computing = functools.partial(opt, rich_help_panel="Computing")

FrictionLaw = Annotated[
    str,
    opt(
        "Friction law: coulomb (the default), stribeck, or MODULE:NAME for one of your own.",
        "NAME",
        "--law",
    ),
]


@dataclass(frozen=True, kw_only=True)
class Computing:
    """How a study is computed."""

    workers: Annotated[
        int | None, _computing("Processes on this machine; default: one a core.", "N")
    ] = None
    cluster: Annotated[
        str | None,
        _computing(
            "Compute on the workers of a dask scheduler (tcp://host:8786), which share the folder "
            "of the study.",
            "ADDRESS",
        ),
    ] = None
    fresh: Annotated[
        bool,
        _computing(
            "Throw away what an earlier run of another study, or of other versions, has left."
        ),
    ] = False
    yes: Annotated[bool, _computing("Compute more than 10^9 points.")] = False
