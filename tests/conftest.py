"""What all tests share: one FMU, built once, what they need beyond the core, and their size."""

import json
import os
import resource
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from multiprocessing.util import Finalize
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import pytest
from _pytest.mark import ParameterSet
from hypothesis import HealthCheck, settings

from stickslip_fmu import packer
from stickslip_native import packer as native_packer
from tests.driver import Host
from tests.needs import BY_PIP, needs, require
from tests.sharing import made_once

if TYPE_CHECKING:
    from playwright.sync_api import Browser

Sized = Callable[[int], int]

_BEGUN = pytest.StashKey[float]()
_COSTS: dict[str, float] = {}

# On a busy machine an example, or drawing it, may take long.
settings.register_profile(
    "busy", deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
settings.register_profile("soak", settings.get_profile("busy"), derandomize=False)
settings.load_profile("busy")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--gate", action="store_true", help="what the gate adds, too")
    parser.addoption("--soak", action="store_true", help="everything, at full size")


def pytest_configure(config: pytest.Config) -> None:
    """Give all processes of this run one folder for temporary files, removed at its end."""
    from stickslip_verification.drive.exact import FOLDER

    if config.getoption("soak"):
        settings.load_profile("soak")

    if hasattr(config, "workerinput"):
        return
    # The folders of fixtures outlive the run: what is in them explains a failure.
    os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", tempfile.gettempdir())
    folder = tempfile.mkdtemp(prefix="stickslip-tests-")
    # After multiprocessing, which removes its folder in there when this process ends.
    Finalize(None, shutil.rmtree, (folder, True), exitpriority=-200)
    os.environ["TMPDIR"] = tempfile.tempdir = folder
    kept = Path(folder) / "kept"
    kept.mkdir()
    if not os.environ.get(FOLDER):
        os.environ[FOLDER] = str(kept)


def pytest_itemcollected(item: pytest.Item) -> None:
    if "browser" in getattr(item, "fixturenames", ()):
        item.add_marker(needs("browser"))


def tier(item: pytest.Item) -> str:
    if item.get_closest_marker("soak"):
        return "soak"
    needed = {name for mark in item.iter_markers("needs") for name in mark.args}
    return "gate" if item.get_closest_marker("gate") or needed - BY_PIP else "test"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    soak, gate = config.getoption("soak"), config.getoption("gate")
    tiers = {"test", *(("gate", "soak") if soak else ("gate",) if gate else ())}
    left_out = [each for each in items if tier(each) not in tiers]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [each for each in items if tier(each) in tiers]


def _cpu() -> float:
    spent = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in spent)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    item.stash[_BEGUN] = _cpu()
    require(name for mark in item.iter_markers("needs") for name in mark.args)


def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> None:
    if call.when == "teardown":
        item.user_properties.append(("cpu", _cpu() - item.stash[_BEGUN]))


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    for name, value in report.user_properties:
        if report.when == "teardown" and name == "cpu":
            file = report.nodeid.partition("::")[0]
            _COSTS[file] = _COSTS.get(file, 0.0) + float(str(value))


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Print the CPU seconds by part, and leave those of each file for `tools/mutants.py`."""
    parts: dict[str, float] = {}
    for file, seconds in _COSTS.items():
        part = "/".join(file.split("/")[:2]) if file.count("/") > 1 else "tests"
        parts[part] = parts.get(part, 0.0) + seconds
    terminalreporter.section("CPU seconds, of processes that have ended")
    for part, seconds in sorted(parts.items(), key=lambda each: -each[1]):
        terminalreporter.line(f"{seconds:8.1f}  {part}")
    if costs := os.environ.get("STICKSLIP_COSTS"):
        Path(costs).write_text(json.dumps(_COSTS, indent=1) + "\n", encoding="utf-8")


@pytest.fixture(scope="session")
def sized(pytestconfig: pytest.Config) -> Sized:
    """Give what makes a full count that of this run: a tenth of it, with --soak all of it."""
    return int if pytestconfig.getoption("soak") else lambda full: full // 10


def thinned(values: Iterable[object], every: int) -> list[ParameterSet]:
    """Return values of a parameter, of which one of `every` few is not of full size."""
    return [
        pytest.param(each, marks=pytest.mark.soak if n % every else ())
        for n, each in enumerate(values)
    ]


KINDS = ("python-2", "native-2", "native-3")


@cache
def built(kind: str, law: str = "coulomb") -> Path:
    language, version = kind.split("-")
    face: Literal[2, 3] = 3 if version == "3" else 2
    solved = version == "2me"

    def make(folder: Path) -> None:
        if language == "python":
            packer.build(folder, law=law)
        else:
            native_packer.build(
                folder, face=face, this_machine=True, law=law, model_exchange=solved
            )

    return next(made_once(f"{kind}-{law}", make).glob("*.fmu"))


@pytest.fixture(scope="session")
def fmu_path() -> Path:
    return built("python-2")


def kinds(*names: str) -> list[ParameterSet]:
    return [
        pytest.param(name, marks=needs("cc") if name.startswith("native") else ())
        for name in names or KINDS
    ]


@pytest.fixture(params=kinds())
def fmu(request: pytest.FixtureRequest) -> Path:
    return built(request.param)


@pytest.fixture(scope="session")
def host() -> Iterator[Host]:
    host = Host()
    yield host
    host.end()


@pytest.fixture
def fresh_host() -> Iterator[Host]:
    host = Host()
    yield host
    host.end()


@pytest.fixture(scope="session")
def browser() -> Iterator["Browser"]:
    """Give a real browser, the only one of a process: Playwright cannot start a second."""
    # What it needs is an extra.
    from tests.page.browser import started

    with started() as browser:
        yield browser
