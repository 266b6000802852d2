"""Faults in the C sources: each is detected by the check of the suite that was named in advance."""

import tomllib
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
from _pytest.mark import ParameterSet

from stickslip_native.packer import sources_of
from stickslip_verification.drive import FmuFile, processes
from stickslip_verification.drive.exact import exact_motion, kept
from stickslip_verification.drive.processes import Answer
from stickslip_verification.judge.checks import EXACT_CONTRACT, applies
from stickslip_verification.run.comparisons import compare
from stickslip_verification.run.experiment import (
    Baseline,
    Experiment,
    RandomTest,
    random_tests,
    run_all,
)
from stickslip_verification.suite.cases import CASES_FOLDER, load_case
from stickslip_verification.suite.invariants import load_invariants
from stickslip_verification.suite.sequences import SEED, draw_sequences
from tests.conftest import built
from tests.native.compiling import FLAGS, run, with_library, written
from tests.needs import needs
from tests.sharing import made_once

HERE = Path(__file__).parent
FAULTS: dict[str, dict[str, Any]] = tomllib.loads((HERE / "faults.toml").read_text())
CASES = HERE / "cases"
STRIBECK = {"band.c", "curve.c", "piece.c", "polynomial.c", "series.c", "smooth.c", "stribeck.c"}

pytestmark = needs("cc")


def kind_of(file: str) -> tuple[str, str]:
    return "native-3" if file == "fmi3.c" else "native-2", (
        "stribeck" if file in STRIBECK else "coulomb"
    )


@cache
def objects(kind: str, law: str) -> Path:

    def make(folder: Path) -> None:
        for file in written(sources_of(3 if kind == "native-3" else 2, law), folder):
            run("cc", *FLAGS, "-c", file, "-o", file.with_suffix(".o"))

    return made_once(f"objects-{kind}-{law}", make)


def faulty(edit: list[str], folder: Path) -> Path:
    file, *texts = edit
    kind, law = kind_of(file)
    healthy = objects(kind, law)
    text = (healthy / file).read_text()
    for sound, fault in zip(texts[::2], texts[1::2], strict=True):
        assert text.count(sound) == 1, f"{file} has {sound!r} {text.count(sound)} times"
        text = text.replace(sound, fault)
    (folder / file).write_text(text)
    planted = folder / "planted.o"
    run("cc", *FLAGS, f"-I{healthy}", "-c", folder / file, "-o", planted)
    others = [each for each in healthy.glob("*.o") if each.stem != Path(file).stem]
    run("cc", "-shared", "-Wl,-Bsymbolic", planted, *others, "-o", folder / "a.so", "-lm")
    return with_library(built(kind, law), folder / "a.so", folder / "faulty.fmu")


@cache
def baseline(case_id: str) -> Baseline:
    folder = CASES if case_id.startswith("speeds") else CASES_FOLDER
    case = load_case(folder / f"{case_id}.toml")
    exact = kept(exact_motion, case)
    holding = [each for each in load_invariants().residuals if applies(each, case, exact)]
    return Baseline(case, Answer(exact), invariants=holding)


@cache
def sequences(manner: str, count: int) -> list[RandomTest]:
    drawn = [each.case for each in draw_sequences(SEED, count)]
    return random_tests(drawn, load_invariants().only({manner}).sequences, jobs=1, numerical=False)


def failing(pool: processes.Pool, where: str) -> list[str]:
    check, _, place = where.partition(" in ")
    few = load_invariants().only({check})
    tried = sequences(check, int(place.split()[0])) if place.endswith("sequences") else []
    cases = [baseline(place)] if place and not tried else []
    runs = run_all(pool, Experiment(cases, few, EXACT_CONTRACT, tried))
    results = [each for each in compare(runs, reference=False) if each.check == check]
    assert results, f"{where}: there is no such check"
    return [f"{where}: {result.failure or result.got}" for result in results if result.failed]


def tiers() -> list[ParameterSet]:
    tried, values = set(), []
    for name, fault in FAULTS.items():
        check = fault["check"].partition(" ")[0]
        # The exact motion of friction over speed takes its time.
        soak = check in tried or fault["edit"][0] in STRIBECK
        tried |= set() if soak else {check}
        values.append(pytest.param(name, marks=pytest.mark.soak if soak else ()))
    return values


@pytest.mark.parametrize("name", tiers())
def test_a_fault_fails_the_check_that_fits(name: str, tmp_path: Path) -> None:
    fault = FAULTS[name]
    with processes.Pool(1, fmu=partial(FmuFile, faulty(fault["edit"], tmp_path))) as pool:
        assert failing(pool, fault["check"])


@pytest.mark.soak
@pytest.mark.parametrize(
    "kind", [("native-2", "coulomb"), ("native-3", "coulomb"), ("native-2", "stribeck")]
)
def test_the_sound_fmu_passes_all_of_them(kind: tuple[str, str]) -> None:
    places = {each["check"] for each in FAULTS.values() if kind_of(each["edit"][0]) == kind}
    with processes.Pool(1, fmu=partial(FmuFile, built(*kind))) as pool:
        assert [each for where in places for each in failing(pool, where)] == []
