"""`stickslip host`: the right libpython in a program that is not Python, and nothing else new."""

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from stickslip.errors import CommandError
from stickslip.host.elf import needed_libraries
from stickslip.host.launch import ask, find_library, prepare
from tests.interrupting import PROGRAM
from tests.needs import needs

from .running import Answer, Command

Fake = Callable[..., str]

LIBRARY_HEAD = b"\x7fELF\x02\x01\x01" + bytes(9) + b"\x03\x00\x3e\x00"
"""The first bytes of a shared library for x86-64 on Linux."""


def started(*arguments: str, **environment: str) -> Answer:
    """Run `stickslip host` in a process of its own, which becomes the command."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, "host", *arguments],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    return Answer(done.returncode, done.stdout, done.stderr)


@pytest.fixture
def fake(tmp_path: Path) -> Fake:
    """Return what makes an interpreter that describes itself as told; else it is this one."""

    def make(**told: Any) -> str:
        portrait = {
            "implementation": "cpython",
            "version": [3, 99, 0],
            "bits": 64,
            "home": [str(tmp_path / "home")] * 2,
            "library": str(tmp_path / "home" / "lib"),
            "build": dict.fromkeys(("LIBDIR", "INSTSONAME", "LDLIBRARY", "MULTIARCH", "LIBPL"), ""),
            **told,
        }
        (tmp_path / "portrait.json").write_text(json.dumps(portrait), encoding="utf-8")
        program = tmp_path / "python"
        program.write_text(
            "#!/bin/sh\n"
            f'case "$3" in *json*) cat {tmp_path}/portrait.json;; '
            f'*) exec {sys.executable} "$@";; esac\n',
            encoding="utf-8",
        )
        program.chmod(0o755)
        return str(program)

    return make


@needs("libpython")
def test_the_command_has_the_library_of_the_interpreter() -> None:
    """The program runs with the libpython of this interpreter's version in its memory."""
    answer = started("--", "cat", "/proc/self/maps")
    assert (answer.code, answer.err) == (0, "")
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    assert f"/libpython{version}" in answer.out


@needs("libpython")
def test_the_command_is_the_process() -> None:
    """Arguments, exit code and signals are the command's own."""
    answer = started("--", "sh", "-c", 'echo "$@"; exit 7', "-", "--show", "--", "a b")
    assert (answer.code, answer.out, answer.err) == (7, "--show -- a b\n", "")
    assert started("--", "sh", "-c", "kill -TERM $$").code == -signal.SIGTERM
    # Python ignores this one, and its children would too.
    assert started("--", "sh", "-c", "kill -PIPE $$").code == -signal.SIGPIPE


@needs("libpython")
def test_only_what_is_needed_is_set() -> None:
    """The environment gains LD_PRELOAD, in front of what was there, and nothing unasked for."""
    launch = prepare(["true"], None, {"PATH": os.environ["PATH"], "LD_PRELOAD": "libm.so.6"})
    library = str(find_library(ask(sys.executable)))
    assert launch.changes["LD_PRELOAD"] == f"{library}:libm.so.6"
    assert set(launch.changes) <= {"LD_PRELOAD", "PYTHONHOME"}
    again = prepare(["true"], None, {"LD_PRELOAD": f"{library} libm.so.6"})
    assert again.changes["LD_PRELOAD"] == f"{library}:libm.so.6"


@needs("libpython")
def test_the_line_shown_does_the_same(command: Command, tmp_path: Path) -> None:
    """--show starts nothing and prints a line for the shell, quoted where that is needed."""
    target = tmp_path / "a file"
    answer = command("host", "--show", "--", "cp", "/proc/self/environ", target)
    assert (answer.code, answer.err) == (0, "")
    assert not target.exists()
    subprocess.run(answer.out, shell=True, check=True)
    assert b"LD_PRELOAD=" in target.read_bytes()
    words = shlex.split(answer.out)
    assert words[0].startswith("LD_PRELOAD=/")
    assert words[-3:] == ["cp", "/proc/self/environ", str(target)]


def linked(folder: Path, *libraries: str) -> Path:
    """Compile a program that shows its LD_PRELOAD, linked to libraries that it does not use."""
    program = folder / "simulator"
    source = (
        "#include <stdio.h>\n#include <stdlib.h>\nint main(void)\n"
        '{ const char *set = getenv("LD_PRELOAD"); puts(set ? set : ""); return 3; }\n'
    )
    command = ["cc", "-x", "c", "-o", str(program), "-", "-Wl,--no-as-needed"]
    for library in map(Path, libraries):
        command += [f"-L{library.parent}", f"-l:{library.name}", f"-Wl,-rpath,{library.parent}"]
    subprocess.run(command, input=source, text=True, check=True)
    return program


@needs("cc", "libpython")
def test_a_program_with_a_libpython_of_its_own_is_left_alone(tmp_path: Path) -> None:
    """Linked to the shared libpython it is started as it is, and that is said in a line."""
    library = find_library(ask(sys.executable))
    program = linked(tmp_path, str(library))
    [own] = [each for each in needed_libraries(program) if each.startswith("libpython")]
    said = f"stickslip: {program} brings {own}: it is left alone, nothing is preloaded\n"
    answer = started("--", str(program))
    assert (answer.code, answer.out, answer.err) == (3, "\n", said)
    shown = started("--show", "--", str(program))
    assert (shown.code, shown.out, shown.err) == (0, f"{program}\n", said)


@needs("cc", "libpython")
def test_a_program_without_one_has_it_preloaded(tmp_path: Path) -> None:
    """Linked to another library the same program starts with the libpython, in silence."""
    program = linked(tmp_path)
    assert needed_libraries(program) == ("libc.so.6",)
    answer = started("--", str(program))
    assert (answer.code, answer.err) == (3, "")
    assert answer.out.startswith(str(find_library(ask(sys.executable))))


@needs("libpython")
def test_what_the_interpreter_itself_starts_has_the_library() -> None:
    """The chosen interpreter, linked to its libpython or not, hands it on to its processes."""
    program = "import subprocess; subprocess.run(['sh', '-c', 'echo $LD_PRELOAD'])"
    answer = started("--", sys.executable, "-c", program)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith(str(find_library(ask(sys.executable))))


def test_what_is_no_program_is_linked_to_nothing(tmp_path: Path) -> None:
    """A script, a missing file, and a program that is cut off anywhere name no libraries."""
    script = tmp_path / "script"
    script.write_text("#!/bin/sh\n", encoding="utf-8")
    assert needed_libraries(script) == needed_libraries(tmp_path / "missing") == ()
    whole = Path(shutil.which("sh") or "").read_bytes()
    cut = tmp_path / "cut"
    for size in (10, 63, 64, 100, 700, 1000):
        cut.write_bytes(whole[:size])
        assert needed_libraries(cut) == ()


def test_without_a_command_it_says_what_to_give(command: Command) -> None:
    """Nothing to start is wrong use, told in a line."""
    for arguments in ([], ["--"], ["--show"]):
        answer = command("host", *arguments)
        assert (answer.code, answer.err.count("\n")) == (2, 1)
        assert "stickslip host -- COMMAND" in answer.err


@needs("libpython")
def test_what_cannot_be_started_ends_as_in_a_shell(tmp_path: Path) -> None:
    """127 for a command that is not there, 126 for one that is no program; one line each."""
    plain = tmp_path / "plain"
    plain.write_text("no program", encoding="utf-8")
    missing, useless = started("--", "no-such-program"), started("--", str(plain))
    assert (missing.code, missing.err) == (
        127,
        "stickslip: no-such-program: No such file or directory\n",
    )
    assert (useless.code, useless.err) == (126, f"stickslip: {plain}: Permission denied\n")


def _other_python3(folder: Path) -> Mapping[str, str]:
    """Return an environment in which another installation of this version comes first."""
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    (folder / "bin").mkdir()
    (folder / "lib" / version / "lib-dynload").mkdir(parents=True)
    (folder / "lib" / version / "os.py").touch()
    program = folder / "bin" / "python3"
    program.write_text("#!/bin/sh\n", encoding="utf-8")
    program.chmod(0o755)
    return {"PATH": f"{folder}/bin:{os.environ['PATH']}"}


@needs("libpython")
def test_another_python_of_the_same_version_is_kept_out(tmp_path: Path) -> None:
    """A python3 on PATH lends its library to any CPython of its version; PYTHONHOME prevents it."""
    environment = _other_python3(tmp_path)
    launch = prepare(["true"], None, environment)
    home = launch.changes["PYTHONHOME"].split(":")
    assert {*home} == {sys.base_prefix, sys.base_exec_prefix}
    # The same process, as it starts in a host, with and without.
    start = ["python3", "-c", "import json, math, ssl"]
    for changes, expected in (
        (launch.changes, True),
        ({**launch.changes, "PYTHONHOME": ""}, False),
    ):
        done = subprocess.run(
            start,
            executable=shutil.which(sys.executable),
            env={**environment, **changes},
            capture_output=True,
            check=False,
        )
        assert (done.returncode == 0) == expected


@needs("libpython")
def test_pythonhome_is_the_users(tmp_path: Path) -> None:
    """Whoever has set PYTHONHOME keeps it."""
    environment = {**_other_python3(tmp_path), "PYTHONHOME": "/somewhere"}
    assert set(prepare(["true"], None, environment).changes) == {"LD_PRELOAD"}


@needs("libpython")
def test_a_python3_of_the_same_installation_needs_no_help(tmp_path: Path) -> None:
    """Where the first python3 on PATH is the interpreter itself, PYTHONHOME stays unset."""
    (tmp_path / "python3").symlink_to(Path(sys.executable).resolve())
    assert set(prepare(["true"], None, {"PATH": str(tmp_path)}).changes) == {"LD_PRELOAD"}


@pytest.mark.parametrize(
    ("told", "reason"),
    [
        ({"version": [3, 7, 16]}, "Python 3.7.16; the FMU needs 3.8 or later"),
        ({"bits": 32}, "Python 3.99.0 of 32 bit"),
        ({"implementation": "pypy"}, "pypy, not CPython"),
        ({}, "no shared library libpython3.99.so: install it (Debian, Ubuntu: "
             "apt-get install libpython3.99) or name another interpreter with --python"),
    ],
)  # fmt: skip
def test_an_interpreter_that_will_not_do_is_refused(
    fake: Fake, command: Command, told: Mapping[str, Any], reason: str
) -> None:
    """Too old, 32 bit, no CPython, none at all, built without a shared library: one line each."""
    answer = command("host", "--python", fake(**told), "--", "true")
    assert (answer.code, answer.err.count("\n")) == (2, 1)
    assert reason in answer.err


@pytest.mark.parametrize(
    ("folder", "content", "reason"),
    [
        (
            "lib",
            b"\x7fELF\x01\x01\x01" + bytes(9) + b"\x03\x00\x03\x00",
            "is no library for x86-64",
        ),
        ("lib", b"no library at all", "is no library for x86-64"),
        ("lib", LIBRARY_HEAD, "cannot be loaded: "),
        ("my lib", LIBRARY_HEAD, "a space or a colon in its path"),
    ],
)
def test_a_library_that_will_not_do_is_refused(
    fake: Fake, tmp_path: Path, folder: str, content: bytes, reason: str
) -> None:
    """Other processors, other files, damage, a path that LD_PRELOAD would cut: each is told."""
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "libpython3.99.so.1.0").write_bytes(content)
    build = dict.fromkeys(("INSTSONAME", "LDLIBRARY", "MULTIARCH", "LIBPL"), "")
    python = fake(build={**build, "LIBDIR": str(tmp_path / folder)})
    with pytest.raises(CommandError, match=r"no libpython3\.99\.so can be preloaded") as told:
        prepare(["true"], python, os.environ)
    assert reason in str(told.value)


@needs("libpython")
def test_a_library_of_another_version_is_refused(fake: Fake, tmp_path: Path) -> None:
    """The name of a file does not make it the library of that version."""
    (tmp_path / "libpython3.99.so").symlink_to(find_library(ask(sys.executable)))
    build = dict.fromkeys(("INSTSONAME", "LDLIBRARY", "MULTIARCH", "LIBPL"), "")
    python = fake(build={**build, "LIBDIR": str(tmp_path)})
    with pytest.raises(CommandError, match=f"is of Python {sys.version.split()[0]}"):
        prepare(["true"], python, os.environ)


@pytest.mark.parametrize(
    ("program", "reason"),
    [("python9", "there is no such program"), ("echo", "it does not answer as a Python 3 does")],
)
def test_what_is_no_interpreter_is_told(command: Command, program: str, reason: str) -> None:
    """--python with a name that nothing has, or that something else has: one line."""
    answer = command("host", "--python", program, "--", "true")
    assert (answer.code, answer.err) == (2, f"stickslip: --python {program}: {reason}\n")


def test_on_macos_there_is_no_binary_to_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the FMU has no binary, no library helps, and that is said."""
    monkeypatch.setattr(sys, "platform", "darwin")
    with pytest.raises(CommandError, match="no binary for macOS"):
        prepare(["true"], None, {})


def test_on_windows_the_folder_of_the_library_is_put_on_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """PATH begins with the folder of the interpreter, where its python3.dll is."""
    monkeypatch.setattr(sys, "platform", "win32")
    changes = prepare(["true"], None, {"PATH": "before"}).changes
    assert changes == {"PATH": f"{sys.base_prefix}{os.pathsep}before"}
