"""What some tests need beyond the packages of the core: asked here alone, by trying to use it.

A test says what it needs with ``@needs("ecospy", "cc")``; a parametrized one takes its values from
`each`. Where one of them cannot be used the test is skipped, and where the environment variable
``CI`` is set it fails. The reason says what is missing, what was not tried, and the line that
installs it. ``pytest -m needs`` selects the tests that ask, `tests.bare` runs them without all.
"""

import fcntl
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterable
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
HIDDEN_LIBPYTHON = "STICKSLIP_TESTS_WITHOUT_LIBPYTHON"
"""The environment variable with which the shared libpython counts as missing: an interpreter that
is linked to it cannot run where it is hidden."""

TSC = ("npx", "--yes", "--package", "typescript@6.0.3", "--", "tsc")
"""The command of TypeScript's compiler: its version is said here alone, npm gets and keeps it."""

PUPPETEER = ("npx", "--yes", "--package", "puppeteer-core@24.43.1", "--", "node")
"""The command of node with puppeteer-core, which drives Firefox by WebDriver BiDi: its version is
said here alone, npm gets and keeps it. Playwright drives no Firefox but its own."""

LIBPYTHON = Path(
    sysconfig.get_config_var("LIBDIR") or "", sysconfig.get_config_var("INSTSONAME") or ""
)
"""The shared library of this Python, if it has one."""

SMOKE = ROOT / "tests" / "page" / "firefox" / "smoke.js"
"""The script that drives Firefox."""

ARM_LIBRARIES = "/usr/aarch64-linux-gnu"
"""Folder with the C library of Linux ARM64: Debian's package libc6-arm64-cross."""

WINE = "/usr/lib/wine/wine64"
"""Wine for 64-bit programs: Debian has it off the PATH."""

_LIMIT = 120.0
"""Seconds after which a trial counts as hung; the longest takes two."""

# Its library is loaded when it is first used.
_START_LIBCOSIM = """\
from libcosimpy.CosimExecution import CosimExecution
CosimExecution.from_step_size(1_000_000)
"""
_START_A_BROWSER = """\
import axe_playwright_python
from tests.page.browser import started
with started() as browser:
    page = browser.new_page()
    page.set_content("<span>mm</span>")
    wide = page.locator("span").bounding_box()["width"]
    if not wide > 1.0:
        raise OSError("chromium has no font")
"""
_HOST_IN_C = "#include <dlfcn.h>\n#include <stdio.h>\nint main(void) { return 0; }\n"
_FUZZED_IN_C = """\
#include <stddef.h>
int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
    return (void)bytes, (void)size, 0;
}
"""


class LackingError(Exception):
    """Something cannot be used: the cause, and the line that installs it."""

    def __init__(self, cause: str, install: str) -> None:
        super().__init__(f"{cause}. To install: {install}")


class Need(NamedTuple):
    """What is not tried without it, and a trial, which raises `LackingError` where it fails."""

    untried: str
    trial: Callable[[], object]


def needs(*names: str) -> pytest.MarkDecorator:
    assert set(names) <= set(NEEDS), names
    return pytest.mark.needs(*names)


def each(names: Iterable[str]) -> list[object]:
    return [pytest.param(name, marks=needs(name)) if name in NEEDS else name for name in names]


def require(names: Iterable[str]) -> None:
    reasons = [reason for name in names if (reason := lacking(name)) is not None]
    if reasons and os.environ.get("CI"):
        pytest.fail("\n".join(reasons), pytrace=False)
    if reasons:
        pytest.skip("; ".join(reasons))


@cache
def lacking(name: str) -> str | None:
    need = NEEDS[name]
    try:
        need.trial()
    except LackingError as error:
        return f"NOT TRIED: {need.untried}. {error}"
    return None


def _run(install: str, *command: str, said: str = "", line: int = 0) -> None:
    """Run a command to exit code 0; of what it says else one line is the cause."""
    if shutil.which(command[0]) is None:
        raise LackingError(f"there is no program {command[0]}", install)
    done = subprocess.run(
        command, input=said, cwd=ROOT, capture_output=True, text=True, timeout=_LIMIT, check=False
    )
    if done.returncode != 0:
        cause = done.stderr.strip() or f"exit code {done.returncode}"
        raise LackingError(f"{Path(command[0]).name}: {cause.splitlines()[line]}", install)


def _python(extra: str, program: str, packages: str = "") -> None:
    """Run a program in a process of its own, so that what it loads stays out of this one.

    What is not there of Python comes with an extra of the project, what is not there of the
    system with packages of Debian.
    """
    of_debian = f" and apt-get install {packages}" if packages else ""
    _run(f"pip install '.[{extra}]'{of_debian}", sys.executable, "-c", program, line=-1)


def _libpython() -> None:
    package = "libpython{}.{}".format(*sys.version_info)
    if os.environ.get(HIDDEN_LIBPYTHON) or ".so" not in LIBPYTHON.name or not LIBPYTHON.is_file():
        raise LackingError(f"there is no {LIBPYTHON}", f"apt-get install {package}")


def _proxyfmu() -> None:
    _ecospy()
    _libpython()


def _compiler(install: str, host: str, program: str, *options: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        command = (program, *options, "-x", "c", "-o", f"{folder}/a", "-", "-ldl")
        _run(install, *command, said=host)


def _by_npm(*command: str) -> None:
    # Two processes that fetch it at once would disturb each other.
    with Path(__file__).open(encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        _run("apt-get install nodejs npm", *command, line=-1)


def firefox() -> str:
    found = shutil.which("firefox-esr") or shutil.which("firefox")
    if found is None:
        raise LackingError("there is no program firefox-esr", "apt-get install firefox-esr")
    return found


def _firefox() -> None:
    _by_npm(*PUPPETEER, str(SMOKE), firefox())


_ecospy = partial(_python, "importers", "import ecospy", "libtbb12")
_toolbox = partial(_python, "importers", "import fmu_manipulation_toolbox")
_GCC = "apt-get install gcc libc6-dev"
_CLANG = "apt-get install clang libclang-rt-14-dev"
_WINE64 = "apt-get install wine64"
_ARM = "apt-get install qemu-user libc6-arm64-cross"
_ARM_LOADER = f"{ARM_LIBRARIES}/lib/ld-linux-aarch64.so.1"

NEEDS = {
    "libcosimpy": Need(
        "the FMU in libcosim", partial(_python, "importers", _START_LIBCOSIM, "libatomic1")
    ),
    "ecospy": Need("the FMU in Ecos", _ecospy),
    "proxyfmu": Need("the FMU in proxyfmu", _proxyfmu),
    "fmucontainer": Need("the FMU in fmucontainer", _toolbox),
    "fmutool": Need("the FMU by fmutool -check", _toolbox),
    "cc": Need(
        "the FMU in a host written in C, an FMU written in C",
        partial(_compiler, _GCC, _HOST_IN_C, "cc"),
    ),
    "zig": Need("the native FMU for all platforms", partial(_python, "native", "import ziglang")),
    "qemu": Need(
        "the native FMU on Linux ARM64",
        # The loader of programs for ARM64, a program itself.
        partial(_run, _ARM, "qemu-aarch64", "-L", ARM_LIBRARIES, _ARM_LOADER, "--version"),
    ),
    "wine": Need("the native FMU on Windows", partial(_run, _WINE64, WINE, "--version")),
    # Its libraries are loaded before Python, so a clang that links them statically is of no use.
    "sanitizers": Need(
        "the native FMU under sanitizers",
        partial(_compiler, _GCC, _HOST_IN_C, "gcc", "-fsanitize=address,undefined"),
    ),
    "libfuzzer": Need(
        "random bytes as states of the native FMU",
        partial(_compiler, _CLANG, _FUZZED_IN_C, "clang", "-fsanitize=fuzzer"),
    ),
    "libpython": Need("the FMU in a program that is not Python", _libpython),
    "typescript": Need("the types of the page's script", partial(_by_npm, *TSC, "--version")),
    "browser": Need(
        "the page",
        partial(_python, "page", _START_A_BROWSER, "chromium fonts-dejavu-core fonts-dejavu-extra"),
    ),
    "firefox": Need("the page in Firefox", _firefox),
    "studies": Need(
        "files of maps, scatter and sweeps",
        partial(_python, "studies", "import pandas, pyarrow, xarray, zarr"),
    ),
    "cluster": Need("studies on a dask cluster", partial(_python, "cluster", "import distributed")),
}
"""Needs by name; importers have the names of `tests.importers.running.IMPORTERS`."""

BY_PIP = {"fmucontainer", "fmutool", "studies", "cluster"}
"""Needs that pip meets: their tests are of `make test`."""
