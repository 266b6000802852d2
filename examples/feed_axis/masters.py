"""Runs a system in one of three masters and writes what they record to a CSV file.

A program of its own that knows nothing of the project, since a simulator does not either:
`python masters.py fmpy|ecos|libcosim FeedAxis.ssp STOP STEP OUT.csv [COMPONENT.VARIABLE ...]`. All
three step the FMUs over the same interval with what was given at its start.
"""

import csv
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

NAMES = (
    *("table.F", "table.x", "table.x_dot", "table.delta_x"),
    *("drive.v", "drive.x_motor", "drive.x_command", "drive.F_motor"),
)
"""What is recorded of FeedAxis.ssp, as component.variable."""

Rows = list[list[float]]
"""Time [s], then the values of the names [SI]: one row for each communication point."""


def run_in_fmpy(ssp: Path, stop: float, step: float, names: Sequence[str] = NAMES) -> Rows:
    """Run it in fmpy's simulation of SSP files."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import Parameter, read_ssd

    # The parameters that the file binds have to be named and handed over by hand.
    [binding] = read_ssd(str(ssp)).system.parameterBindings
    [parameters], [mapping] = binding.parameterValues, binding.parameterMapping
    value = {each.name: each.value for each in parameters.parameters}
    parameters.parameters = [
        Parameter(name=each.target, value=value[each.source]) for each in mapping.mappingEntries
    ]
    # Half a step short of the end, lest a rounding adds a step.
    end = stop - 0.5 * step
    rows = simulate_ssp(str(ssp), stop_time=end, step_size=step, parameter_set=parameters)
    # It dates a row with the start of the step at whose end the outputs were read.
    columns = [rows[name].tolist() for name in names]
    return [[step * (index + 1), *row] for index, row in enumerate(zip(*columns, strict=True))]


def run_in_ecos(ssp: Path, stop: float, step: float, names: Sequence[str] = NAMES) -> Rows:
    """Run it in ecos, which names a variable component::variable."""
    from ecospy import EcosSimulation

    rows = []
    with EcosSimulation(ssp_path=str(ssp), step_size=step) as simulation:
        # Without its name the parameter set of the file would not be applied.
        if not simulation.init(parameter_set="parameters"):
            raise RuntimeError("ecos could not initialize the system")
        for index in range(round(stop / step)):
            simulation.step()
            values = [simulation.get_real(name.replace(".", "::")) for name in names]
            rows.append([step * (index + 1), *values])
        simulation.terminate()
    return rows


def run_in_libcosim(ssp: Path, stop: float, step: float, names: Sequence[str] = NAMES) -> Rows:
    """Run it in libcosim, which reads the unpacked folder and counts whole nanoseconds."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.WARNING)
    rows = []
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        with zipfile.ZipFile(ssp) as archive:
            archive.extractall(folder)
        execution = CosimExecution.from_ssp_file(folder, round(step * 1e9))
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer)
        slaves = {
            each: execution.slave_index_from_instance_name(each)
            for each in {name.partition(".")[0] for name in names}
        }
        where = {
            f"{component}.{variable.name.decode()}": (slave, variable.reference)
            for component, slave in slaves.items()
            for variable in execution.slave_variables(slave)
        }
        for index in range(round(stop / step)):
            if not execution.step():
                raise RuntimeError(f"libcosim failed in step {index}")
            places = [where[name] for name in names]
            values = [observer.last_real_values(slave, [each])[0] for slave, each in places]
            rows.append([step * (index + 1), *values])
    return rows


MASTERS: dict[str, Callable[[Path, float, float, Sequence[str]], Rows]] = {
    "fmpy": run_in_fmpy,
    "ecos": run_in_ecos,
    "libcosim": run_in_libcosim,
}


class MasterError(RuntimeError):
    """A master failed: what the FMU said of it, else the last line of what the master said."""


def run(
    master: str, ssp: Path, stop: float, step: float, target: Path, names: Sequence[str] = NAMES
) -> None:
    """Run a system to a time [s] in steps [s], in the master of this name in its own process.

    Raises
    ------
    MasterError
        If there is none of this name, or it fails.
    """
    if master not in MASTERS:
        raise MasterError(f"--master: {master!r} is none of {', '.join(MASTERS)}")
    words = [__file__, master, ssp, repr(stop), repr(step), target, *names]
    command = [sys.executable, "-I", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or ["no reason given"]
        own = [
            line for line in lines if line.startswith(("StickSlip", "ServoDrive", "SpeedSource"))
        ]
        raise MasterError(f"{master} failed: {(own or lines[-1:])[0]}")
    # Not every master stops where an FMU fails; what the FMU says is for the person.
    print(done.stderr, end="", file=sys.stderr)


if __name__ == "__main__":
    _, master, ssp, stop, step, target, *names = sys.argv
    recorded = names or NAMES
    with Path(target).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time", *recorded])
        writer.writerows(MASTERS[master](Path(ssp), float(stop), float(step), recorded))
