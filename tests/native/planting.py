"""Plants faults in the native FMU: single functions and constants replaced at link time.

The C sources are compiled once, each into an object in which every function and constant of file
scope can be replaced: it is weak, and a second symbol ``true_NAME`` leads to the original. A fault
is a C file that defines one of the names anew; it may call the true one. The sources themselves
know nothing of it.
"""

import re
import subprocess
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

FAULTS = Path(__file__).parent / "faults"

# As in the FMU, but nothing is made one with its callers, so that calls inside a file are replaced
# as well.
_FLAGS = ("-std=gnu99", "-O2", "-ffp-contract=off", "-fPIC", "-ffunction-sections")
# Of constants `const` goes too: the compiler would fold their values.
_STATIC = re.compile(r"^static (?:inline )?(?:const (?=[^(]*=))?", re.MULTILINE)
_WEAK = "__attribute__((weak)) "

COUNTING = Path(__file__).parent / "fuzz" / "counting.c"
"""Counts the blocks of memory that a library holds."""

LINK = (
    "-shared",
    "-Wl,-Bsymbolic,--no-undefined",
    "-Wl,--wrap=malloc,--wrap=calloc,--wrap=free",
)
"""How a library that counts its blocks of memory is linked."""

# Of a file that begins with a comment: about, friction law, names, check, place.
_HEAD = re.compile(
    r"/\* (?P<about>.+?)\n"
    r"(?: \* law: (?P<law>\w+)\n)?"
    r" \* replaces: (?P<replaces>[\w., ]+)\n"
    r" \* detected by: (?P<check>[\w-]+)(?: in (?P<place>[\w -]+))?\n"
    r" \*/\n",
    re.DOTALL,
)


@dataclass(frozen=True)
class Fault:
    """One planted fault.

    Attributes
    ----------
    source
        The C file; its stem is the name of the fault.
    about
        What is wrong, in one sentence.
    law
        The friction law under which it is planted; Coulomb's where the head names none.
    replaces
        Names of the functions and constants that it replaces, where needed with their file:
        ``meter.c.ZERO``.
    check
        The check that must fail.
    place
        The case or the seeds on which the check is tried, "" for a check without any.
    """

    source: Path
    about: str
    law: str
    replaces: tuple[str, ...]
    check: str
    place: str

    @property
    def id(self) -> str:
        """Name of the fault."""
        return self.source.stem


def load_fault(source: Path) -> Fault:
    """Read the head of a fault; ValueError where it is none."""
    found = _HEAD.match(source.read_text())
    if found is None:
        raise ValueError(f"{source.name}: does not begin with about, replaces and detected by")
    return Fault(
        source,
        about=" ".join(found["about"].replace("\n *", "\n").split()),
        law=found["law"] or "coulomb",
        replaces=tuple(each.strip() for each in found["replaces"].split(",")),
        check=found["check"],
        place=found["place"] or "",
    )


def load_faults() -> list[Fault]:
    """Read all faults, in the order of their names."""
    return [load_fault(source) for source in sorted(FAULTS.glob("*.c"))]


@dataclass
class _Object:
    """One compiled source whose names can be replaced.

    ``sections`` has the section and the offset of each function and constant by name, ``own`` the
    names that are static in the source.
    """

    file: Path
    sections: dict[str, tuple[str, int]] = field(default_factory=dict)
    own: set[str] = field(default_factory=set)


class Planter:
    """Relinks a library with faults.

    Parameters
    ----------
    sources
        C sources and headers by name, as they lie in one folder.
    folder
        Where objects and libraries are made.
    """

    def __init__(self, sources: Mapping[str, bytes], folder: Path) -> None:
        self._folder = folder / "objects"
        self._folder.mkdir()
        headers = {name: text for name, text in sources.items() if not name.endswith(".c")}
        for name, content in headers.items():
            (self._folder / name).write_bytes(content)
        self._objects = {
            name: self._compiled(name, content.decode())
            for name, content in sources.items()
            if name.endswith(".c")
        }
        self._counting = self._folder / "counting.o"
        _run("cc", *_FLAGS, "-c", COUNTING, "-o", self._counting)
        self._healthy = {
            name: self._with_weak(each, name, set()) for name, each in self._objects.items()
        }

    def library(self, target: Path, fault: Fault | None = None) -> Path:
        """Link the library, with the fault planted, and return it.

        Raises
        ------
        ValueError
            A name that the fault replaces is in no source, or in several.
        """
        replaced: dict[str, set[str]] = {}
        for name in fault.replaces if fault else ():
            replaced.setdefault(self.source_of(name), set()).add(name.rpartition(".")[2])
        objects = [
            self._with_weak(each, f"{target.stem}-{name}", replaced[name])
            if name in replaced
            else self._healthy[name]
            for name, each in self._objects.items()
        ]
        if fault is not None:
            planted = self._folder / f"{target.stem}-fault.o"
            _run("cc", *_FLAGS, f"-I{self._folder}", "-c", fault.source, "-o", planted)
            objects.append(planted)
        _run("cc", *LINK, *objects, self._counting, "-o", target, "-lm")
        return target

    def names(self) -> Mapping[str, Sequence[str]]:
        """Return what can be replaced, by the name of its source."""
        return {name: sorted(each.sections) for name, each in self._objects.items()}

    def _compiled(self, name: str, text: str) -> _Object:
        source = self._folder / name
        source.write_text(_STATIC.sub(_WEAK, text))
        made = _Object(source.with_suffix(".o"))
        _run("cc", *_FLAGS, "-fdata-sections", "-c", source, "-o", made.file)
        for line in _run("objdump", "-t", made.file).splitlines():
            # Address, flags in seven columns, section, size, name.
            found = re.fullmatch(r"(\w+) (g | w)....[FO] (\S+)\t\w+ (\w+)", line)
            if found is not None:
                made.sections[found[4]] = found[3], int(found[1], 16)
                if found[2] == " w":
                    made.own.add(found[4])
        return made

    def _with_weak(self, each: _Object, name: str, replaced: set[str]) -> Path:
        """Return the object with these names weak, and the others of its own local again."""
        made = self._folder / f"{name}.linked.o"
        options = [f"--localize-symbol={own}" for own in each.own - replaced]
        for one in replaced:
            section, offset = each.sections[one]
            options.append(f"--weaken-symbol={one}")
            options.append(f"--add-symbol=true_{one}={section}:{offset:#x},global")
        _run("objcopy", *options, each.file, made)
        return made

    def source_of(self, name: str) -> str:
        """Return the C file that defines a name; ValueError if none does, or several do."""
        file, _, last = name.rpartition(".")
        found = [
            source
            for source, each in self._objects.items()
            if last in each.sections and file in ("", source)
        ]
        if len(found) != 1:
            raise ValueError(f"{name} is in {', '.join(found) or 'no source'}")
        return found[0]


def pack(healthy: Path, library: Path, target: Path) -> Path:
    """Write the FMU `target`, which is `healthy` with another library, and return it."""
    with zipfile.ZipFile(healthy) as source, zipfile.ZipFile(target, "w") as archive:
        for name in source.namelist():
            if name.startswith("binaries/"):
                archive.write(library, name)
            elif name == "modelDescription.xml":
                archive.writestr(name, source.read(name))
    return target


def _run(*command: str | Path) -> str:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]}: {done.stderr}")
    return done.stdout
