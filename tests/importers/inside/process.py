"""A process of a user who has an importer and the FMU, and nothing of this project.

Called with a module here, a function of it, the FMU, a file with the function's
argument and one for what it returns, both JSON. JSON keeps every digit of a double.
"""

import importlib
import json
import runpy
import sys
from pathlib import Path

if __name__ == "__main__":
    runpy.run_path(str(Path(__file__).resolve().parents[2] / "barred.py"), run_name="__main__")
    # python -I leaves the folder of the script out, and with it this package.
    sys.path.insert(0, str(Path(__file__).parents[1]))
    name, function, fmu, order, answer = sys.argv[1:]
    module = importlib.import_module(f"inside.{name}")
    argument = json.loads(Path(order).read_text(encoding="utf-8"))
    given = getattr(module, function)(fmu, argument)
    Path(answer).write_text(json.dumps(given), encoding="utf-8")
