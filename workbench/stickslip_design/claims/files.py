"""The page of the claims and its plots, as texts and as files."""

from __future__ import annotations

from pathlib import Path

from stickslip_design.claims.all_claims import findings
from stickslip_design.claims.document import PLOTS, markdown
from stickslip_design.claims.plots import draw

NOTE = "<!-- Made by `make docs`; do not edit. -->"


def pages() -> dict[str, str]:
    """Return the texts of claims.md and of claims/*.svg by their names inside docs/."""
    found = findings()
    texts = {"claims.md": "\n".join((NOTE, *markdown(found))) + "\n"}
    return texts | {f"{PLOTS}/{each.id}.svg": draw(each) for each in found}


def write(folder: Path) -> list[Path]:
    """Write the page and its plots into a folder, and return the files, the page first.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    (folder / PLOTS).mkdir(parents=True, exist_ok=True)
    files = []
    for name, text in pages().items():
        files.append(folder / name)
        files[-1].write_text(text, encoding="utf-8", newline="\n")
    return files
