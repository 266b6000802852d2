"""Runs of the coupled FMUs as a program, so that no test process loads them.

Called with the folder of the FMUs and a JSON list of runs: the fields of the axis that differ from
the example's, stop time, step, order, columns. Prints the columns of each run as JSON.
"""

import json
import sys
from pathlib import Path

from examples.feed_axis.axis import Axis
from examples.feed_axis.coupling import simulate

if __name__ == "__main__":
    folder, runs = Path(sys.argv[1]), json.loads(sys.argv[2])
    found = []
    for changes, stop_time, step, order, columns in runs:
        run = simulate(folder, Axis(**changes), stop_time, step, order)
        found.append([run[column].tolist() for column in columns])
    print(json.dumps(found))
