"""Where the pages of the report take their templates, style and script from."""

from pathlib import Path
from typing import Final

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

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
    made.filters["slug"] = lambda word: "-".join(str(word).lower().split())
    return made


def text_of(name: str, folder: Path = _TEMPLATES) -> Markup:
    """Return a style or a script that stands in a page as it is."""
    return Markup((folder / name).read_text(encoding="utf-8"))
