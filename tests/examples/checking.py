"""Checks rows of the how-to's tables by new runs: as a program, apart from the test process.

Called with the folder of the FMUs, the how-to, and the names of the variants to run.
"""

import sys
from pathlib import Path

from examples.feed_axis.document import check_document

if __name__ == "__main__":
    folder, document, *variants = sys.argv[1:]
    for line in check_document(Path(document), Path(folder), lambda _: None, tuple(variants)):
        print(line)
