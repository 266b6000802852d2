"""The types that the page's script declares: its model knows no browser."""

import pytest

from tests.needs import ROOT, TSC, needs
from tests.python import run


@needs("typescript")
@pytest.mark.parametrize("folder", [".", "model"])
def test_every_name_and_argument_is_of_the_declared_type(folder: str) -> None:
    # The model with the strict rules, and without a browser's names.
    project = ROOT / "workbench" / "stickslip" / "page" / folder
    done = run(*TSC, "--project", ".", cwd=project)
    assert (done.stdout, done.returncode) == ("", 0), done.stderr
