"""Runs an SSP file in one of three masters and writes what they record to a CSV file.

A program of its own that knows nothing of the project, since a simulator does not either:
`python masters.py fmpy|ecos|libcosim FeedAxis.ssp STOP STEP OUT.csv NAME ...` with NAMEs such as
table.x. All three step both FMUs over the same interval with what was given at its start.
"""

import csv
import sys
import tempfile
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

Rows = list[list[float]]
"""Time [s], then the values in the order of the names: one row for each communication point."""


def run_in_fmpy(ssp: Path, stop: float, step: float, names: Sequence[str]) -> Rows:
    """Run it in fmpy's simulation of SSP files."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssd

    # The parameters that the file binds have to be handed over by hand.
    bindings = read_ssd(str(ssp)).system.parameterBindings
    (parameters,) = [each for binding in bindings for each in binding.parameterValues]
    # Half a step short of the end, lest a rounding adds a step.
    rows = simulate_ssp(
        str(ssp), stop_time=stop - 0.5 * step, step_size=step, parameter_set=parameters
    )
    # It dates a row with the start of the step at whose end the outputs were read.
    return [
        [step * (index + 1), *(float(row[name]) for name in names)]
        for index, row in enumerate(rows)
    ]


def run_in_ecos(ssp: Path, stop: float, step: float, names: Sequence[str]) -> Rows:
    """Run it in ecos."""
    from ecospy import EcosSimulation

    rows = []
    with EcosSimulation(ssp_path=str(ssp), step_size=step) as simulation:
        # Without its name the parameter set of the file would not be applied.
        if not simulation.init(parameter_set="axis"):
            raise RuntimeError("ecos could not initialize the system")
        for index in range(round(stop / step)):
            simulation.step()
            # ecos names a variable component::variable.
            values = [simulation.get_real(name.replace(".", "::")) for name in names]
            rows.append([step * (index + 1), *values])
        simulation.terminate()
    return rows


def run_in_libcosim(ssp: Path, stop: float, step: float, names: Sequence[str]) -> Rows:
    """Run it in libcosim."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.WARNING)
    rows = []
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        # It reads the unpacked folder; time is in whole nanoseconds.
        with zipfile.ZipFile(ssp) as archive:
            archive.extractall(folder)
        execution = CosimExecution.from_ssp_file(folder, round(step * 1e9))
        observer = CosimObserver.create_last_value()
        execution.add_observer(observer)
        where = [_place(execution, name) for name in names]
        for index in range(round(stop / step)):
            if not execution.step():
                raise RuntimeError(f"libcosim failed in step {index}")
            values = [
                observer.last_real_values(slave, [reference])[0] for slave, reference in where
            ]
            rows.append([step * (index + 1), *values])
    return rows


def _place(execution: Any, name: str) -> tuple[int, int]:
    """Return index and value reference of component.variable in libcosim."""
    component, _, variable = name.partition(".")
    slave = execution.slave_index_from_instance_name(component)
    for each in execution.slave_variables(slave):
        if each.name.decode() == variable:
            return slave, each.reference
    raise RuntimeError(f"libcosim knows no variable {name}")


MASTERS: dict[str, Callable[[Path, float, float, Sequence[str]], Rows]] = {
    "fmpy": run_in_fmpy,
    "ecos": run_in_ecos,
    "libcosim": run_in_libcosim,
}


def main() -> None:
    """Run what the command line says."""
    master, ssp, stop, step, target, *names = sys.argv[1:]
    rows = MASTERS[master](Path(ssp), float(stop), float(step), names)
    with Path(target).open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(["time", *names])
        writer.writerows([map(repr, row) for row in rows])


if __name__ == "__main__":
    main()
