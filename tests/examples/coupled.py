"""Prints the how-to's coupling errors as JSON: as a program, apart from the test process.

Called with the folder of the FMUs.
"""

import json
import sys
from pathlib import Path

from examples.feed_axis.document import coupling_errors

if __name__ == "__main__":
    print(json.dumps(coupling_errors(Path(sys.argv[1]))))
