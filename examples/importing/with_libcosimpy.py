"""The block in libcosim, through libcosimpy. StickSlip.fmu lies in the working folder."""

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

log_output_level(CosimLogLevel.WARNING)

execution = CosimExecution.from_step_size(10_000_000)  # nanoseconds
slave = CosimLocalSlave("StickSlip.fmu", "block")
block = execution.add_local_slave(slave)
refer = {each.name.decode(): each.reference for each in execution.slave_variables(block)}

inputs = CosimManipulator.create_override()
outputs = CosimObserver.create_last_value()
execution.add_manipulator(inputs)
execution.add_observer(outputs)

execution.real_initial_value(block, refer["c"], 2.0)
for step in range(1000):
    if step == 500:
        inputs.slave_real_values(block, [refer["v"]], [0.05])
    if not execution.step():
        raise SystemExit("the block refused something: see the message above")

x, T = outputs.last_real_values(block, [refer["x"], refer["T"]])
mode, n_slips = outputs.last_integer_values(block, [refer["mode"], refer["n_slips"]])
[sticking] = outputs.last_boolean_values(block, [refer["sticking"]])
print(f"x = {x:.9f} m, T = {T:.9f} s, {n_slips} slips")
