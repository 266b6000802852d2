"""The report as a PDF, with the extra named pdf."""

from importlib import import_module
from pathlib import Path
from typing import Any

from stickslip_verification.model.whole_file import write_whole


class PdfUnavailableError(RuntimeError):
    """What makes PDF is not installed; one line that tells what to install."""


def check_pdf() -> None:
    """Raise `PdfUnavailableError` if WeasyPrint, or a library that it needs, is not there."""
    _weasyprint()


def write_pdf(html: str, path: Path) -> None:
    """Write a rendered report as PDF, whole or not at all; nothing is fetched from anywhere.

    Raises
    ------
    PdfUnavailableError
        As `check_pdf`.
    """
    write_whole(path, _weasyprint().HTML(string=html, url_fetcher=_nothing).write_pdf())


def _weasyprint() -> Any:
    try:
        return import_module("weasyprint")
    except ImportError:
        raise PdfUnavailableError("no WeasyPrint here: pip install weasyprint") from None
    except OSError as error:
        library = str(error).splitlines()[0]
        raise PdfUnavailableError(
            f"WeasyPrint lacks a library of the system ({library}): on Debian "
            "apt-get install libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0"
        ) from None


def _nothing(url: str, *_: object, **__: object) -> None:
    raise ValueError(f"a report asks for nothing outside itself: {url}")
