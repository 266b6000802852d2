"""The native block without FMI: compiled with the machine's compiler, called through ctypes."""

import ctypes
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path

from fmukit.model import Spec
from stickslip_fmu.spec import SPEC
from stickslip_native.named import HOME, LAWS, files_of
from stickslip_native.table import table_files

CORE = HOME / "core"
COULOMB = LAWS / "coulomb"
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
ACCEPTED = 0


def compile_core(
    folder: Path,
    flags: Iterable[str] = (),
    compiler: str = "cc",
    spec: Spec = SPEC,
    law: Path = COULOMB,
) -> Path:
    """Compile the core with a friction law into a shared library in `folder`, and return it.

    Parameters
    ----------
    folder
        Gets the table of `spec` as C too.
    flags
        More flags of the compiler.
    spec
        The specification of the block under the law, on the Python side.
    law
        Folder of the law.
    """
    for name, text in table_files(spec).items():
        (folder / name).write_text(text)
    library = folder / "core.so"
    files = [*files_of(law), *CORE.glob("*.c"), folder / "table.c"]
    folders = [*dict.fromkeys(file.parent for file in files)]
    sources = sorted(str(file) for file in files if file.suffix == ".c")
    command = [compiler, *FLAGS, *flags, *(f"-I{each}" for each in folders), *sources]
    subprocess.run([*command, "-o", str(library), "-lm"], check=True)
    return library


class Core:
    """The functions of the compiled core, and the table that it was compiled with."""

    def __init__(self, library: Path, spec: Spec = SPEC) -> None:
        self.table = spec.table
        self.outputs = [row.number for row in self.table.rows if not row.settable]
        core = ctypes.CDLL(str(library))
        pointer, real, reference = ctypes.c_void_p, ctypes.c_double, ctypes.c_int
        core.block_size.restype = ctypes.c_size_t
        core.block_start.argtypes = [pointer, ctypes.POINTER(real), real]
        core.block_set.argtypes = [pointer, reference, real]
        core.block_set.restype = None
        core.block_check.argtypes = [pointer]
        core.block_advance.argtypes = [pointer, real, real]
        core.block_read.argtypes = [pointer, reference, ctypes.POINTER(real)]
        core.block_save.argtypes = [pointer, pointer]
        core.block_save.restype = None
        core.block_restore.argtypes = [pointer, pointer]
        self.calls = core
        self.size = core.block_size()


class NativeBlock:
    """One native block.

    Parameters
    ----------
    core
        The compiled core.
    values
        The settings by name.
    start_time
        Start time [s].

    Attributes
    ----------
    refused
        What the last call returned: ACCEPTED, or the number of the refusal.
    """

    def __init__(self, core: Core, values: Mapping[str, float], start_time: float = 0.0) -> None:
        self._core = core
        self._block = ctypes.create_string_buffer(core.size)
        names = [row.name for row in core.table.rows if row.settable]
        settings = (ctypes.c_double * len(names))(*(values[name] for name in names))
        self._value = ctypes.c_double()
        self.refused = core.calls.block_start(self._block, settings, start_time)

    def set(self, name: str, value: float) -> None:
        """Set an input or tunable parameter."""
        self._core.calls.block_set(self._block, self._core.table.by_name[name].number, value)
        self.refused = self._core.calls.block_check(self._block)

    def advance(self, time: float, step: float) -> None:
        """Move on by one step."""
        self.refused = self._core.calls.block_advance(self._block, time, step)

    def outputs(self) -> list[float]:
        """Return all outputs in the order of their numbers."""
        values = []
        for reference in self._core.outputs:
            read = self._core.calls.block_read(self._block, reference, ctypes.byref(self._value))
            self.refused = self.refused or read
            values.append(self._value.value)
        return values

    def remake(self) -> None:
        """Take up the own saved state."""
        # A saved state is shorter than a block.
        saved = ctypes.create_string_buffer(self._core.size)
        self._core.calls.block_save(self._block, saved)
        self.refused = self._core.calls.block_restore(self._block, saved)
