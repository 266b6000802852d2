"""What came out for a series of machines, as a page that asks for nothing outside itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
from markupsafe import Markup

from stickslip_fmu.release import VERSION
from stickslip_verification.report.files import environment, text_of
from stickslip_verification.report.svg import STYLE, as_part

from ..report.record import plain
from . import words
from .pictures import PICTURES, picture
from .result import Scatter

_HERE: Final = Path(__file__).parent
_STYLES: Final = _HERE.parent / "report" / "templates"


def html(found: Scatter) -> str:
    """Return the page; the same answer gives the same text."""
    asked = found.question
    with mpl.rc_context(STYLE):
        pictures = [
            Markup(as_part(drawn, name, f"Scatter: {name}"))
            for name in PICTURES
            if (drawn := picture(found, [name])) is not None
        ]
    return environment(_HERE / "templates").get_template("scatter.html.j2").render(
        name=asked.population.file.axis().name,
        sentences=list(words.sentences(found)),
        pictures=pictures,
        feeds=words.feeds(found),
        parts=words.parts(found),
        numbers=words.numbers(found),
        correlations=words.correlations(found),
        count=asked.count,
        seed=asked.population.seed,
        version=VERSION,
        digest=found.provenance["inputs_digest"],
        style=text_of("report.css", _STYLES),
    )  # fmt: skip


def data(found: Scatter) -> dict[str, Any]:
    """Return the answer without the machines as what JSON knows; SI."""
    asked = found.question
    return {
        "about": "How likely an axis jumps where its numbers vary; SI units",
        "sentences": list(words.sentences(found)),
        "samples": asked.count,
        "feeds": plain(found.outcomes),
        "clamped": found.clamped,
        "sobol": {
            "numbers": list(asked.population.varied),
            "results": plain(found.indices),
        },
        "solved": plain(found.solved),
        "varied": plain(asked.population.varied),
        **found.provenance,
    }
