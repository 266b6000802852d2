"""Where the pages of the report take their templates, style, script and texts from."""

import math
from pathlib import Path
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from stickslip_verification.model.margins import error_text, margin_of, value_text
from stickslip_verification.model.verdict import CheckResult, count
from stickslip_verification.report import words

_TEMPLATES: Final = Path(__file__).parent / "templates"


def environment(folder: Path = _TEMPLATES) -> Environment:
    """Return what renders the templates of a folder.

    A name that is missing is an error, text is escaped.
    """
    made = Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {
        "slug": lambda word: "-".join(str(word).lower().split()),
        "value": value_text,
        "error": error_text,
        "margin": lambda result: error_text(margin_of(result)),
        "farthest": lambda results: max(results, key=used, default=None),
        "counts": count,
        "measure": words.measure,
        "story": words.story,
        "places": words.places,
        "slope": lambda slope: f"{slope:.2f}".replace("-", "\N{MINUS SIGN}"),
    }
    made.tests["finite"] = math.isfinite
    made.globals |= {"kinds": words.KINDS, "worth": words.WORTH, "sides": words.SIDES}
    return made


def used(result: CheckResult) -> float:
    """Return how much of its tolerance a result uses; 0 where its check does not apply."""
    return margin_of(result) or 0.0


def text_of(name: str, folder: Path = _TEMPLATES) -> Markup:
    """Return a style or a script that stands in a page as it is."""
    return Markup((folder / name).read_text(encoding="utf-8"))
