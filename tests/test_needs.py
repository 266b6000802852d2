"""What a machine may lack: found by trying, told with the line that installs it."""

import re
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests import bare, needs
from tests.importers.running import IMPORTERS, INSIDE


@pytest.fixture
def _lost(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Add a need that is never met."""
    trial = partial(needs._python, "import no_such_package", "page")
    monkeypatch.setitem(needs.NEEDS, "lost", needs.Need("the lost", trial))
    yield
    needs.lacking.cache_clear()


REASON = r"NOT TRIED: the lost\. ModuleNotFoundError: .*no_such_package.*pip install '\.\[page\]'"


@pytest.mark.usefixtures("_lost")
def test_what_is_missing_fails_in_ci(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where CI is set, a test that needs it fails, and says what installs it."""
    monkeypatch.setenv("CI", "true")
    with pytest.raises(pytest.fail.Exception, match=REASON):
        needs.require(["lost"])


@pytest.mark.usefixtures("_lost")
def test_what_is_missing_is_skipped_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a person's machine the test is skipped, for the same reason."""
    monkeypatch.delenv("CI", raising=False)
    with pytest.raises(pytest.skip.Exception, match=REASON):
        needs.require(["lost"])


def test_what_works_is_not_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    """A trial that ends well lets the test run."""
    there = needs.Need("what is there", partial(needs._python, "import json", "page"))
    monkeypatch.setitem(needs.NEEDS, "there", there)
    needs.require(["there"])


def test_a_library_of_the_system_is_told_by_its_package() -> None:
    """Python code that is there and cannot load a library asks for the package of Debian."""
    program = "import ctypes\nctypes.CDLL('libnone.so.12')"
    with pytest.raises(needs.LackingError, match=r"OSError: libnone.*apt-get install libnone12$"):
        needs._python(program, "importers", "libnone12")


def test_a_program_that_crashes_is_told() -> None:
    """A trial that ends without a word is a failure with its exit code."""
    with pytest.raises(needs.LackingError, match=r"os\.abort\(\): exit code -6"):
        needs._python("import os; os.abort()", "importers")


def test_a_compiler_must_compile(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Neither an empty PATH nor a cc that refuses a host of five lines is a compiler."""
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(needs.LackingError, match=r"no program cc.*apt-get install gcc libc6-dev"):
        needs._compiler()
    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\necho stdio.h: no such file >&2\nexit 1\n", encoding="utf-8")
    broken.chmod(0o755)
    with pytest.raises(needs.LackingError, match=r"cc: stdio\.h: no such file"):
        needs._compiler()


def test_a_types_checker_must_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Neither an empty PATH nor an npx that gets no compiler is a checker of types."""
    monkeypatch.setenv("PATH", str(tmp_path))
    install = r"apt-get install nodejs npm$"
    with pytest.raises(needs.LackingError, match=rf"no program node and no npx.*{install}"):
        needs._typescript()
    for name in ("node", "npx"):
        broken = tmp_path / name
        broken.write_text("#!/bin/sh\necho npm error network >&2\nexit 1\n", encoding="utf-8")
        broken.chmod(0o755)
    with pytest.raises(needs.LackingError, match=rf"npx: npm error network.*{install}"):
        needs._typescript()


def test_an_emulator_must_start(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Neither an empty PATH nor a qemu without the C library of ARM64 runs anything for ARM64."""
    monkeypatch.setenv("PATH", str(tmp_path))
    install = r"apt-get install qemu-user libc6-arm64-cross$"
    with pytest.raises(needs.LackingError, match=rf"no program qemu-aarch64.*{install}"):
        needs._qemu()
    broken = tmp_path / "qemu-aarch64"
    broken.write_text("#!/bin/sh\necho $3: no such file >&2\nexit 1\n", encoding="utf-8")
    broken.chmod(0o755)
    with pytest.raises(needs.LackingError, match=rf"ld-linux-aarch64\S+: no such file.*{install}"):
        needs._qemu()


def test_libpython_can_be_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    """With its environment variable set, the shared libpython is missing for proxyfmu as well."""
    monkeypatch.setenv(needs.HIDDEN_LIBPYTHON, "1")
    monkeypatch.setattr(needs, "_ecospy", lambda: None)
    for trial in (needs._libpython, needs._proxyfmu):
        with pytest.raises(needs.LackingError, match=r"apt-get install libpython3\.\d+$"):
            trial()


def test_what_nobody_knows_cannot_be_needed() -> None:
    """A misspelt need is refused where the tests are collected."""
    with pytest.raises(AssertionError, match="ecos"):
        needs.needs("ecos")


@pytest.mark.parametrize("importer", IMPORTERS)
def test_an_importer_beyond_the_core_is_a_need(importer: str) -> None:
    """An importer has a need exactly if it imports more than FMPy and NumPy."""
    text = (INSIDE / f"by_{importer}.py").read_text(encoding="utf-8")
    packages = set(re.findall(r"^(?:from|import) (\w+)", text, re.MULTILINE))
    beyond = packages - sys.stdlib_module_names - {"fmpy", "numpy"}
    assert bool(beyond) == (importer in needs.NEEDS), beyond


def test_values_of_a_parameter_bear_the_mark() -> None:
    """What may be missing is marked with its need; FMPy comes with the core."""
    plain, marked = needs.each(["fmpy", "ecospy"])
    assert plain == "fmpy"
    assert isinstance(marked, type(pytest.param()))
    assert [mark.args for mark in marked.marks] == [("ecospy",)]


def test_a_bare_machine_lacks_compilers_browsers_and_node_alone() -> None:
    """Whatever their version and target, they are hidden, and nothing that has a similar name."""
    hidden = ("cc", "c99", "gcc", "gcc-12", "x86_64-linux-gnu-gcc-12", "clang", "chromium", "npx")
    assert all(map(bare.PROGRAMS.fullmatch, hidden))
    assert not any(map(bare.PROGRAMS.fullmatch, ("cat", "ccache", "c_rehash", "gccgo", "cpp")))


def test_a_skip_that_does_not_say_what_installs_it_is_no_reason() -> None:
    """What was not tried and the line for Debian must both be told."""
    told = f"NOT TRIED: {needs.NEEDS['ecospy'].untried}. OSError."
    assert bare.tells(f"{told} To install: apt-get install libtbb12", "ecospy")
    assert not bare.tells(told, "ecospy")
    assert not bare.tells(f"{told} To install: apt-get install libtbb12", "cc")
