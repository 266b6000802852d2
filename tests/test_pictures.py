"""The pictures of the documents: small, shown, and compared by ``make docs-check``."""

import re
from pathlib import Path

import pytest

from stickslip_verification.report.svg import differences

DOCS = Path(__file__).parents[1] / "docs"
PICTURES = {file.relative_to(DOCS).as_posix(): file for file in sorted(DOCS.rglob("*.svg"))}


def test_the_documents_show_every_picture() -> None:
    pages = (page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
    assert {name for text in pages for name in re.findall(r"\]\(([\w/-]+\.svg)\)", text)} == set(
        PICTURES
    )


SVG = '<svg><title>t</title><path d="M0 0L{} 4L8 8" style="stroke: {}"/>{}</svg>'
MARK = '<path d="M3 3v2" style=""/>'
DRAWN = SVG.format("4", "red", MARK)


@pytest.mark.parametrize(
    ("other", "count"),
    [
        (SVG.format("4.05", "red", MARK), 0),
        (SVG.format("4.2", "red", MARK), 1),
        (SVG.format("4", "blue", MARK), 1),
        (DRAWN.replace(">t<", ">T<"), 1),
        (SVG.format("4", "red", ""), 1),
    ],
)
def test_a_picture_differs_by_points_colours_words_and_marks(
    tmp_path: Path, other: str, count: int
) -> None:
    (tmp_path / "a.svg").write_text(DRAWN, encoding="utf-8")
    (tmp_path / "b.svg").write_text(other, encoding="utf-8")
    assert len(differences(tmp_path / "b.svg", DRAWN)) == count
