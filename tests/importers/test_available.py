"""An importer that is missing is no reason to pass."""

from __future__ import annotations

import pytest

from tests.importers import available


@pytest.fixture(autouse=True)
def _no_fmpy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(available._PACKAGES, "fmpy", "no_such_package")


def test_a_missing_importer_fails_in_ci(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where CI is set, a test that needs it fails and says what to install."""
    monkeypatch.setenv("CI", "true")
    with pytest.raises(pytest.fail.Exception, match="pip install"):
        available.need("fmpy")


def test_a_missing_importer_is_skipped_elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a machine without it the test is skipped, for the reason that it gives."""
    monkeypatch.delenv("CI", raising=False)
    with pytest.raises(pytest.skip.Exception, match="NOT TRIED IN fmpy: no package"):
        available.need("fmpy")
