"""Checks rows of the how-to's tables of creeping and hunting by new runs.

A program, so that no test process loads the FMUs.

Called with the folder of the FMUs, the how-to, and the names of the variants to run.
"""

import sys
from pathlib import Path

from examples.feed_axis.document import check_variants

if __name__ == "__main__":
    folder, document, *variants = sys.argv[1:]
    text = Path(document).read_text(encoding="utf-8")
    for line in check_variants(text, Path(folder), lambda _: None, tuple(variants)):
        print(line)
