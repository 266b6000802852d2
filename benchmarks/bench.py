"""What is fast, measured against what: every ratio from one run, its sides taken in turn.

Run it with ``make bench``, or ``python -m benchmarks.bench [-o FILE]``.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import fmpy
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks import memory, settings
from benchmarks.calls import bare, in_c
from benchmarks.chunks import measure_chunks
from benchmarks.empty_slave import build_empty_slave
from benchmarks.page import NoBrowserError, measure_moves, measure_opening
from stickslip.page import page
from stickslip_design.axis import Friction, axis_file_of, example
from stickslip_design.chunks import run as run_study
from stickslip_design.identify.read import read_record
from stickslip_design.loop import native
from stickslip_design.loop.jumps import limit_of_jumps
from stickslip_design.points.axes import axis_points
from stickslip_design.points.blocks import block_points
from stickslip_design.sweeps.study import prepare
from stickslip_fmu.block import Block
from stickslip_fmu.packer import build
from stickslip_fmu.spec import TABLE
from stickslip_native.batch import first_slips
from stickslip_native.packer import build as build_native
from stickslip_ref import Parameters, coulomb_limit, simulate, steady_cycle
from stickslip_score import read_curve, score

ROUNDS = 15
CALLS = 5_000
POINTS = 1_000_000
ROWS = 2_000_000
SLIPS = 10_000
EMPTY, COULOMB = "empty pythonfmu slave", "Coulomb's law"


class Row(NamedTuple):
    """Seconds per unit of ours and of the yardstick, where there is one; limits.

    `limit` is that of the ratio, `at_most` that of our time [s].
    """

    what: str
    unit: str
    times: Sequence[float]
    against: str = ""
    limit: float | None = None
    at_most: float | None = None

    @property
    def ratio(self) -> float | None:
        """Ours over the yardstick."""
        return self.times[0] / self.times[1] if len(self.times) > 1 else None

    @property
    def held(self) -> bool:
        """Whether ratio and time keep their limits, where they have one."""
        keeps_ratio = self.limit is None or self.ratio is None or self.ratio <= self.limit
        return keeps_ratio and (self.at_most is None or self.times[0] <= self.at_most)


def best_of(rounds: int, *sides: Callable[[], object], count: int = 1) -> list[float]:
    """Return the shortest time of each side [s] over the count, the sides taken in turn."""
    best = [math.inf] * len(sides)
    for _ in range(rounds):
        for index, side in enumerate(sides):
            begin = time.perf_counter()
            side()
            best[index] = min(best[index], (time.perf_counter() - begin) / count)
    return best


def of_python_fmu(folder: Path) -> Iterator[Row]:
    """Time the calls of an importer: steps at 1 ms, outputs, going back, instances; a run."""
    fmus = build(folder), build_empty_slave(folder)
    with bare(fmus[0]) as ours, bare(fmus[1]) as empty:
        for kind, what, unit, count, limit in (
            ("steps", "fmi2DoStep, h = 1 ms", "call", CALLS, 1.6),
            ("steps_and_outputs", "fmi2DoStep + fmi2GetReal of 10", "pair", CALLS, 1.0),
            ("rounds_of_state", "state: get, step, set, free", "round", CALLS // 5, 1.5),
            ("instances", "fmi2Instantiate + fmi2FreeInstance", "instance", 50, 1.3),
        ):
            sides = (partial(each[kind], count) for each in (ours, empty))
            yield Row(what, unit, best_of(ROUNDS, *sides, count=count), EMPTY, limit)
    outputs = [each.name for each in TABLE.rows if each.causality == "output"]
    times = {"stop_time": 10.0, "step_size": 1e-3, "output_interval": 1e-3}
    runs = (partial(fmpy.simulate_fmu, str(fmu), output=outputs, **times) for fmu in fmus)
    yield Row("fmpy.simulate_fmu, 10 s at 1 ms", "run", best_of(3, *runs), EMPTY, 1.5)


def of_native_fmu(folder: Path) -> Iterator[Row]:
    """Time the calls of the native FMU in a host written in C, and the growth of its memory."""
    ours, empty = in_c(folder, "coulomb"), in_c(folder, None)
    for kind, what, at_most in (
        ("step", "fmi2DoStep, h = 1 ms", 30e-9),
        ("step_and_motion", "with fmi2GetReal of 10 of motion", 150e-9),
        ("step_and_energies", "with heat and work, c > 0", 1e-6),
        ("changed_input", "fmi2SetReal, fmi2DoStep", 1.5e-6),
        ("state_round", "state: get, step, set, free", 150e-9),
        ("bytes_round", "state as bytes: written, read, set", 5e-6),
        ("instance", "fmi2Instantiate + fmi2FreeInstance", 5e-6),
        ("step_of_1e6_s", "fmi2DoStep, h = 1e6 s", 2.0),
    ):
        seconds, growth = ours[kind]
        # An empty step is as short as it is.
        times = (seconds,) if kind == "step_of_1e6_s" else (seconds, empty[kind][0])
        against = f"empty slave in C; growth {growth} kB"
        yield Row(f"native: {what}", "call", times, against, at_most=at_most)
    what = "native, Stribeck: fmi2SetReal, fmi2DoStep"
    changed, of_coulomb = (
        in_c(folder, law, "changed_input")["changed_input"][0] for law in ("stribeck", "coulomb")
    )
    yield Row(what, "call", (changed, of_coulomb), COULOMB, at_most=5e-6)


def of_native_batches() -> Iterator[Row]:
    """Time slips in one call of the native core, and points of a map, under Stribeck's law."""
    runs = settings.under_stribeck(SLIPS)
    still = {name: np.array(each) for name, each in (runs | {"delta": 2.0}).items()}
    # Many a slip with damping, of ratios of 1e-3 to 0.5, has no end.
    zeta = np.exp(np.random.default_rng(1).uniform(math.log(1e-3), math.log(0.5), SLIPS))
    damped = {**still, "c": 2.0 * zeta * np.sqrt(still["k"] * still["m"])}
    plain = {name: runs[name] for name in "mkv"}
    first_slips(plain, "coulomb")
    slips, of_coulomb, *maps = best_of(
        5,
        lambda: first_slips({**runs, "delta": 2.0}, "stribeck"),
        lambda: first_slips(plain, "coulomb"),
        lambda: block_points(still, "stribeck", limit=False),
        lambda: block_points(damped, "stribeck", limit=False),
    )
    what, one = "native, Stribeck: slip, delta = 2, from Python", of_coulomb / SLIPS
    yield Row(what, "slip", (slips / SLIPS, one), COULOMB, at_most=20e-6)
    what = f"native, Stribeck: {SLIPS:,} slips from Python"
    yield Row(what, "batch", (slips, of_coulomb), COULOMB, at_most=1.0)
    for what, spent in zip(("", ", damped"), maps, strict=True):
        what = f"map: {SLIPS:,} points under Stribeck's law{what}"
        yield Row(what, "map", (spent, slips), "undamped slips alone", at_most=1.0)


def of_stribeck() -> Iterator[Row]:
    """Time the Python block under Stribeck's law: slips, steps along one, changes of the input."""
    exact, integrated = [], []
    for m, k, v, v_s in zip(*settings.under_stribeck(25).values(), strict=True):
        values = {"m": m, "k": k, "v": v, "v_s": v_s}
        whole = settings.at_break_away(values)
        while whole.meter.n_slips == 0:
            whole.advance(0.0, 0.5 * math.sqrt(m / k))
        length = whole.meter.t_slip * (1.0 + 1e-9)
        blocks = iter([settings.at_break_away(values) for _ in range(3)])
        slip, other = best_of(
            3,
            partial(_advance_next, blocks, length),
            partial(settings.integrated_slip, **values),
        )
        exact.append(slip)
        integrated.append(other)
    slips = [*map(statistics.median, (exact, integrated))]
    what, against = "Stribeck: slip, delta = 2, exact", "SciPy's DOP853, rtol = 1e-9"
    yield Row(what, "slip", slips, against, 0.25)
    along, changed = (
        [_step_in_slip(law, changing=changing) for law in ("stribeck", "coulomb")]
        for changing in (False, True)
    )
    yield Row("Stribeck: step of 1 ms in slip, outputs", "step", along, COULOMB, 3.0)
    what = "Stribeck: the same, after a change of v"
    yield Row(what, "step", changed, COULOMB, at_most=100e-6)


def _advance_next(blocks: Iterator[Block], length: float) -> None:
    next(blocks).advance(0.0, length)


def _step_in_slip(law: str, *, changing: bool) -> float:
    """Return the median time of a step of 1 ms in slip with outputs [s], at 50 mm/s or changing."""
    block = settings.block_of(law, v=0.05)
    times: list[float] = []
    number = 0
    while len(times) < 1500:
        number += 1
        if changing:
            block.set("v", 0.05 * (1.0 + 1e-3 * (number % 7)))
        begin = time.perf_counter()
        block.advance(0.0, 1e-3)
        block.refresh()
        _ = block.W_pull, block.Q_friction
        end = time.perf_counter()
        if block.mode != 0:
            times.append(end - begin)
    return statistics.median(times)


def of_memory(folder: Path) -> Iterator[Row]:
    """Time cycles under laws with a memory, which are integrated."""
    for what, unit, times, against, limit in memory.measured(folder):
        at_most = 5e-6 if len(times) == 1 else None
        yield Row(what, unit, times, against, limit, at_most)


def of_axis(folder: Path) -> Iterator[Row]:
    """Time the verdict on a feed axis with its drive, from the limit to the report, and a map."""
    file = axis_file_of(example())
    axis = file.axis()
    laws = {
        "constant": axis.friction,
        "growing at rest": replace(axis.friction, own={"tau_s": 0.5}),
        "falling": replace(
            axis.friction, law="stribeck", own={"shape": 1.0, "v_s": 5e-3, "delta": 2.0}
        ),
    }

    def limit(friction: Friction) -> None:
        # A new axis: nothing of it is known.
        limit_of_jumps(replace(axis, friction=friction))

    def in_python(friction: Friction) -> None:
        with mock.patch.object(native, "library", return_value=None):
            limit(friction)

    for law, friction in laws.items():
        times = best_of(3, partial(limit, friction), partial(in_python, friction))
        at_most = 10e-3 if law == "constant" else 30e-3
        what = f"critical feed in the loop, friction {law}"
        yield Row(what, "axis", times, "in Python", 0.1, at_most)
    draw = np.random.default_rng(1).uniform
    changes = {"axis.mass": draw(300.0, 800.0, 50), "axis.stiffness": draw(2e7, 8e7, 50)}
    stated = {
        "constant": "", "growing at rest": 'tau_s = "0.5 s"',
        "falling": 'law = "stribeck"\nv_s = "5 mm/s"\ndelta = 2.0',
    }  # fmt: skip
    for law, more in stated.items():
        variant = axis_file_of(example().replace("[friction]", f"[friction]\n{more}"))
        times = best_of(1, partial(axis_points, variant, changes, (5e-4,)), count=50)
        yield Row(f"map of an axis with its loop, friction {law}", "point", times, at_most=30e-3)
    (folder / "axis.toml").write_text(example(), encoding="utf-8")
    words = [Path(sys.executable).with_name("stickslip"), "design", "axis.toml"]
    env = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    run = partial(subprocess.run, words, cwd=folder, check=True, capture_output=True, env=env)
    yield Row("design, from call to report", "axis", best_of(1, run), at_most=5.0)


def of_studies(folder: Path) -> Iterator[Row]:
    """Time a chunk of a study beyond its points, a study by two workers, a run in a sweep."""
    here, process, dask = measure_chunks()
    yield Row("chunk: computed here, written", "chunk", (here,))
    yield Row("chunk: by a worker process", "chunk", (process,), at_most=10e-3)
    yield Row("chunk: by a dask worker", "chunk", (dask,), at_most=50e-3)
    # Of some 30 s, in chunks of a second; the start of the workers is in the time.
    study = settings.Busy(4000, work=1000)
    alone, shared = best_of(
        1, lambda: run_study(study, workers=1), lambda: run_study(study, workers=2)
    )
    what, against = "study on two cores, chunks of 1 s", "one core"
    # An efficiency of 0.9 at least.
    yield Row(what, "study", (2.0 * shared, alone), against, 1.0 / 0.9)
    native = build_native(folder / "native.fmu", this_machine=True)
    for kind, fmu, runs, at_most in (
        ("FMU in Python", build(folder), 500, 2e-3),
        ("native FMU", native, 5000, 1e-4),
    ):
        plan = {"stop_time": "3 s", "step": "3 s", "outputs": {"delta_x": "last", "T": "last"}}
        sweep = prepare(fmu, {**plan, "parameters": {"m": f"1..1.001 kg {runs}"}})
        if any(sweep.compute(0, 2)["failure"]):
            raise RuntimeError("a run fails")
        times = best_of(5, partial(sweep.compute, 0, runs), count=runs)
        yield Row(f"sweep, {kind}, 3 s in one step", "run", times, at_most=at_most)


def of_block() -> Iterator[Row]:
    """Time the block alone: event to event, and a step within an arc; the reference's run."""
    block = settings.block_of("coulomb")
    (whole,) = best_of(1, lambda: block.advance(0.0, 10_000.0))
    yield Row("block, event to event", "event", (whole / (2 * block.meter.n_slips),))

    def steps() -> None:
        for _ in range(CALLS):
            block.advance(0.0, 1e-7)

    yield Row("block, step within an arc", "step", best_of(ROUNDS, steps, count=CALLS))
    run = best_of(3, lambda: simulate(Parameters(), 10.0))
    yield Row("stickslip_ref.simulate, 10 s", "run", run)


def of_fields() -> Iterator[Row]:
    """Time the closed forms on whole fields: one and ten million points."""

    def evaluated(p: Parameters) -> tuple[object, object]:
        # From the numbers on: the parameters are checked anew.
        p = Parameters(m=p.m, k=p.k, c=p.c, mu_s=p.mu_s, mu_k=p.mu_k, v=p.v)
        return steady_cycle(p), coulomb_limit(p)

    still, moving = settings.undamped(POINTS), settings.damped(POINTS)
    m, k, mu_s, mu_k, v = map(np.asarray, (still.m, still.k, still.mu_s, still.mu_k, still.v))
    ours, plain, together = best_of(
        ROUNDS,
        lambda: steady_cycle(still),
        lambda: settings.plain_steady_cycle(m, 9.81, k, mu_s, mu_k, v),
        lambda: evaluated(moving),
    )
    large = settings.damped(10 * POINTS)
    (ten,) = best_of(3, lambda: evaluated(large))
    tracemalloc.start()
    result = evaluated(large)
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    del result
    yield Row("steady_cycle, 10^6 points, c = 0", "field", (ours, plain), "plain NumPy", 1.0, 0.1)
    what = "and coulomb_limit, 10^6 points, c > 0"
    yield Row(what, "field", (together, ours), "c = 0", at_most=0.7)
    against = f"10^6; beyond input, output: {(peak - kept) / 1e6:.0f} MB"
    yield Row("the same, 10^7 points", "field", (ten, together), against, at_most=8.0)


def of_score(folder: Path) -> Iterator[Row]:
    """Time reading and judging a file of two million rows against NumPy that only reads it."""
    file = folder / "curve.csv"
    run = simulate(Parameters(), 1e-4 * ROWS, times=1e-4 * np.arange(ROWS))
    columns = np.column_stack([run.t, run.x, run.F])
    np.savetxt(file, columns, "%.9g", delimiter=",", header="time,x,F", comments="")
    times = best_of(
        3,
        lambda: score(read_curve(file), {}),
        lambda: np.loadtxt(file, delimiter=",", skiprows=1),
        count=ROWS,
    )
    yield Row("score, file of 2 10^6 rows", "row", times, "numpy.loadtxt", 4.0)


def of_records(folder: Path) -> Iterator[Row]:
    """Time reading a record of two million rows with decimal commas against NumPy, with points."""
    file, plain = folder / "record.csv", folder / "plain.csv"
    t = 1e-4 * np.arange(ROWS)
    columns = np.column_stack([t, 0.2 * np.sin(t), 0.2 * np.sin(t - 0.01), 50.0 * np.cos(t)])
    header = "t [s];command [m];position [m];force [N]"
    np.savetxt(plain, columns, "%.8f", delimiter=";", header=header, comments="")
    file.write_text(plain.read_text(encoding="utf-8").replace(".", ","), encoding="utf-8")
    times = best_of(
        3,
        lambda: read_record(file),
        lambda: np.loadtxt(plain, delimiter=";", skiprows=1),
        count=ROWS,
    )
    yield Row("record, file of 2 10^6 rows", "row", times, "numpy.loadtxt", 4.0)


def of_page(folder: Path) -> Iterator[Row]:
    """Time the page's redraw after a move of a slider; nothing, and a word, without a browser."""
    file = folder / "stick-slip.html"
    file.write_text(page(), encoding="utf-8")
    try:
        opening = measure_opening(file)
        places = measure_moves(file)
    except NoBrowserError as error:
        print(f"The page is not measured: {error}.")
        return
    if opening.shift:
        raise RuntimeError(f"the page moves after its first picture: {opening.shift:g}")
    yield Row("page, file to first picture", "opening", (opening.first,))
    for place, each in places.items():
        what = f"page, slider to redraw, {place}:"
        yield Row(f"{what} median", "move", (each["median"], 8e-3), "limit of 8 ms", 1.0)
        yield Row(f"{what} 95 %", "move", (each["late"], 16e-3), "limit of 16 ms", 1.0)
    times = places["top"]
    seen = times["seen"]
    yield Row("page, slider to layout: median", "move", (times["work"],))
    yield Row("page, slider to screen: median", "move", (seen,))
    # Drawn one by one they would take a hundred redraws.
    what = "page, 100 moves at once to screen"
    yield Row(what, "burst", (times["burst"], seen), "one move", 5.0)
    yield Row("page, move after those", "move", (times["after"], seen), "one move")


def measure() -> Iterator[Row]:
    """Measure everything."""
    with tempfile.TemporaryDirectory(prefix="stickslip-bench-") as name:
        folder = Path(name)
        reading = (of_memory, of_score, of_records)
        for part in (of_python_fmu, of_native_fmu, of_axis, of_studies, *reading, of_page):
            yield from part(folder)
        for other in (of_native_batches, of_stribeck, of_block, of_fields):
            yield from other()


def _time(seconds: float) -> str:
    units = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns"))
    factor, unit = next((pair for pair in units if seconds * pair[0] >= 1.0), units[-1])
    return f"{seconds * factor:.3g} {unit}"


def as_table(rows: list[Row]) -> Table:
    """Return the rows as a table."""
    table = Table(title="stickslip benchmarks: best of interleaved rounds")
    for heading in ("what", "per", "ours", "yardstick", "ratio", "limit", "against"):
        table.add_column(heading, justify="left" if heading in ("what", "against") else "right")
    for row in rows:
        limits = [] if row.limit is None else [f"{row.limit:.2f}"]
        limits += [] if row.at_most is None else [_time(row.at_most)]
        limit = ", ".join(limits) + ("" if row.held else " exceeded")
        times = [*map(_time, row.times), ""][:2]
        ratio = "" if row.ratio is None else f"{row.ratio:.2f}"
        table.add_row(row.what, row.unit, *times, ratio, limit, row.against)
    return table


def main() -> None:
    """Measure, print the table, write the JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("build/bench.json"))
    target = parser.parse_args().output
    rows = list(measure())
    Console(width=120).print(as_table(rows))
    target.parent.mkdir(parents=True, exist_ok=True)
    found = [{**row._asdict(), "ratio": row.ratio} for row in rows]
    target.write_text(json.dumps(found, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
