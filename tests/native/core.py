"""The native block without FMI: compiled with the machine's compiler, called through ctypes."""

import ctypes
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path

import stickslip_native
from stickslip_fmu.spec import SPEC, TABLE
from stickslip_native.table import table_files

CORE = Path(stickslip_native.__file__).parent / "core"
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
ACCEPTED = 0

OUTPUTS = [row.number for row in TABLE.rows if not row.settable]
_SETTABLE = [row.name for row in TABLE.rows if row.settable]


def compile_core(folder: Path, flags: Iterable[str] = (), compiler: str = "cc") -> Path:
    """Compile the core into a shared library in `folder`, with more flags, and return it."""
    for name, text in table_files(SPEC).items():
        (folder / name).write_text(text)
    library = folder / "core.so"
    sources = [*sorted(map(str, CORE.glob("*.c"))), str(folder / "table.c")]
    command = [compiler, *FLAGS, *flags, f"-I{CORE}", f"-I{folder}", *sources]
    subprocess.run([*command, "-o", str(library), "-lm"], check=True)
    return library


class Core:
    """The functions of the compiled core."""

    def __init__(self, library: Path) -> None:
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
        settings = (ctypes.c_double * len(_SETTABLE))(*(values[name] for name in _SETTABLE))
        self._value = ctypes.c_double()
        self.refused = core.calls.block_start(self._block, settings, start_time)

    def set(self, name: str, value: float) -> None:
        """Set an input or tunable parameter."""
        self._core.calls.block_set(self._block, TABLE.by_name[name].number, value)
        self.refused = self._core.calls.block_check(self._block)

    def advance(self, time: float, step: float) -> None:
        """Move on by one step."""
        self.refused = self._core.calls.block_advance(self._block, time, step)

    def outputs(self) -> list[float]:
        """Return all outputs in the order of their numbers."""
        values = []
        for reference in OUTPUTS:
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
