"""What is fast, measured against what: every ratio from one run, its sides taken in turn.

Run it with ``make bench``, or ``python -m benchmarks.bench [-o FILE]``.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import fmpy
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks import axis, chunks, fields, native, stribeck, sweep
from benchmarks.bare import BareSlave
from benchmarks.empty_slave import build_empty_slave
from benchmarks.page import NoBrowserError, measure_moves, measure_openings
from benchmarks.plain_cycle import plain_steady_cycle
from stickslip.page import page
from stickslip_fmu.block import Block
from stickslip_fmu.packer import build
from stickslip_fmu.spec import SPEC, TABLE
from stickslip_ref import Parameters, simulate, steady_cycle
from stickslip_score import read_curve, score

ROUNDS = 15
CALLS = 5_000
INSTANCES = 50
POINTS = 1_000_000
ROWS = 2_000_000
TEN_OUTPUTS = ["x", "x_dot", "x_pull", "z", "F", "F_friction", "F_s", "t_stick", "t_slip", "T"]


@dataclass(frozen=True)
class Measurement:
    """One row: seconds per unit of ours, of the yardstick (None where there is none), limits.

    `limit` is that of the ratio, `at_most` that of our time [s].
    """

    what: str
    unit: str
    ours: float
    yardstick: float | None = None
    against: str = ""
    limit: float | None = None
    at_most: float | None = None

    @property
    def ratio(self) -> float | None:
        """Ours over the yardstick."""
        return None if self.yardstick is None else self.ours / self.yardstick

    @property
    def held(self) -> bool:
        """Whether ratio and time keep their limits, where they have one."""
        keeps_ratio = self.limit is None or self.ratio is None or self.ratio <= self.limit
        return keeps_ratio and (self.at_most is None or self.ours <= self.at_most)


def best_of(rounds: int, *sides: Callable[[], object]) -> list[float]:
    """Return the shortest time of each side [s], the sides taken in turn."""
    best = [float("inf")] * len(sides)
    for _ in range(rounds):
        for index, side in enumerate(sides):
            begin = time.perf_counter()
            side()
            best[index] = min(best[index], time.perf_counter() - begin)
    return best


def measure_calls(ours: Path, empty: Path) -> list[Measurement]:
    """Time the calls of an importer: steps at 1 ms, outputs, going back, instances."""
    with BareSlave(ours, TEN_OUTPUTS) as slave, BareSlave(empty, TEN_OUTPUTS) as yardstick:
        alone = best_of(ROUNDS, lambda: slave.step(CALLS), lambda: yardstick.step(CALLS))
        both = best_of(
            ROUNDS, lambda: slave.step_and_get(CALLS), lambda: yardstick.step_and_get(CALLS)
        )
        back = best_of(
            ROUNDS,
            lambda: slave.step_and_go_back(CALLS // 5),
            lambda: yardstick.step_and_go_back(CALLS // 5),
        )
        made = best_of(
            ROUNDS, lambda: slave.instantiate(INSTANCES), lambda: yardstick.instantiate(INSTANCES)
        )
    against = "empty pythonfmu slave"
    return [
        Measurement(
            "fmi2DoStep, h = 1 ms", "call", alone[0] / CALLS, alone[1] / CALLS, against, 1.6
        ),
        Measurement(
            "fmi2DoStep + fmi2GetReal of 10",
            "pair",
            both[0] / CALLS,
            both[1] / CALLS,
            against,
            1.0,
        ),
        Measurement(
            "state: get, step, set, free",
            "round",
            back[0] / (CALLS // 5),
            back[1] / (CALLS // 5),
            against,
            1.5,
        ),
        Measurement(
            "fmi2Instantiate + fmi2FreeInstance",
            "instance",
            made[0] / INSTANCES,
            made[1] / INSTANCES,
            against,
            1.3,
        ),
    ]


def measure_native() -> list[Measurement]:
    """Time the calls of the native FMU in a host written in C, and the growth of its memory."""
    kinds = {
        "step": ("fmi2DoStep, h = 1 ms", 30e-9),
        "step_and_motion": ("with fmi2GetReal of 10 of motion", 150e-9),
        "step_and_energies": ("with heat and work, c > 0", 1e-6),
        "changed_input": ("fmi2SetReal, fmi2DoStep", 1.5e-6),
        "state_round": ("state: get, step, set, free", 150e-9),
        "bytes_round": ("state as bytes: written, read, set", 5e-6),
        "instance": ("fmi2Instantiate + fmi2FreeInstance", 5e-6),
        "step_of_1e6_s": ("fmi2DoStep, h = 1e6 s", 2.0),
    }
    found = native.measure_calls()
    changed, coulomb_changed = native.measure_changed_input()
    slips, coulomb_slips = native.measure_slips()
    count, against = native.SLIPS, "Coulomb's law"
    return [
        Measurement(
            f"native: {what}",
            "call",
            ours.seconds,
            # An empty step is as short as it is.
            None if kind == "step_of_1e6_s" else empty.seconds,
            f"empty slave in C; growth {ours.growth} kB",
            at_most=limit,
        )
        for kind, (what, limit) in kinds.items()
        for ours, empty in [found[kind]]
    ] + [
        Measurement(
            "native, Stribeck: fmi2SetReal, fmi2DoStep",
            "call",
            changed,
            coulomb_changed,
            against,
            at_most=5e-6,
        ),
        Measurement(
            "native, Stribeck: slip, delta = 2, from Python",
            "slip",
            slips / count,
            coulomb_slips / count,
            against,
            at_most=20e-6,
        ),
        Measurement(
            f"native, Stribeck: {count:,} slips from Python",
            "batch",
            slips,
            coulomb_slips,
            against,
            at_most=1.0,
        ),
        *(
            Measurement(
                f"map: {count:,} points under Stribeck's law{what}",
                "map",
                spent,
                slips,
                "undamped slips alone",
                at_most=1.0,
            )
            for what, spent in zip(("", ", damped"), native.measure_points(), strict=True)
        ),
    ]


def measure_axis() -> list[Measurement]:
    """Time the verdict on a feed axis with its drive."""
    return [
        Measurement("critical feed in the loop", "axis", axis.measure_limit(), at_most=0.5),
        Measurement("design, from call to report", "axis", axis.measure_command(), at_most=5.0),
    ]


def measure_sweep() -> list[Measurement]:
    """Time a run of our FMUs in a sweep."""
    runs = sweep.measure_runs()
    return [
        Measurement("sweep, FMU in Python, 3 s in one step", "run", runs["python"], at_most=2e-3),
        Measurement("sweep, native FMU, 3 s in one step", "run", runs["native"], at_most=1e-4),
    ]


def measure_stribeck() -> list[Measurement]:
    """Time the Python block under Stribeck's law: slips, steps along one, changes of the input."""
    slip, integrated = stribeck.measure_slips()
    along, coulomb_along = stribeck.measure_steps(changing=False)
    changed, coulomb_changed = stribeck.measure_steps(changing=True)
    against = "Coulomb's law"
    return [
        Measurement(
            "Stribeck: slip, delta = 2, exact",
            "slip",
            slip,
            integrated,
            "SciPy's DOP853, rtol = 1e-9",
            0.25,
        ),
        Measurement(
            "Stribeck: step of 1 ms in slip, outputs", "step", along, coulomb_along, against, 3.0
        ),
        Measurement(
            "Stribeck: the same, after a change of v",
            "step",
            changed,
            coulomb_changed,
            against,
            at_most=100e-6,
        ),
    ]


def measure_chunks() -> list[Measurement]:
    """Time a chunk of a study beyond its points, and a study by one and by two workers."""
    each = chunks.measure_overhead()
    alone, shared = chunks.measure_sharing()
    return [
        Measurement("chunk: computed here, written", "chunk", each.here),
        Measurement("chunk: by a worker process", "chunk", each.process, at_most=10e-3),
        Measurement("chunk: by a dask worker", "chunk", each.dask, at_most=50e-3),
        # An efficiency of 0.9 at least.
        Measurement(
            "study on two cores, chunks of 1 s",
            "study",
            2.0 * shared,
            alone,
            "one core",
            1.0 / 0.9,
        ),
    ]


def measure_import(ours: Path, empty: Path) -> Measurement:
    """Time a 10 s run at 1 ms through fmpy, all outputs recorded."""
    outputs = [each.name for each in TABLE.rows if each.causality == "output"]

    def run(fmu: Path) -> Callable[[], object]:
        return lambda: fmpy.simulate_fmu(
            str(fmu), stop_time=10.0, step_size=1e-3, output_interval=1e-3, output=outputs
        )

    slave, yardstick = best_of(3, run(ours), run(empty))
    return Measurement(
        "fmpy.simulate_fmu, 10 s at 1 ms", "run", slave, yardstick, "empty pythonfmu slave", 1.5
    )


def measure_block() -> list[Measurement]:
    """Time the block alone: event to event, and a step within an arc."""
    block = SPEC.start()
    assert isinstance(block, Block)
    before = block.meter.n_slips
    begin = time.perf_counter()
    block.advance(0.0, 10_000.0)
    events = 2 * (block.meter.n_slips - before)
    per_event = (time.perf_counter() - begin) / events

    def steps() -> None:
        for _ in range(CALLS):
            block.advance(0.0, 1e-7)

    (per_step,) = best_of(ROUNDS, steps)
    return [
        Measurement("block, event to event", "event", per_event),
        Measurement("block, step within an arc", "step", per_step / CALLS),
    ]


def measure_reference() -> Measurement:
    """Time the reference's default run."""
    (seconds,) = best_of(3, lambda: simulate(Parameters(), 10.0))
    return Measurement("stickslip_ref.simulate, 10 s", "run", seconds)


def measure_fields() -> list[Measurement]:
    """Time the closed forms on whole fields: one and ten million points."""
    still, moving = fields.undamped(POINTS), fields.damped(POINTS)
    m, k, mu_s, mu_k, v = map(np.asarray, (still.m, still.k, still.mu_s, still.mu_k, still.v))
    ours, plain, together = best_of(
        ROUNDS,
        lambda: steady_cycle(still),
        lambda: plain_steady_cycle(m, 9.81, k, mu_s, mu_k, v),
        lambda: fields.evaluated(moving),
    )
    large = fields.damped(10 * POINTS)
    (ten,) = best_of(3, lambda: fields.evaluated(large))
    beyond = fields.memory_beyond(lambda: fields.evaluated(large))
    return [
        Measurement(
            "steady_cycle, 10^6 points, c = 0", "field", ours, plain, "plain NumPy", 1.0, 0.1
        ),
        Measurement(
            "and coulomb_limit, 10^6 points, c > 0",
            "field",
            together,
            ours,
            "c = 0",
            at_most=0.7,
        ),
        Measurement(
            "the same, 10^7 points",
            "field",
            ten,
            together,
            f"10^6; beyond input, output: {beyond / 1e6:.0f} MB",
            at_most=8.0,
        ),
    ]


def measure_score(folder: Path) -> Measurement:
    """Time reading and judging a file of two million rows against NumPy that only reads it."""
    file = folder / "curve.csv"
    run = simulate(Parameters(), 1e-4 * ROWS, times=1e-4 * np.arange(ROWS))
    columns = np.column_stack([run.t, run.x, run.F])
    np.savetxt(file, columns, "%.9g", delimiter=",", header="time,x,F", comments="")
    ours, plain = best_of(
        3, lambda: score(read_curve(file), {}), lambda: np.loadtxt(file, delimiter=",", skiprows=1)
    )
    return Measurement(
        "score, file of 2 10^6 rows", "row", ours / ROWS, plain / ROWS, "numpy.loadtxt", 4.0
    )


def measure_page(folder: Path) -> list[Measurement]:
    """Time the page's redraw after a move of a slider; nothing, and a word, without a browser."""
    file = folder / "stick-slip.html"
    file.write_text(page(), encoding="utf-8")
    try:
        (opening,) = measure_openings([file])
        places = measure_moves(file)
    except NoBrowserError as error:
        print(f"The page is not measured: {error}.")
        return []
    if opening.shift:
        raise RuntimeError(
            f"the page moves after its first picture: layout shift {opening.shift:g}"
        )
    redraws = [
        row
        for place, each in places.items()
        for row in (
            Measurement(
                f"page, slider to redraw, {place}: median",
                "move",
                each.median,
                8e-3,
                "limit of 8 ms",
                1.0,
            ),
            Measurement(
                f"page, slider to redraw, {place}: 95 %",
                "move",
                each.late,
                16e-3,
                "limit of 16 ms",
                1.0,
            ),
        )
    ]
    times = places["top"]
    return [
        Measurement("page, file to first picture", "opening", opening.first),
        *redraws,
        Measurement("page, slider to layout: median", "move", times.work),
        Measurement("page, slider to screen: median", "move", times.seen),
        # Drawn one by one they would take a hundred redraws.
        Measurement(
            "page, 100 moves at once to screen", "burst", times.burst, times.seen, "one move", 5.0
        ),
        Measurement("page, move after those", "move", times.after_burst, times.seen, "one move"),
    ]


def measure() -> list[Measurement]:
    """Measure everything."""
    with tempfile.TemporaryDirectory(prefix="stickslip-bench-") as folder:
        ours = build(Path(folder))
        empty = build_empty_slave(Path(folder))
        return [
            *measure_calls(ours, empty),
            *measure_native(),
            *measure_stribeck(),
            *measure_axis(),
            *measure_chunks(),
            *measure_sweep(),
            measure_import(ours, empty),
            *measure_block(),
            measure_reference(),
            *measure_fields(),
            measure_score(Path(folder)),
            *measure_page(Path(folder)),
        ]


def _time(seconds: float) -> str:
    units = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns"))
    factor, unit = next((pair for pair in units if seconds * pair[0] >= 1.0), units[-1])
    return f"{seconds * factor:.3g} {unit}"


def _limit(row: Measurement) -> str:
    limits = [] if row.limit is None else [f"{row.limit:.2f}"]
    if row.at_most is not None:
        limits.append(_time(row.at_most))
    text = ", ".join(limits)
    return text if row.held else f"{text} exceeded"


def as_table(measurements: list[Measurement]) -> Table:
    """Return the measurements as a table."""
    table = Table(title="stickslip benchmarks: best of interleaved rounds")
    for heading in ("what", "per", "ours", "yardstick", "ratio", "limit", "against"):
        table.add_column(heading, justify="left" if heading in ("what", "against") else "right")
    for row in measurements:
        table.add_row(
            row.what,
            row.unit,
            _time(row.ours),
            "" if row.yardstick is None else _time(row.yardstick),
            "" if row.ratio is None else f"{row.ratio:.2f}",
            _limit(row),
            row.against,
        )
    return table


def main() -> None:
    """Measure, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("build/bench.json"))
    target = parser.parse_args().output
    measurements = measure()
    Console(width=120).print(as_table(measurements))
    target.parent.mkdir(parents=True, exist_ok=True)
    rows = [{**asdict(row), "ratio": row.ratio} for row in measurements]
    target.write_text(json.dumps(rows, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
