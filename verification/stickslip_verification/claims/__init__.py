"""What designers are told, tried against the exact solution and put into numbers.

`findings` tries every claim, `markdown` and `draw` show what came out, `pages` and `write` make the
page and its plots. Names are resolved when they are first used, so that importing this package
costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.claims.document import markdown
    from stickslip_verification.claims.files import pages, write
    from stickslip_verification.claims.finding import Finding
    from stickslip_verification.claims.plots import draw
    from stickslip_verification.claims.trial import findings

_HOME = {
    "Finding": "finding",
    "draw": "plots",
    "findings": "trial",
    "markdown": "document",
    "pages": "files",
    "write": "files",
}

__all__ = ["Finding", "draw", "findings", "markdown", "pages", "write"]

__getattr__, __dir__ = face(__name__, _HOME)
