"""The libraries of the native FMU on other platforms: a host in C, and calls as its input.

Linux ARM64 runs in `qemu-aarch64`; Windows in Wine, whose C runtime takes Microsoft's place.
"""

import math
import os
import random
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import fmpy

from fmi.table import Variable
from stickslip_fmu.spec import TABLE
from stickslip_native.compiler import FLAGS, compiler_for
from stickslip_native.platforms import PLATFORMS
from tests.fmu.blocks import log_uniform
from tests.native.bits import draw
from tests.needs import ARM_LIBRARIES, WINE
from tests.python import run

LINUX, ARM, WINDOWS = "x86_64-linux", "aarch64-linux", "x86_64-windows"
REALS = tuple(row for row in TABLE.rows if row.kind == "Real" and not row.settable)
TOLERANCE = 1e-11
"""Largest difference between platforms, as a part of the scale: see `Differences`.

Elementary functions of two C libraries differ in the last digit, 1e-16, and slips that follow each
other carry the difference on."""

_HERE = Path(__file__).parent
# The headers of the standard, which FMPy brings.
_HEADERS = Path(fmpy.__file__).parent / "c-code"
_EMULATORS = {LINUX: (), ARM: ("qemu-aarch64", "-L", ARM_LIBRARIES), WINDOWS: (WINE,)}
_LIMIT = 600.0
"""Seconds after which a process counts as hung; the longest takes 30."""
_FIXED = ("x_start", "x_dot_start", "z_start", "age_start")
_CHANGING = ("k", "c", "mu_s", "mu_k", "load", "v", "F_ext", "tau_s", "B", "t_0")
_SET_AT_START = ("m", "g", *_CHANGING, *_FIXED)
_START_STATE = {str(TABLE.by_name[name].number) for name in ("x_dot_start", "z_start")}


class Answer(NamedTuple):
    """The answer to a call: status and what was read as texts, and the messages before it."""

    status: int
    read: tuple[str, ...]
    messages: tuple[str, ...]


@dataclass(frozen=True)
class Machine:
    """The host on a platform with the FMU's library; an emulator before it where there is one."""

    command: tuple[str, ...]
    environment: Mapping[str, str]

    def answers(self, script: Sequence[str]) -> list[Answer]:
        """Make the calls in a new instance of the FMU, and return the answer to each."""
        calls = "\n".join(script) + "\n"
        done = run(*self.command, input=calls, env=self.environment, timeout=_LIMIT)
        assert (done.stderr, done.returncode) == ("", 0)
        found, messages = [], []
        for line in done.stdout.splitlines():
            if line.startswith("block "):
                messages.append(line)
                continue
            status, *read = line.split()
            found.append(Answer(int(status), tuple(read), tuple(messages)))
            messages = []
        assert len(found) == len(script)
        return found


def machine(name: str, fmu: Path, folder: Path, environment: Mapping[str, str]) -> Machine:
    """Compile the host for LINUX, ARM or WINDOWS into an empty folder, and return it."""
    (platform,) = (each for each in PLATFORMS if each.fmi3 == name)
    fmpy.extract(str(fmu), str(folder))
    host = folder / ("host.exe" if platform.system == "windows" else "host")
    # With the flags of the libraries the runtime of Windows is already in Zig's cache.
    words = [*compiler_for(this_machine=False).command, *FLAGS, "-target", platform.triple]
    words += ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-isystem", str(_HEADERS)]
    description = fmpy.read_model_description(str(fmu))
    face: Literal[2, 3] = 2 if description.fmiVersion == "2.0" else 3
    words += ["-o", str(host), str(_HERE / "host.c"), str(_HERE / f"face{face}.c")]
    subprocess.run([*words, *(["-ldl"] if platform.system == "linux" else [])], check=True)
    library = folder / "binaries" / platform.folders(face)[0] / f"StickSlip{platform.suffix}"
    identity = description.guid if face == 2 else description.instantiationToken
    return Machine(
        (*_EMULATORS[name], str(host), str(library), identity), {**os.environ, **environment}
    )


@contextmanager
def wine(folder: Path) -> Iterator[dict[str, str]]:
    """Make a Windows for Wine, 700 MB, in a new folder; give its variables."""
    ours = {"WINEPREFIX": str(folder), "WINEDEBUG": "-all"}
    variables = {**os.environ, **ours}
    server = str(Path(WINE).with_name("wineserver"))
    subprocess.run(
        [WINE, "wineboot", "-i"], env=variables, capture_output=True, timeout=_LIMIT, check=True
    )
    try:
        yield ours
    finally:
        # Ends the processes of this Windows alone.
        subprocess.run([server, "--kill", "--wait"], env=variables, timeout=_LIMIT, check=False)
        shutil.rmtree(folder)


def line(call: str, *words: object) -> str:
    """Return a call as the host takes it; numbers in hexadecimal, so that no digit is lost."""
    texts = (each.hex() if isinstance(each, float) else str(each) for each in words)
    return " ".join([call, *texts])


def set_values(values: Mapping[str, float]) -> str:
    pairs = ((TABLE.by_name[name].number, float(value)) for name, value in values.items())
    return line("set", *(word for pair in pairs for word in pair))


def _kind(row: Variable) -> str:
    return "enumeration" if row.type.items else row.kind.lower()


READ = tuple(
    line(kind, *(row.number for row in TABLE.rows if _kind(row) == kind and not row.settable))
    for kind in ("real", "integer", "enumeration", "boolean")
)
"""The calls that read every output."""


def start(values: Mapping[str, float], time: float) -> list[str]:
    return ["reset", set_values(values), line("setup", time), "enter", "exit"]


def sequence(seed: int, steps: int = 12) -> list[list[str]]:
    """Return the calls of a random sequence: of the start, then of each step, some refused."""
    random_ = random.Random(seed)
    values: dict[str, float] = dict(TABLE.start_values())
    for name in _SET_AT_START:
        values[name] = draw(random_, name, values)
    time = random_.choice((0.0, 1e3, -5.0))
    parts = [[*start({name: values[name] for name in _SET_AT_START}, time), *READ]]
    for _ in range(steps):
        calls = []
        if random_.random() < 0.4:
            changed = random_.sample(_CHANGING, random_.choice((1, 1, 2, 3)))
            for name in changed:
                values[name] = draw(random_, name, values)
            calls.append(set_values({name: values[name] for name in changed}))
        period = 2.0 * math.pi * math.sqrt(values["m"] / values["k"])
        step = period * log_uniform(random_, 1e-4, 30.0) if random_.random() < 0.996 else 0.0
        calls += [line("step", time, step), *READ]
        time += step
        if random_.random() < 0.2:
            # The detour leaves no trace.
            detour = ["save", line("step", time, 0.3 * period), *READ, "restore"]
            calls += [*detour, *READ]
        parts.append(calls)
    return parts


def neighbour(script: Sequence[str], random_: random.Random) -> list[str]:
    """Return the calls with start state and step lengths moved by a digit, unless 0."""
    calls = []
    for each in script:
        call, *words = each.split()
        if call == "step":
            words[1] = _moved(words[1], random_)
        elif call == "set":
            for n in range(0, len(words), 2):
                if words[n] in _START_STATE:
                    words[n + 1] = _moved(words[n + 1], random_)
        calls.append(" ".join([call, *words]))
    return calls


def _moved(word: str, random_: random.Random) -> str:
    value = float.fromhex(word)
    return math.nextafter(value, random_.choice((-math.inf, math.inf))).hex() if value else word


@dataclass
class Differences:
    """Values of two platforms; `largest` in parts of the largest one till then with that unit."""

    values: int = 0
    largest: float = 0.0
    same_events: bool = True
    same_messages: bool = True

    @property
    def small(self) -> bool:
        return self.same_events and self.largest <= TOLERANCE


def differences(
    script: Sequence[str], expected: Sequence[Answer], given: Sequence[Answer]
) -> Differences:
    found, scale = Differences(), {row.unit: 0.0 for row in REALS}
    for call, ours, theirs in zip(script, expected, given, strict=True):
        found.same_messages &= ours.messages == theirs.messages
        found.same_events &= ours.status == theirs.status
        if call != READ[0] or ours.status or theirs.status:
            found.same_events &= ours.read == theirs.read
            continue
        found.values += len(REALS)
        for row, *words in zip(REALS, ours.read, theirs.read, strict=True):
            one, other = map(float.fromhex, words)
            scale[row.unit] = max(scale[row.unit], abs(one))
            if one != other:
                # Infinite where the scale is 0.
                part = abs(one - other) / scale[row.unit] if scale[row.unit] else math.inf
                found.largest = max(found.largest, part)
    return found
