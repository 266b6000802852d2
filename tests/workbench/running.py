"""The command, run as a person runs it."""

import sys
from pathlib import Path

import pytest

from stickslip import cli
from tests.interrupting import PROGRAM
from tests.python import run


class Answer:
    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err


class Command:
    """Runs the command in an empty folder; `fmu` is one built beforehand."""

    def __init__(
        self, patch: pytest.MonkeyPatch, capture: pytest.CaptureFixture[str], fmu: Path
    ) -> None:
        self._patch, self._capture, self._fmu = patch, capture, fmu

    def __call__(self, *arguments: object) -> Answer:
        self._patch.setattr(sys, "argv", ["stickslip", *map(str, arguments)])
        self._capture.readouterr()
        with pytest.raises(SystemExit) as ended:
            cli.main()
        said = self._capture.readouterr()
        code = ended.value.code
        assert isinstance(code, int)
        return Answer(code, said.out, said.err)

    def passes(self, *arguments: object) -> str:
        answer = self(*arguments)
        assert answer.code == 0, answer.err + answer.out
        return answer.out

    def refuses(self, *arguments: object) -> str:
        before = _files()
        answer = self(*arguments)
        assert (answer.code, answer.out) == (2, "")
        assert answer.err.startswith("stickslip: ")
        assert answer.err.count("\n") == 1
        assert _files() == before
        return answer.err

    def verify(self, *arguments: object) -> Answer:
        return self("verify", "--jobs", "1", *arguments)

    def simulate(self, engine: str, *arguments: object) -> Answer:
        of_fmu = ["--fmu", self._fmu] if engine == "fmu" else []
        return self("simulate", "--engine", engine, *of_fmu, *arguments)

    def in_fresh_process(self, *arguments: object) -> Answer:
        """Run `stickslip` in a process of its own: for what builds an FMU."""
        done = run(sys.executable, "-c", PROGRAM, *arguments)
        return Answer(done.returncode, done.stdout, done.stderr)


def _files() -> dict[Path, bytes]:
    return {file: file.read_bytes() for file in Path().rglob("*") if file.is_file()}
