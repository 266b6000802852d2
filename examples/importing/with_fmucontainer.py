"""Two blocks nested in one FMU by fmucontainer, the spring of the first pushing the second.

StickSlip.fmu lies in the working folder.
"""

import json
import subprocess
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu

description = {
    "step_size": 0.01,
    "fmu": ["a.fmu", "b.fmu"],
    "path": {"a.fmu": "StickSlip.fmu", "b.fmu": "StickSlip.fmu"},
    "auto_link": False,
    "auto_input": False,
    "auto_output": False,
    "auto_parameter": True,  # Shows every parameter, as a.c, b.c and so on.
    "link": [["a.fmu", "F", "b.fmu", "F_ext"]],
    "input": [["v", "a.fmu", "v"], ["v", "b.fmu", "v"]],
    "output": [[f"{block}.fmu", name, f"{block}.{name}"] for block in "ab" for name in ("x", "T")]
    + [["a.fmu", "n_slips", "a.n_slips"]],
}
Path("pair.json").write_text(json.dumps(description))
subprocess.run(["fmucontainer", "-container", "pair.json"], check=True)

# The container steps on a grid of its own: communicate in multiples of its step.
result = simulate_fmu(
    "pair.fmu",
    stop_time=10.0,
    output_interval=0.01,
    start_values={"a.c": 2.0, "b.c": 2.0},
    input=np.array(
        [(0.0, 0.02), (5.0, 0.02), (5.0, 0.05), (10.0, 0.05)],
        dtype=[("time", float), ("v", float)],
    ),
)

last = result[-1]
print(f"x = {last['a.x']:.9f} m, T = {last['a.T']:.9f} s, {last['a.n_slips']} slips")
