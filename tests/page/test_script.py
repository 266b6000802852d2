"""The types that the page's script declares: its model knows no browser."""

import subprocess

import pytest

from tests.needs import ROOT, TSC, needs


@needs("typescript")
@pytest.mark.parametrize("folder", [".", "model"])
def test_every_name_and_argument_is_of_the_declared_type(folder: str) -> None:
    # The model with the strict rules, and without a browser's names.
    project = ROOT / "workbench" / "stickslip" / "page" / folder
    done = subprocess.run(
        [*TSC, "--project", "."], cwd=project, capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.returncode) == ("", 0), done.stderr
