"""`stickslip host`: the right libpython in a program that is not Python, and nothing else new."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from stickslip.errors import CommandError
from stickslip.host.elf import needed_libraries
from stickslip.host.launch import ask, find_library, prepare
from tests.interrupting import PROGRAM
from tests.needs import needs
from tests.python import run


def host(*words: object) -> subprocess.CompletedProcess[str]:
    return run(sys.executable, "-c", PROGRAM, "host", *words)


@needs("libpython")
def test_the_command_is_the_process_with_libpython_in_front_of_what_is_preloaded() -> None:
    done = host("--", "sh", "-c", 'cat /proc/$$/maps; echo "$@"; exit 7', "-", "--show", "a b")
    assert (done.returncode, done.stderr) == (7, "")
    assert "/libpython{}.{}".format(*sys.version_info) in done.stdout
    assert done.stdout.endswith("--show a b\n")
    # Python ignores this signal, and its children would too.
    assert host("--", "sh", "-c", "kill -PIPE $$").returncode == -signal.SIGPIPE
    library = find_library(ask(sys.executable))
    changes = prepare(["true"], None, {**os.environ, "LD_PRELOAD": "libm.so.6"}).changes
    assert changes["LD_PRELOAD"] == f"{library}:libm.so.6"


@needs("cc", "libpython")
def test_a_program_that_is_linked_to_a_libpython_keeps_its_own(tmp_path: Path) -> None:
    library = find_library(ask(sys.executable))
    linked, plain = tmp_path / "linked", tmp_path / "plain"
    for program, words in (linked, [f"-L{library.parent}", f"-l:{library.name}"]), (plain, []):
        command = ["cc", "-x", "c", "-o", str(program), "-", "-Wl,--no-as-needed", *words]
        subprocess.run(command, input="int main(void) { return 3; }", text=True, check=True)
    shown = host("--show", "--", linked)
    assert (shown.returncode, shown.stdout) == (0, f"{linked}\n")
    assert "it is left alone, nothing is preloaded" in shown.stderr
    assert "LD_PRELOAD=/" in host("--show", "--", plain).stdout
    # A program that is cut off anywhere names no libraries.
    for size in (10, 63, 64, 100, 700, 1000):
        (tmp_path / "cut").write_bytes(plain.read_bytes()[:size])
        assert needed_libraries(tmp_path / "cut") == ()


@needs("libpython")
def test_pythonhome_is_set_where_another_python_of_the_version_comes_first(tmp_path: Path) -> None:
    version = "python{}.{}".format(*sys.version_info)
    (tmp_path / "bin").mkdir()
    (tmp_path / "lib" / version / "lib-dynload").mkdir(parents=True)
    (tmp_path / "lib" / version / "os.py").touch()
    (tmp_path / "bin" / "python3").write_text("#!/bin/sh\n", encoding="utf-8")
    (tmp_path / "bin" / "python3").chmod(0o755)
    environment = {"PATH": f"{tmp_path}/bin:{os.environ['PATH']}"}
    home = prepare(["true"], None, environment).changes["PYTHONHOME"].split(":")
    assert {*home} == {sys.base_prefix, sys.base_exec_prefix}
    of_the_user = {**environment, "PYTHONHOME": "/somewhere"}
    assert set(prepare(["true"], None, of_the_user).changes) == {"LD_PRELOAD"}
    (tmp_path / "python3").symlink_to(Path(sys.executable).resolve())
    assert set(prepare(["true"], None, {"PATH": str(tmp_path)}).changes) == {"LD_PRELOAD"}


@pytest.mark.parametrize(
    ("version", "implementation", "bits", "reason"),
    [
        ([3, 7, 16], "cpython", 64, r"Python 3\.7\.16; the FMU needs 3\.8 or later"),
        ([3, 99, 0], "cpython", 32, "of 32 bit"),
        ([3, 99, 0], "pypy", 64, "pypy, not CPython"),
        ([3, 99, 0], "cpython", 64, r"libpython3\.99\.so\.1\.0 is no library for x86-64"),
    ],
)
def test_an_interpreter_or_a_library_that_will_not_do_is_refused(
    version: list[int], implementation: str, bits: int, reason: str, tmp_path: Path
) -> None:
    (tmp_path / "libpython3.99.so.1.0").write_bytes(b"no library at all")
    build = dict.fromkeys(("INSTSONAME", "LDLIBRARY", "MULTIARCH", "LIBPL"), "")
    told = {"version": version, "implementation": implementation, "bits": bits, "home": ["", ""]}
    told |= {"library": "", "build": {**build, "LIBDIR": str(tmp_path)}}
    python = tmp_path / "python"
    python.write_text(f"#!{sys.executable}\nimport json\nprint(json.dumps({told!r}))\n", "utf-8")
    python.chmod(0o755)
    with pytest.raises(CommandError, match=reason):
        prepare(["true"], str(python), os.environ)


@pytest.mark.parametrize(
    ("words", "code", "reason"),
    [
        ([], 2, "stickslip host -- COMMAND"),
        (["--python", "python9", "--", "true"], 2, "--python python9: there is no such program"),
        (["--python", "echo", "--", "true"], 2, "it does not answer as a Python 3 does"),
        pytest.param(["--", "no-such-program"], 127, "No such file", marks=needs("libpython")),
        pytest.param(["--", "/etc/passwd"], 126, "Permission denied", marks=needs("libpython")),
    ],
)
def test_what_cannot_be_started_is_told_in_a_line(words: list[str], code: int, reason: str) -> None:
    done = host(*words)
    assert (done.returncode, done.stderr.count("\n")) == (code, 1)
    assert reason in done.stderr


def test_other_systems_have_no_binary_or_take_the_folder_of_python_on_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    changes = prepare(["true"], None, {"PATH": "before"}).changes
    assert changes == {"PATH": f"{sys.base_prefix}{os.pathsep}before"}
    monkeypatch.setattr(sys, "platform", "darwin")
    with pytest.raises(CommandError, match="no binary for macOS"):
        prepare(["true"], None, {})
