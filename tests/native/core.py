"""The native block without FMI: compiled with the machine's compiler, called through ctypes."""

import ctypes as c
from collections.abc import Iterable, Mapping
from pathlib import Path

from stickslip_native.named import HOME, native_law
from stickslip_native.table import table_files
from tests.native.compiling import run, written

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared")
ACCEPTED = 0


def sources(law: str) -> dict[str, bytes]:
    spec, own, _ = native_law(law)
    made = {name: text.encode() for name, text in table_files(spec).items()}
    return made | {file.name: file.read_bytes() for file in (*HOME.glob("core/*.[ch]"), *own)}


def compile_core(folder: Path, law: str = "coulomb", flags: Iterable[str] = ()) -> Path:
    library = folder / "core.so"
    run("cc", *FLAGS, *flags, *written(sources(law), folder), "-o", library, "-lm")
    return library


class Core:
    def __init__(self, library: Path, law: str = "coulomb") -> None:
        self.spec = native_law(law).spec
        self.outputs = [row.number for row in self.spec.table.rows if not row.settable]
        self.calls = core = c.CDLL(str(library))
        core.block_size.restype = c.c_size_t
        core.block_start.argtypes = [c.c_void_p, c.POINTER(c.c_double), c.c_double]
        core.block_set.argtypes = [c.c_void_p, c.c_int, c.c_double]
        core.block_set.restype = None
        core.block_advance.argtypes = [c.c_void_p, c.c_double, c.c_double]
        core.block_read.argtypes = [c.c_void_p, c.c_int, c.POINTER(c.c_double)]
        core.block_save.restype = None
        core.exact_sum.restype = c.c_double
        self.size = core.block_size()


class NativeBlock:
    """One native block.

    Attributes
    ----------
    refused
        What the last call returned: ACCEPTED, or the number of the refusal.
    """

    def __init__(self, core: Core, values: Mapping[str, float], start_time: float = 0.0) -> None:
        self._core, self._rows = core, core.spec.table.by_name
        self._block = c.create_string_buffer(core.size)
        names = [row.name for row in core.spec.table.rows if row.settable]
        settings = (c.c_double * len(names))(*(values[name] for name in names))
        self.refused: int = core.calls.block_start(self._block, settings, start_time)

    def set(self, name: str, value: float) -> None:
        self._core.calls.block_set(self._block, self._rows[name].number, value)
        self.refused = self._core.calls.block_check(self._block)

    def advance(self, time: float, step: float) -> None:
        self.refused = self._core.calls.block_advance(self._block, time, step)

    def outputs(self) -> list[float]:
        value, values = c.c_double(), []
        for reference in self._core.outputs:
            read = self._core.calls.block_read(self._block, reference, c.byref(value))
            self.refused = self.refused or read
            values.append(value.value)
        return values

    def remake(self) -> None:
        # A saved state is shorter than a block.
        saved = c.create_string_buffer(self._core.size)
        self._core.calls.block_save(self._block, saved)
        self.refused = self._core.calls.block_restore(self._block, saved)
