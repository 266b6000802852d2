"""The archive of an FMU, unpacked within limits; its description; which variables are ours.

The names file maps our names to those of an FMU; each variable found is ours in some unit.
"""

import contextlib
import difflib
import hashlib
import re
import tempfile
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeAlias

import fmpy
import fmpy.model_description
from pydantic import BeforeValidator
from pydantic.dataclasses import dataclass as model

from stickslip_units import Conversion, Unit, conversion, defined, spelled

from ..model.data_file import WRITTEN, DataError, DataFile, Written
from ..model.quantities import OUTPUT_NAMES, QUANTITIES
from ..truth.parameters import PARAMETERS, Parameter


class FmuError(RuntimeError):
    """The FMU cannot be used, or refused a call; one line, with the FMU's own message if any."""


def one_line(error: BaseException) -> str:
    """Return the text of an error on one line, or its kind if it has none."""
    return " ".join(str(error).split()) or type(error).__name__


DESCRIPTION = "modelDescription.xml"

MOST_UNPACKED: Final = 2_000_000_000  # bytes of all files of an FMU
MOST_DESCRIBED: Final = 64_000_000
"""Bytes of a model description; one with 100,000 variables has some 30 million."""
MOST_FILES: Final = 100_000  # files and folders of an FMU: empty ones take room as well
MOST_RATIO: Final = 200
"""Bytes unpacked for each packed one, in a file and in all; source and binaries reach 10."""
FREE, FREE_IN_ALL = 10_000_000, 100_000_000
"""Bytes of a file, and of all, that may have any ratio: a table of zeros packs to a thousandth."""
_ELSEWHERE: Final = ("/tmp", "/var/tmp")
"""Where to unpack if the folder for temporary files has another name than plain."""


def check_size(path: Path) -> None:
    """Refuse an FMU that unpacks, by what it says, to more than the limits; `FmuError`."""
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    total = sum(entry.file_size for entry in entries)
    grows = f"more than {MOST_RATIO} times its packed size"
    if len(entries) > MOST_FILES:
        raise FmuError(f"{path}: has {len(entries)} files; at most {MOST_FILES} are unpacked")
    if total > MOST_UNPACKED:
        most = _mb(MOST_UNPACKED)
        raise FmuError(f"{path}: unpacks to {_mb(total)}; at most {most} are unpacked")
    for entry in entries:
        name, size = entry.filename, entry.file_size
        if name == DESCRIPTION and size > MOST_DESCRIBED:
            most = _mb(MOST_DESCRIBED)
            raise FmuError(f"{path}: {name} has {_mb(size)}; at most {most} are read")
        if size > max(FREE, MOST_RATIO * entry.compress_size):
            raise FmuError(f"{path}: its file {name!r} unpacks to {_mb(size)}, {grows}")
    # Packed files may overlap, but the archive has no more bytes than it has.
    if total > max(FREE_IN_ALL, MOST_RATIO * path.stat().st_size):
        raise FmuError(f"{path}: it unpacks to {_mb(total)}, {grows}")


def unpack(path: Path, folder: Path) -> None:
    """Unpack an FMU that `check_size` lets pass; `FmuError` for damaged files, names elsewhere."""
    try:
        fmpy.extract(path, unzipdir=folder)
    except OSError as error:
        reason = error.strerror or one_line(error)
        raise FmuError(f"{path}: cannot be unpacked into {folder} ({reason})") from None
    except Exception as error:
        raise FmuError(f"{path}: cannot be unpacked ({one_line(error)})") from None


def new_folder() -> Path:
    """Make an empty folder for an FMU; `FmuError` if none can have a name without escapes.

    An FMU gets its folder as a URI, and pythonfmu's wrapper decodes of it ``%20`` alone: any other
    escape, as for an umlaut, ends the process.
    """
    usual = tempfile.gettempdir()
    for parent in (usual, *_ELSEWHERE):
        if "%" not in Path(parent).absolute().as_uri().replace("%20", ""):
            with contextlib.suppress(OSError):
                return Path(tempfile.mkdtemp(prefix="stickslip-fmu-", dir=parent))
    raise FmuError(
        f"{usual}: FMUs made with pythonfmu cannot be unpacked in a folder of this name; "
        "set TMPDIR to one with letters of ASCII and digits"
    )


def _mb(size: int) -> str:
    return f"{size / 1e6:,.0f} MB"


EVIDENCE: Final = "extra/"  # the folder of an FMU with its evidence, left out of the digest


def content_digest(fmu: Path) -> str:
    """Return the SHA-256 of an FMU's content without its extra/ folder, in hexadecimal.

    It is that of the list which ``sha256sum`` prints of the unpacked files, in the order of the
    bytes of their names: how the archive is packed makes no difference.
    """
    lines = ""
    with zipfile.ZipFile(fmu) as archive:
        for name in sorted(archive.namelist(), key=str.encode):
            if not name.endswith("/") and not name.startswith(EVIDENCE):
                with archive.open(name) as stream:
                    digest = hashlib.file_digest(stream, "sha256")  # type: ignore[arg-type]
                lines += f"{digest.hexdigest()}  {name}\n"
    return hashlib.sha256(lines.encode()).hexdigest()


KINDS: Final = {
    "CoSimulation": "co-simulation",
    "ModelExchange": "model exchange",
    "ScheduledExecution": "scheduled execution",
}
VERSIONS: Final = ("2.0", "3.0")  # versions of FMI that the suite drives

NUMBERS: Final = frozenset(
    {"Real", "Integer", "Enumeration", "Boolean", "Float64", "Float32"}
    | {f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)}
)
"""Kinds of variable whose value is a number, of FMI 2.0 and 3.0."""

ANNOTATION: Final = "org.stickslip.contract"
"""Type of the annotation that names the contract, FMI 3.0; its name in a ``Tool``, FMI 2.0."""
NAME, VERSION = "stickslip-exact", "1"  # name and version of the exact contract of this suite

_LETTERS: Final = 40

_PLACES: Final = (("VendorAnnotations/Tool", "name"), ("Annotations/Annotation", "type"))

_DIMENSION = attrgetter("kg", "m", "s", "A", "K", "mol", "cd", "rad")

_MOST_PROBLEMS, _LONGEST_PROBLEM = 100, 1000

_MOST_LISTED, _LONGEST_TEXT = 8, 40
"""Variables that a message lists, `stickslip names` lists all; letters of a description in it."""
Declared: TypeAlias = fmpy.model_description.ModelVariable
"""A variable as its FMU declares it: unit also where its type has it, description on one line."""


@dataclass(frozen=True)
class StatedContract:
    """Whether a description names the exact contract of this suite, and what it names in words."""

    exact: bool
    told: str


class Description:
    """What the model description of an FMU says; `FmuError` if it is none of this kind of `KINDS`.

    ``sizes`` are the numbers of its continuous states and event indicators, ``token`` is its guid
    or instantiation token, ``declared`` its variables by its own names, ``units`` those that it
    defines by SI base units, ``experiment`` start, stop and step of its default experiment [s] as
    they are spelled, where it has them, ``problems`` what it breaks of the FMI standard, if it can
    be read all the same, ``stated`` the contract that it names.
    """

    def __init__(self, path: Path, kind: str = "CoSimulation") -> None:
        root, read, self.problems = _read(path, kind)
        experiment, interface = read.defaultExperiment, getattr(read, kind[0].lower() + kind[1:])
        self.sizes = (read.numberOfContinuousStates, read.numberOfEventIndicators)
        self.fmi_version: str = read.fmiVersion[:3]
        self.token: str = read.guid
        self.model_identifier: str = interface.modelIdentifier
        self.can_get_and_set_state: bool = interface.canGetAndSetFMUstate
        self.can_serialize_state: bool = interface.canSerializeFMUstate
        self.once_per_process: bool = interface.canBeInstantiatedOnlyOncePerProcess
        self.declared: Mapping[str, Declared] = {each.name: each for each in read.modelVariables}
        self.units: Mapping[str, Unit] = {
            each.name: unit
            for each in read.unitDefinitions
            if (base := each.baseUnit) is not None
            if (unit := defined(base.factor, base.offset, _DIMENSION(base))) is not None
        }
        spelled = {"start_time": "startTime", "stop_time": "stopTime", "step": "stepSize"}
        self.experiment: Mapping[str, str] = {
            name: text
            for name, theirs in spelled.items()
            if (text := getattr(experiment, theirs, None)) is not None
        }
        self.stated = stated_contract(root)

    def listing(self, names: Collection[str]) -> str:
        """Return on one line what the FMU has, what is most like the names first, and how much."""

        def likeness(variable: Declared) -> float:
            last = re.split(r"[.\]]+", variable.name.rstrip("]."))[-1]
            return max(
                difflib.SequenceMatcher(None, name.lower(), part.lower()).ratio()
                for name in names
                for part in (variable.name, last)
            )

        variables = [each for each in self.declared.values() if each.type in NUMBERS]
        first = sorted(variables, key=likeness, reverse=True)[:_MOST_LISTED]
        more = len(variables) - len(first)
        listed = ", ".join(map(shown, first)) or "no number"
        return f"it has {listed}" + (f" and {more} more" if more else "")


def shown(variable: Declared) -> str:
    """Return name, unit and description of a variable, for people."""
    text = variable.description
    if len(text) > _LONGEST_TEXT:
        text = text[: _LONGEST_TEXT - 1].rstrip() + "\N{HORIZONTAL ELLIPSIS}"
    unit = f" [{variable.unit}]" if variable.unit else ""
    return f"{variable.name}{unit}{f' ({text})' if text else ''}"


def _read(path: Path, kind: str) -> tuple[ElementTree.Element, Any, tuple[str, ...]]:
    """Return the root of a model description, FMPy's record of it, and what it breaks of FMI."""
    if not path.exists():
        raise FmuError(f"{path}: no such file")
    if not (path.is_file() and zipfile.is_zipfile(path)):
        raise FmuError(f"{path}: not an FMU (not a {'zip archive' if path.is_file() else 'file'})")
    problems: tuple[str, ...] = ()
    try:
        check_size(path)
        with zipfile.ZipFile(path) as archive:
            if DESCRIPTION not in archive.namelist():
                raise FmuError(f"{path}: not an FMU (no {DESCRIPTION} in it)")
            # FMPy would say this in words of its own, or of Python's.
            with archive.open(DESCRIPTION) as stream:
                # Without a number of bytes, zipfile unpacks more than the archive says.
                root = ElementTree.fromstring(stream.read(MOST_DESCRIBED))
        _check(path, root, kind)
        try:
            read = fmpy.read_model_description(str(path))
        except fmpy.model_description.ValidationError as error:
            problems = tuple(
                " ".join(str(problem).split())[:_LONGEST_PROBLEM]
                for problem in error.problems[:_MOST_PROBLEMS]
            )
            read = fmpy.read_model_description(str(path), validate=False)
    except FmuError:
        raise
    except Exception as error:
        raise FmuError(f"{path}: not an FMU ({one_line(error)})") from None
    for each in read.modelVariables:
        each.unit = each.unit or (each.declaredType and each.declaredType.unit)
        each.description = " ".join((each.description or "").split())
    return root, read, problems


def _check(path: Path, root: ElementTree.Element, kind: str) -> None:
    version = root.get("fmiVersion")
    if root.tag != "fmiModelDescription" or version is None:
        raise FmuError(f"{path}: not an FMU ({DESCRIPTION} is no model description)")
    if version[:3] not in VERSIONS:
        raise FmuError(f"{path}: is FMI {version}; this suite drives FMI 2.0 and 3.0")
    if root.find(kind) is None:
        others = [text for tag, text in KINDS.items() if root.find(tag) is not None]
        has = f", only {' and '.join(others)}" if others else ""
        has += "; --interface me drives that" if KINDS["ModelExchange"] in others else ""
        raise FmuError(f"{path}: has no {KINDS[kind]} interface{has}")


def stated_contract(root: ElementTree.Element) -> StatedContract:
    """Read the contract from the root of a model description."""
    notes = [
        note for path, key in _PLACES for note in root.findall(path) if note.get(key) == ANNOTATION
    ]
    named = [(each.tag, each.get("name"), each.get("version")) for note in notes for each in note]
    exact = [each[1:] for each in named] == [(NAME, VERSION)]
    if not notes:
        told = "its description names no contract of this suite"
    elif len(notes) > 1:
        told = f"its description has {len(notes)} annotations {ANNOTATION}"
    elif len(named) != 1 or named[0][0] != "Contract" or None in named[0]:
        expected = 'expected one element <Contract name="..." version="..."/>'
        told = f"the annotation {ANNOTATION} of its description is malformed: {expected}"
    else:
        # What stands in an attribute, on one line and not endless.
        shortened = (" ".join(str(text).split())[:_LETTERS] for text in named[0][1:])
        unlike = "" if exact else f"; this suite knows {NAME} {VERSION}"
        return StatedContract(exact, f"its description names {' '.join(shortened)}{unlike}")
    return StatedContract(False, told)


INPUT_UNITS: Mapping[str, str] = {each.name: each.unit for each in PARAMETERS}
"""What the suite sets, parameters and inputs, with its unit."""
UNITS: Mapping[str, str] = {**INPUT_UNITS, **{name: QUANTITIES[name].unit for name in OUTPUT_NAMES}}
"""Every variable of the suite with its SI unit."""
NOT_THERE = ""
"""In place of the FMU's name: the FMU has no such variable, whatever its names look like."""


class NamesError(DataError):
    """A names file cannot be used."""


@model(frozen=True, config=WRITTEN)
class Target(Written):
    """What one of our variables is in the FMU: its name or `NOT_THERE`, unit of its numbers, sign.

    Without a unit that of the FMU's description counts; the sign is -1 if it counts the other way.
    """

    name: str
    unit: str | None = None
    sign: Literal[1, -1] = 1


@dataclass(frozen=True)
class NameMap:
    """Our names to those of the FMU, from a file; what is not in it is called as ours is."""

    targets: Mapping[str, Target] = field(default_factory=dict)
    file: Path | None = None


def load_names(file: Path, own: Iterable[Parameter] = ()) -> NameMap:
    """Read a names file: ``x = "mass.s"`` or ``x = { name = "mass.s", unit = "mm", sign = -1 }``.

    The entries stand at the top of the TOML file or in a table ``[names]``, those of the parameters
    of a friction law, `own`, too. `NamesError` if it cannot be read or holds something else.
    """
    source = DataFile(file, NamesError)
    place = ["names"] if isinstance(source.data.get("names"), dict) else []
    for key in source.data if place else ():
        if key != "names":
            raise source.refusal(f"{key!r} stands beside the table [names]", key)
    known = {*UNITS, *(each.name for each in own)}
    targets: dict[str, Target] = {}
    for key, target in source.read(_Targets, *place).items():
        if key not in known:
            near = difflib.get_close_matches(key, UNITS, n=3, cutoff=0.5)
            # Names of one or two letters resemble nothing; the usual slip is the case of a letter.
            near += [n for n in UNITS if n.lower() == key.lower() and n not in near]
            there = f"near it: {', '.join(near)}" if near else f"there are {', '.join(UNITS)}"
            raise source.refusal(f"{key!r} is no variable of the suite; {there}", *place, key)
        taken = [ours for ours, other in targets.items() if other.name == target.name != NOT_THERE]
        if taken:
            reason = f"{key} and {taken[0]} are both {target.name!r}"
            raise source.refusal(reason, *place, key)
        targets[key] = target
    if not targets:
        raise source.refusal("names no variable")
    return NameMap(targets, file)


def _named(entries: Any) -> Any:
    """Return entries as tables: a text is a name, and a table without one keeps ours."""
    if not isinstance(entries, dict):
        return entries
    return {
        ours: {"name": ours, **entry} if isinstance(entry, dict) else {"name": entry}
        for ours, entry in entries.items()
    }


_Targets = Annotated[Mapping[str, Target], BeforeValidator(_named)]


SETTABLE = frozenset({"parameter", "input"})
READABLE = frozenset({"output", "local", "calculatedParameter"})


@dataclass(frozen=True)
class Variable:
    """A variable of the FMU that is one of ours.

    ``unit`` is that of its numbers, as the names file or else the FMU spells it, None where SI is
    assumed; ``start`` is in SI; ``conversion`` makes its numbers ours in SI.
    """

    name: str
    their_name: str
    reference: int
    kind: str
    unit: str | None
    causality: str
    variability: str
    start: float | None
    conversion: Conversion


def collect(
    label: str, description: Description, names: NameMap, wanted: Mapping[str, str]
) -> dict[str, Variable]:
    """Find variables of ours, `wanted` names with their units, in a model description.

    A name that the map leaves out is looked for as it is, and counts only if it `looks_like` ours.
    `FmuError`, beginning with `label`, for mapped names that the FMU does not have, a variable of
    the wrong sort, a unit that is unknown or of another dimension.
    """
    theirs, targets = description.declared, names.targets
    taken = {ours: each.name for ours, each in targets.items() if each.name != NOT_THERE}
    absent = {ours: name for ours, name in taken.items() if name not in theirs}
    if absent:
        lacking = ", ".join(f"{name!r} for {ours}" for ours, name in absent.items())
        has = description.listing(absent.values())
        raise FmuError(f"{label}: has no variable {lacking}; {has}")
    found = {}
    for ours, unit in wanted.items():
        guess = theirs.get(ours)
        if ours in taken:
            target = targets[ours]
        elif ours in targets or ours in taken.values() or not (guess and looks_like(ours, guess)):
            continue
        else:
            target = Target(ours)
        found[ours] = as_ours(label, ours, target, theirs[target.name], description.units, unit)
    return found


def looks_like(ours: str, variable: Declared) -> bool:
    """Whether a variable of an FMU is declared as what this one of ours is: set, or read."""
    causalities = {"output"} if ours in QUANTITIES else SETTABLE
    return variable.causality in causalities and variable.variability != "constant"


def as_ours(
    label: str, ours: str, target: Target, theirs: Declared, units: Mapping[str, Unit], unit: str
) -> Variable:
    """Return a variable of the FMU as one of ours in `unit`; `FmuError` if it cannot be that."""
    called = ours if ours == theirs.name else f"{ours} ({theirs.name!r})"
    to_set = ours not in QUANTITIES
    if theirs.causality not in (SETTABLE if to_set else READABLE) or (
        to_set and theirs.variability == "constant"
    ):
        must = "a parameter or an input" if to_set else "an output"
        declared = f"{theirs.variability} {theirs.causality}"
        raise FmuError(f"{label}: {called} must be {must}, not a {declared}")
    if theirs.type not in NUMBERS:
        raise FmuError(f"{label}: {called} is of type {theirs.type}, not a number")
    if theirs.dimensions:
        raise FmuError(f"{label}: {called} is an array; only scalars can be verified")
    name = theirs.unit if target.unit is None else target.unit
    # What a person wrote is meant as it is spelled; what the FMU declares, as it defines it.
    defined = None if name is None else units.get(name)
    meant = spelled(unit if name is None else name)
    theirs_in = (defined or meant) if target.unit is None else (meant or defined)
    expected = spelled(unit)
    if theirs_in is None:
        raise FmuError(
            f"{label}: the unit {name!r} of {called} is not known; give one in the names file: "
            f'{ours} = {{ name = "...", unit = "{unit}" }}'
        )
    if expected is None or theirs_in.dimension != expected.dimension:
        raise FmuError(
            f"{label}: {called} is in {name!r}, which is not a unit like {unit!r}; if it is "
            f'another quantity, leave it out in the names file: {ours} = ""'
        )
    change = conversion(theirs_in, target.sign)
    start = {"true": 1.0, "false": 0.0}.get(theirs.start, theirs.start)
    return Variable(
        name=ours,
        their_name=theirs.name,
        reference=theirs.valueReference,
        kind=theirs.type,
        unit=name,
        causality=theirs.causality,
        variability=theirs.variability,
        start=None if theirs.start is None else change.to_si(float(start)),
        conversion=change,
    )
