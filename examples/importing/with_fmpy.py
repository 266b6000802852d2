"""The block in FMPy. StickSlip.fmu lies in the working folder."""

import numpy as np
from fmpy import simulate_fmu

# Rows of time, v, load, F_ext. FMPy joins rows by straight lines: two rows at 5 s make a jump.
inputs = np.array(
    [(0.0, 0.02, 0.0, 0.0), (5.0, 0.02, 0.0, 0.0), (5.0, 0.05, 0.0, 0.0), (10.0, 0.05, 0.0, 0.0)],
    dtype=[("time", float), ("v", float), ("load", float), ("F_ext", float)],
)

result = simulate_fmu(
    "StickSlip.fmu",
    stop_time=10.0,
    output_interval=0.01,
    start_values={"c": 2.0},
    input=inputs,
    output=["x", "F", "mode", "sticking", "T", "n_slips"],
    debug_logging=True,  # Without it FMPy drops the messages of the FMU.
)

last = result[-1]
print(f"x = {last['x']:.9f} m, T = {last['T']:.9f} s, {last['n_slips']} slips")
