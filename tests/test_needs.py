"""What a machine may lack is found by trying, and told with the line that installs it."""

from functools import partial
from pathlib import Path

import pytest

from tests import needs

NPM = r"npm error network.*apt-get install nodejs npm$"
ARM = r"ld-linux-aarch64\S+: no.*apt-get install qemu-user libc6-arm64-cross$"


@pytest.mark.parametrize(
    ("in_ci", "outcome"), [(True, pytest.fail.Exception), (False, pytest.skip.Exception)]
)
def test_what_is_missing_skips_a_test_and_fails_it_in_ci(
    monkeypatch: pytest.MonkeyPatch, in_ci: bool, outcome: type[BaseException]
) -> None:
    trial = partial(needs._python, "import no_such_package", "page")
    monkeypatch.setitem(needs.NEEDS, "lost", needs.Need("the lost", trial))
    monkeypatch.setenv("CI", "true" if in_ci else "")
    reason = r"NOT TRIED: the lost\. ModuleNotFoundError: .*no_such_package.*'\.\[page\]'"
    with pytest.raises(outcome, match=reason):
        needs.require(["lost"])
    needs.lacking.cache_clear()


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("import ctypes\nctypes.CDLL('libno.so.12')", r"OSError: libno.*apt-get install libno12$"),
        ("import os; os.abort()", r"os\.abort\(\): exit code -6"),
    ],
)
def test_a_library_of_the_system_that_does_not_load_is_told(program: str, reason: str) -> None:
    with pytest.raises(needs.LackingError, match=reason):
        needs._python(program, "importers", "libno12")


@pytest.mark.parametrize(
    ("need", "programs", "script", "missing", "broken"),
    [
        (needs._compiler, ["cc"], "stdio.h: no", r"no program cc", r"cc: stdio\.h: no.*libc6-dev$"),
        (
            needs._typescript,
            ["node", "npx"],
            "npm error network",
            "no program node and no npx",
            NPM,
        ),
        (needs._qemu, ["qemu-aarch64"], "$3: no", r"no program qemu-aarch64", ARM),
    ],
    ids=["compiler", "node", "emulator"],
)
def test_a_program_must_be_there_and_work(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    need: partial[None],
    programs: list[str],
    script: str,
    missing: str,
    broken: str,
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(needs.LackingError, match=missing):
        need()
    for name in programs:
        (tmp_path / name).write_text(f'#!/bin/sh\necho "{script}" >&2\nexit 1\n', encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    with pytest.raises(needs.LackingError, match=broken):
        need()
