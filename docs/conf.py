"""The site: ``make site`` builds it from the documents of this folder, and what the code says.

Formulas are MathML, so that a page asks for nothing outside itself.
"""

import os
import re
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.writers.html5 import HTML5Translator

from stickslip_fmu.release import VERSION

MADE = Path(__file__).parent / "made"
"""What the commands write: their reference, and the live page."""
(MADE / "page").mkdir(parents=True, exist_ok=True)

project = "stickslip"
author = "The stickslip engineers"
release = version = VERSION
extensions = ["myst_nb", "numpydoc", "sphinx.ext.autodoc", "sphinx_design"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "off"
numpydoc_show_class_members = False
highlight_language = "none"
html_theme = "pydata_sphinx_theme"
html_title = "stickslip"
html_baseurl = os.environ.get("SITE", "")
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_extra_path = ["made/page"]
html_show_sourcelink = False
html_sidebars = {name: [] for name in ("index", "gallery", "theory")}
html_math_renderer = "mathml"
html_theme_options = {
    "footer_end": [],
    "footer_start": ["copyright"],
    "navbar_align": "left",
    "pygments_dark_style": "a11y-high-contrast-dark",
    "pygments_light_style": "a11y-high-contrast-light",
    "show_nav_level": 2,
}

NUMBER = re.compile(r"\\tag\{(\d+)\}")
ROOM = re.compile(r"(?<=\\\\)\[[\d.]+ex\]")
"""Room between rows, which the converter takes for a part of the next one."""


def inline(site: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line."""
    site.body.append(convert(node.astext()))
    raise nodes.SkipNode


def displayed(site: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula of its own line; its number is an anchor, ``#eq-12``."""
    text = node.astext()
    number = NUMBER.search(text)
    # The environment that stands in a formula has another name for the converter.
    rows = ROOM.sub("", NUMBER.sub("", text)).replace("{aligned}", "{align*}")
    formula = convert(rows, display="block")
    mark = ""
    if number:
        name = f"eq-{number[1]}"
        mark = f'<a class="eqno" id="{name}" href="#{name}">({number[1]})</a>'
    site.body.append(f'<div class="math" tabindex="0">{formula}{mark}</div>\n')
    raise nodes.SkipNode


def make(app: Sphinx) -> None:
    """Write what the commands say of themselves, the live page, and the project to download."""
    archive = ("git", "archive", "--prefix=stickslip/", "-o", MADE / "page" / "stickslip.zip")
    # A copy of the project that is no clone has no such archive; then nothing points to it.
    with suppress(OSError, subprocess.CalledProcessError):
        subprocess.run([*archive, "HEAD"], cwd=MADE.parents[1], check=True)
        app.tags.add("archive")
    live = f"{html_baseurl.rstrip('/')}/explore.html" if html_baseurl else ""
    for words in (
        ("typer", "stickslip.cli", "utils", "docs", "--output", MADE / "command.md"),
        ("stickslip", "page", "-o", MADE / "page" / "explore.html", "--address", live),
    ):
        subprocess.run([sys.executable, "-m", *words], check=True, stdout=subprocess.DEVNULL)


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the formulas and of what is made first."""
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    app.connect("builder-inited", make)
