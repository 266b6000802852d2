"""One check of the verification suite at one place, tried on many FMU files by one process."""

import ctypes
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import islice
from pathlib import Path
from random import Random
from typing import Any

from stickslip_native.named import native_law
from stickslip_verification.drive import workers
from stickslip_verification.drive.answer import Answer
from stickslip_verification.drive.fmu.archive import FmuFile
from stickslip_verification.drive.manners import MANNERS
from stickslip_verification.drive.other_runs import RUNS
from stickslip_verification.drive.probes import PROBES
from stickslip_verification.drive.stepping import NotApplicableError, run_case
from stickslip_verification.judge.checks import EXACT_CONTRACT
from stickslip_verification.judge.invariant_checks import applies
from stickslip_verification.model.run import Run
from stickslip_verification.run.baseline import Baseline, Trial, trials
from stickslip_verification.run.judged import Answers, judge
from stickslip_verification.suite.cases import CASES_FOLDER, load_case
from stickslip_verification.suite.invariants import Invariants, load_invariants
from stickslip_verification.suite.sequences import SEED, draw_sequences
from tests.native.bits import STRIBECK, bits, draw_stribeck, sequence
from tests.native.core import Core
from tests.native.fuzz.damage import taken
from tests.native.fuzz.player import findings, opened, serialized

_NO_REFERENCE: Answer[Run] = Answer(not_applicable="the FMU alone is judged")
_SECONDS = 60.0

CASES = Path(__file__).parent / "cases"
"""Cases of these tests, beside those of the suite."""


class Suite:
    """Tries checks on FMU files; a crash of one costs its process and nothing else.

    Use it in a ``with`` block, which ends the process.
    """

    def __init__(self) -> None:
        self._pool = workers.Pool(1, _SECONDS)

    def __enter__(self) -> "Suite":
        self._pool.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        self._pool.__exit__(*error)

    def failing(self, fmu: Path, check: str, place: str) -> list[str]:
        """Return what fails of a check, each with its number or reason; none if the FMU is sound.

        Parameters
        ----------
        fmu
            The FMU file.
        check
            The id of a check or an invariant.
        place
            The id of a case of the suite or of these tests, ``"12 sequences"`` of Coulomb's law, or
            "" for a probe.
        """
        wanted = _invariants().only({check})
        some: list[Baseline] = []
        tried: Sequence[Trial] = ()
        if place.endswith(" sequences"):
            tried = _trials(check, int(place.split()[0]))
        elif place:
            some = [_baseline(place, check)]
        cases = [each.case for each in some]
        plain = self._ask(fmu, _plain, [(case,) for case in cases])
        kinds = [(case, each.run) for case in cases for each in wanted.runs]
        runs = self._ask(fmu, _other, kinds)
        in_manner = [(each.baseline.case, each.manner.manner) for each in tried]
        probes = self._ask(fmu, _probe, [(each.probe, each.arguments) for each in wanted.probes])
        answers = Answers(
            plain={case.id: answer for case, answer in zip(cases, plain, strict=True)},
            runs={(case.id, run): each for (case, run), each in zip(kinds, runs, strict=True)},
            probes={each.id: one for each, one in zip(wanted.probes, probes, strict=True)},
            sequences=self._ask(fmu, _in_manner, in_manner),
        )
        results = [
            each
            for each in judge(some, wanted, answers, EXACT_CONTRACT, tried, reference=False)
            if each.check == check
        ]
        assert results, f"{check} is not tried in {place or 'a probe'}"
        return [f"{each.case}: {each.failure or each.got}" for each in results if each.failed]

    def differing(self, library: Path, count: int, law: str) -> list[str]:
        """Return where a library first differs from the Python block in so many sequences."""
        return self._told(_differing, library, count, law)

    def call_sequences(self, folder: Path, guid: str, count: int) -> list[str]:
        """Return the first objection in so many random sequences of calls to an unpacked FMU."""
        return self._told(_call_sequences, folder, guid, count)

    def damaged_states(self, folder: Path, guid: str) -> list[str]:
        """Return which damaged states an unpacked FMU takes."""
        return self._told(_damaged_states, folder, guid)

    def states(self, folder: Path, guid: str, count: int) -> list[bytes]:
        """Return the serialized states of so many random sequences of an unpacked FMU."""
        answer: Answer[list[bytes]]
        (answer,) = self._pool.each(_states, [(folder, guid, count)])
        assert answer.value is not None, answer.failure
        return answer.value

    def texts(self, library: Path) -> list[str]:
        """Return numbers whose text is not that of Python."""
        return self._told(_texts, library)

    def _told(self, task: Any, *arguments: Any) -> list[str]:
        answer: Answer[Any]
        (answer,) = self._pool.each(task, [arguments])
        assert not answer.late, answer.failure
        if answer.failure is not None:
            # Anything else is a mistake of the tests.
            assert answer.failure.startswith(("AssertionError", "the process ")), answer.failure
            return [answer.failure]
        assert answer.value is not None
        found: list[str] = answer.value
        return found

    def _ask(self, fmu: Path, task: Any, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        asked = [(fmu, task, *each) for each in arguments]
        answers = list(self._pool.each(_on, asked))
        assert not any(answer.late for answer in answers), fmu
        return answers


@cache
def _invariants() -> Invariants:
    return load_invariants()


@cache
def _baseline(case_id: str, check: str) -> Baseline:
    folders = (CASES_FOLDER, CASES)
    (file,) = (each for folder in folders for each in folder.glob(f"{case_id}.toml"))
    case = load_case(file)
    exact = workers.exact(case)
    assert exact.value is not None, exact.failure
    holding = [
        each for each in _invariants().only({check}).residuals if applies(each, case, exact.value)
    ]
    return Baseline(case, exact, _NO_REFERENCE, holding, ())


@cache
def _trials(manner: str, count: int) -> Sequence[Trial]:
    drawn = [each.case for each in draw_sequences(SEED, count)]
    return trials(drawn, _invariants().only({manner}).sequences, jobs=1, nearby=False)


def _on(fmu: Path, task: Any, *arguments: Any) -> Answer[Any]:
    return _answer(lambda: task(FmuFile(fmu), *arguments))


def _answer(function: Callable[[], Any]) -> Answer[Any]:
    try:
        return Answer(function())
    except NotApplicableError as error:
        return Answer(not_applicable=str(error))
    except Exception as error:
        return Answer(failure=f"{type(error).__name__}: {error}")


def _plain(file: FmuFile, case: Any) -> Run:
    return run_case(file, case)


def _other(file: FmuFile, case: Any, run: str) -> Run:
    return RUNS[run](file, case)


def _in_manner(file: FmuFile, case: Any, manner: str) -> Run:
    return MANNERS[manner](file, case)


def _probe(file: FmuFile, probe: str, arguments: Any) -> list[str]:
    return PROBES[probe](file, **arguments)


def _differing(library: Path, count: int, law: str) -> Answer[list[str]]:
    return _answer(lambda: list(islice(_differences(library, count, law), 1)))


def _differences(library: Path, count: int, law: str) -> Iterator[str]:
    spec = native_law(law).spec
    core = Core(library, spec)
    how: Any = (draw_stribeck, STRIBECK) if law == "stribeck" else ()
    for seed in range(count):
        for step, (expected, given) in enumerate(sequence(core, spec, seed, *how)):
            both = expected is not None and given is not None
            if (bits(expected or []) != bits(given or [])) if both else expected is not given:
                yield f"seed {seed}, step {step}: {given}, not {expected}"


def _call_sequences(folder: Path, guid: str, count: int) -> Answer[list[str]]:
    return _answer(lambda: findings(opened(folder, guid), range(count), Counter()))


def _damaged_states(folder: Path, guid: str) -> Answer[list[str]]:
    return _answer(lambda: taken(opened(folder, guid)))


def _states(folder: Path, guid: str, count: int) -> Answer[list[bytes]]:
    return _answer(lambda: serialized(opened(folder, guid), range(count)))


def _texts(library: Path) -> Answer[list[str]]:
    def found() -> list[str]:
        number_text = ctypes.CDLL(str(library)).number_text
        number_text.argtypes = [ctypes.c_double, ctypes.c_char_p]
        text = ctypes.create_string_buffer(48)
        random = Random(1)
        values = [2.0**n for n in range(-1074, 1024)]
        values += [random.uniform(0.0, 10.0) * 10.0 ** random.randint(-30, 30) for _ in range(300)]
        wrong = []
        for value in values:
            number_text(value, text)
            if text.value.decode() != repr(value):
                wrong.append(f"{text.value.decode()}, not {value!r}")
        return wrong

    return _answer(found)
