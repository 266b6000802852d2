"""The report of a verdict: a page, JSON, JUnit XML and PDF, byte-identical for identical input.

Names are resolved when they are first used: Jinja2 and matplotlib are loaded when a page is
rendered, WeasyPrint when a PDF is written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.report.html import render, write_report
    from stickslip_verification.report.json_file import as_json, write_json
    from stickslip_verification.report.junit import as_junit
    from stickslip_verification.report.packed import packed_report
    from stickslip_verification.report.pdf import PdfUnavailableError, check_pdf, write_pdf
    from stickslip_verification.report.plots import course_tolerances, draw_case
    from stickslip_verification.report.words import ClaimSection

_HOME = {
    "ClaimSection": "words",
    "PdfUnavailableError": "pdf",
    "as_json": "json_file",
    "as_junit": "junit",
    "check_pdf": "pdf",
    "course_tolerances": "plots",
    "draw_case": "plots",
    "packed_report": "packed",
    "render": "html",
    "write_json": "json_file",
    "write_pdf": "pdf",
    "write_report": "html",
}

__all__ = [
    "ClaimSection",
    "PdfUnavailableError",
    "as_json",
    "as_junit",
    "check_pdf",
    "course_tolerances",
    "draw_case",
    "packed_report",
    "render",
    "write_json",
    "write_pdf",
    "write_report",
]

__getattr__, __dir__ = face(__name__, _HOME)
