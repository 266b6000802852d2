"""The report on paper, and what is said where paper cannot be made."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from stickslip_verification.report.pdf import PdfUnavailableError, write_pdf
from tests.needs import needs


def test_without_weasyprint_one_line_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The extra is named, and no file is left."""
    monkeypatch.setitem(sys.modules, "weasyprint", None)
    with pytest.raises(PdfUnavailableError, match=r"pip install weasyprint") as told:
        write_pdf("<p>report", tmp_path / "report.pdf")
    assert "\n" not in str(told.value)
    assert not list(tmp_path.iterdir())


def test_a_library_that_the_system_lacks_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """WeasyPrint's own import fails with several lines; one is enough to act on."""

    def fail(name: str) -> object:
        raise OSError(f"cannot load library 'libpango-1.0-0' for {name}\nand more\nand more")

    monkeypatch.setattr("stickslip_verification.report.pdf.import_module", fail)
    with pytest.raises(PdfUnavailableError, match=r"libpango-1\.0-0.*apt-get install") as told:
        write_pdf("<p>report", tmp_path / "report.pdf")
    assert "\n" not in str(told.value)


def test_nothing_is_fetched_and_the_file_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page is printed from its text alone: whatever it names outside is refused."""

    class Html:
        def __init__(self, string: str, url_fetcher: object) -> None:
            self.string, self.fetch = string, url_fetcher

        def write_pdf(self) -> bytes:
            with pytest.raises(ValueError, match="nothing outside"):
                self.fetch("https://example.org/a.png")  # type: ignore[operator]
            return b"%PDF " + self.string.encode()

    monkeypatch.setitem(sys.modules, "weasyprint", SimpleNamespace(HTML=Html))
    write_pdf("<p>report", tmp_path / "new" / "report.pdf")
    assert (tmp_path / "new" / "report.pdf").read_bytes() == b"%PDF <p>report"


@needs("pdf")
def test_the_pdf_is_one(tmp_path: Path) -> None:
    """With WeasyPrint there, the file is a PDF."""
    write_pdf("<html lang='en'><title>t</title><p>report</p></html>", tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")
