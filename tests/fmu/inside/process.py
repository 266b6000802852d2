"""The program of such a process: calls one function of a module here.

Called with the module, the function and the FMU; the function gets an `Importer` of the FMU and
the argument that stands as JSON on standard input. What it returns is printed as JSON.
"""

import importlib
import json
import sys
from pathlib import Path

if __name__ == "__main__":
    # python -I leaves everything out; the project's packages stay barred by `importer`.
    sys.path.insert(0, str(Path(__file__).parents[3]))
    task, function, fmu = sys.argv[1:]
    from tests.fmu.importer import Importer

    module = importlib.import_module(f"tests.fmu.inside.{task}")
    print(json.dumps(getattr(module, function)(Importer(fmu), json.load(sys.stdin))))
