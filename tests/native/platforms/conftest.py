"""What the tests of the platforms share: one FMU of each FMI version, for all platforms.

What they measure is printed at the end of the run.
"""

from pathlib import Path

import pytest

from stickslip_native import packer

LINES = pytest.StashKey[list[str]]()


@pytest.fixture(scope="session")
def all_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 2.0 for all platforms."""
    return packer.build(tmp_path_factory.mktemp("all"))


@pytest.fixture(scope="session")
def all3_path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the native FMU 3.0 for all platforms."""
    return packer.build(tmp_path_factory.mktemp("all3"), face=3)


@pytest.fixture(scope="session")
def report(pytestconfig: pytest.Config) -> list[str]:
    """Give the list of lines that are printed at the end."""
    return pytestconfig.stash.setdefault(LINES, [])


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Print what was measured."""
    terminalreporter.section("platforms of the native FMU")
    for each in config.stash.get(LINES, []):
        terminalreporter.write_line(each)
