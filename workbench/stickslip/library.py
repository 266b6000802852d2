"""The block from Python: simulated, its cycle and its limits, packed as an FMU.

Arguments are numbers in SI, or texts with a unit (``"20 mm/s"``); results are in SI. Nothing is
printed, and what needs time takes `progress`.
"""

from __future__ import annotations

import math
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import stickslip_ref
from stickslip.files import make_folder, write
from stickslip.parameters import ParameterError, Parameters, above_zero
from stickslip.results import Shown
from stickslip.runs import Run as Samples
from stickslip.runs import (
    check_slips,
    csv_bytes,
    experiment,
    reference_parameters,
    simulate_fmu,
    simulate_reference,
)
from stickslip.show.tables import critical_table, cycle_rows, cycle_table, motions, theory_table
from stickslip_fmu.laws.named import COULOMB_NAME

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from stickslip.runs import Floats
    from stickslip.systems import System

_MOST_SLIPS = (1_000_000, 10_000)
"""Slips that a run of the block, of the reference may have: each takes less than a minute."""


@dataclass(frozen=True, repr=False)
class Run(Samples, Shown):
    """A simulated run: samples of every output [SI], events, and the cycle they come to.

    ``run["x"]`` is an output by its name, ``run["time"]`` the time [s], each of shape (n,).
    """

    def __getitem__(self, name: str) -> Floats:
        column: Floats = self.samples[name]
        return column

    def __repr__(self) -> str:
        last = self.last
        return (
            f"<Run of the {self.engine}: {len(self.samples)} samples, "
            f"{self['time'][0]:g} to {last['time']:g} s, {last['n_slips']} slips, "
            f"last jump {last['delta_x']:.6g} m, period {last['T']:.6g} s>"
        )

    @property
    def _theory(self) -> stickslip_ref.Parameters | None:
        # The closed forms of the cycle are those of Coulomb's law.
        return _reference(self.parameters) if self.parameters.law == COULOMB_NAME else None

    def table(self) -> RenderableType:
        """Return the cycle beside the exact and the simplified one, for rich."""
        return cycle_table(self, self._theory)

    def to_dict(self) -> dict[str, Any]:
        """Return the cycle [SI]: measured in the run, exact and simplified."""
        rows = {
            row.name: {
                "measured": row.measured, "exact": row.exact, "simplified": row.simplified
            }
            for row in cycle_rows(self, self._theory)
        }  # fmt: skip
        return {"engine": self.engine, "slips": int(self.last["n_slips"]), "cycle": rows}

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the samples as a table of pandas, by time [s], units in ``attrs["units"]``."""
        from stickslip_design.datasets import need

        frame: pandas.DataFrame = need("pandas").DataFrame(self.samples).set_index("time")
        units = {row.name: row.unit for row in self.parameters.table.rows}
        frame.attrs["units"] = {str(name): units.get(str(name), "") for name in frame}
        return frame

    def plot(self) -> Figure:
        """Draw position and spring force over time."""
        from stickslip.show.plot import figure

        return figure(self)

    def write_csv(self, target: Path | str, option: str = "file") -> None:
        """Write the samples as a CSV file that fmpy reads; `option` names it in a refusal."""
        write(Path(target), csv_bytes(self.samples), option)

    def write_plot(self, target: Path | str) -> None:
        """Draw into a .png, .svg or .pdf file."""
        from stickslip.show.plot import write_plot

        write_plot(self, Path(target))


def simulate(
    p: Parameters | None = None,
    stop_time: float | str = 10.0,
    *,
    engine: str | Path = "block",
    start_time: float | str = 0.0,
    output_interval: float | str | None = None,
    most_slips: int | None = None,
    drawn: bool = False,
    progress: Callable[[float, float], None] = lambda done, total: None,
) -> Run:
    """Simulate one run, inputs held constant.

    Parameters
    ----------
    p
        The block; None: at its start values.
    stop_time, start_time
        Last and first time [s].
    engine
        ``"block"``: the FMU that `build` makes; ``"reference"``: the SciPy reference; or the path
        of an FMU.
    output_interval
        Distance of the samples [s]; None: 0.01 s, doubled until 1000 are enough.
    most_slips
        Slips that the run may have; None: 1,000,000, of the reference 10,000.
    drawn
        Whether a chosen interval is halved until a plot is smooth.
    progress
        Called with the time simulated and the time to simulate [s] after each step of an FMU.

    Raises
    ------
    ParameterError
        If an argument cannot be taken, or the run would have too many slips.
    FmuError, RuntimeError
        If the engine fails, or a law that is native alone finds no C compiler.
    """
    what = experiment(p or Parameters(), start_time, stop_time, output_interval, drawn=drawn)
    check_slips(what, most_slips or _MOST_SLIPS[engine == "reference"])
    if engine == "reference":
        run = simulate_reference(what)
    elif engine != "block":
        if isinstance(engine, str) and not Path(engine).exists():
            reason = "is neither block nor reference, nor the path of an FMU"
            raise ParameterError("engine", f" {engine!r} {reason}")
        run = simulate_fmu(what, Path(engine), progress)
    else:
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            run = simulate_fmu(what, _bare_fmu(Path(folder), what.parameters.law), progress)
    return Run(**{each.name: getattr(run, each.name) for each in fields(run)})


def _bare_fmu(folder: Path, law: str) -> Path:
    """Return the FMU of a law without its documentation, which takes nine tenths of the time."""
    from stickslip_fmu.laws.named import friction_law
    from stickslip_fmu.laws.native_only import NativeOnly

    if not isinstance(friction_law(law).law, NativeOnly):
        from stickslip_fmu.packer import build as packed

        return packed(folder, law=law)
    from stickslip_native.library import this_machine
    from stickslip_native.packer import build as compiled

    return compiled(folder, law=law, this_machine=this_machine())


@dataclass(frozen=True, repr=False)
class Cycle(Shown):
    """The steady cycle [SI], exact and as designers write it; NaN where there is none."""

    parameters: Parameters
    exact: stickslip_ref.Cycle
    simplified: stickslip_ref.SimplifiedCycle

    def __repr__(self) -> str:
        exact = self.exact
        return (
            f"<Cycle: jump {exact.delta_x:.6g} m, stick {exact.t_stick:.6g} s, "
            f"slip {exact.t_slip:.6g} s, simplified jump {self.simplified.delta_x:.6g} m>"
        )

    def table(self) -> RenderableType:
        """Return both columns, for rich."""
        return theory_table(self.exact, self.simplified)

    def to_dict(self) -> dict[str, Any]:
        """Return both columns [SI]."""
        return {"exact": asdict(self.exact), "simplified": asdict(self.simplified)}

    def plot(self) -> Figure:
        """Draw the start from rest, and three cycles or as many periods of the free block."""
        p, block = self.parameters, _reference(self.parameters)
        period = float(self.exact.T)
        if not period < math.inf:
            period = 2.0 * math.pi / float(block.w)
        load_up = float(block.F_s) / (p.k * abs(p.v)) if p.v else 0.0
        return simulate(p, load_up + 3.0 * period, engine="reference", drawn=True).plot()


def cycle(p: Parameters | None = None) -> Cycle:
    """Return the steady cycle of the block under Coulomb's friction law; docs/theory.md (6)-(13).

    Raises
    ------
    ValueError
        If the friction law is another one, which has no closed form.
    """
    p = p or Parameters()
    if p.law != COULOMB_NAME:
        raise ValueError(f"the friction law {p.law} has no closed form of its cycle: simulate it")
    reference = _reference(p)
    return Cycle(p, stickslip_ref.steady_cycle(reference), stickslip_ref.simplified(reference))


def _reference(p: Parameters) -> stickslip_ref.Parameters:
    with warnings.catch_warnings():
        # The engine gives its own warnings.
        warnings.simplefilter("ignore")
        return reference_parameters(p)


@dataclass(frozen=True, repr=False)
class Limits(Shown):
    """Where stick-slip ends.

    Attributes
    ----------
    velocities
        Intervals of the pulling velocity [m/s] at which a cycle with a stick exists, and at which
        steady sliding is unstable.
    regime
        What happens at the velocity of the block, where one was given; else None, as for a friction
        law without a stick.
    notes
        Warnings.
    v
        That velocity without its sign [m/s]; 0 where none was given.
    """

    velocities: stickslip_ref.CriticalVelocity
    regime: stickslip_ref.Regime | None
    notes: tuple[str, ...] = ()
    v: float = 0.0

    def __repr__(self) -> str:
        ranges = (
            ", ".join(f"{each.low:.6g} to {each.high:.6g} m/s" for each in found) or "nowhere"
            for found in (self.velocities.cycle, self.velocities.unstable)
        )
        return "<Limits: a cycle with a stick at {}; steady sliding unstable at {}>".format(*ranges)

    def table(self) -> RenderableType:
        """Return the intervals, for rich."""
        return critical_table(self.velocities, self.regime, self.v)

    def to_dict(self) -> dict[str, Any]:
        """Return intervals and regime [SI]."""
        words = motions(self.velocities, self.v) if self.v else None
        return {**self.velocities._asdict(), "at_v": self.regime.words if self.regime else words}

    def plot(self) -> Figure:
        """Draw the intervals over the pulling velocity."""
        from stickslip.show.plot import bars

        rows = {
            "cycle with a stick": self.velocities.cycle,
            "unstable sliding": self.velocities.unstable,
        }
        return bars(rows, self.velocities.between)


def critical(
    p: Parameters | None = None,
    *,
    between: tuple[float | str | None, float | str | None] = (None, None),
) -> Limits:
    """Return at which pulling velocities a cycle with a stick exists, and sliding is unstable.

    Parameters
    ----------
    p
        The block. Where its `v` was given, what happens there is answered too.
    between
        Lowest and highest velocity to search [m/s]; None: chosen, so that it holds `v`.

    Raises
    ------
    ValueError, RuntimeError
        If the reference refuses the values, or cannot finish.
    """
    p = p or Parameters()
    low, high = (
        None if each is None else above_zero(each, "m/s", name)
        for each, name in zip(between, ("from", "to"), strict=True)
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        reference = reference_parameters(p)
        found = stickslip_ref.critical_velocity(reference, p.law, between=(low, high))
        there = None
        if "v" in p.given:
            # The range searched holds it, where no given end is in its way.
            speed, (lowest, highest) = abs(p.v), found.between
            if low is None and 0.0 < speed < lowest:
                lowest = speed
            elif high is None and speed > highest:
                highest = speed
            if (lowest, highest) != found.between:
                found = stickslip_ref.critical_velocity(reference, p.law, between=(lowest, highest))
            if p.v and stickslip_ref.friction_law(p.law).sticks:
                there = stickslip_ref.regime(reference, p.law)
    speed = abs(p.v) if "v" in p.given else 0.0
    return Limits(found, there, tuple(str(each.message) for each in caught), speed)


def build(
    target: Path | str = "build",
    *,
    native: bool = False,
    fmi: Literal[2, 3] = 2,
    law: str = COULOMB_NAME,
    this_machine: bool = False,
    interface: Literal["cs", "me"] = "cs",
    ssp: System | None = None,
    axis: Path | str | None = None,
) -> Path:
    """Build the FMU with its documentation, or a system of it, and return its path.

    Parameters
    ----------
    target
        A folder, or a file that ends in ``.fmu``, of a system in ``.ssp``.
    native
        Whether it is the FMU in C, for all platforms, or with the compiler of `this_machine` for
        that alone.
    fmi
        Version of the standard; 3 is native.
    law
        Name of the friction law.
    interface
        ``"cs"`` for co-simulation, ``"me"`` for model exchange, in C. FMI 3.0 has both in one FMU.
    ssp
        A system that is ready to run, FMI 2.0: the block pulled by a "source" of speed, the table
        of an axis by its servo "drive", or a "pair" of such tables by one.
    axis
        File of the axis, which has a drive; default: that of ``stickslip design --example``.

    Raises
    ------
    OSError, ValueError
        If the file cannot be written, friction law or version is not known, or the axis is no
        system of FMUs.
    CompilerError
        If there is no compiler.
    """
    from stickslip.handbook import parts

    if fmi not in (2, 3):
        raise ParameterError("fmi", f" {fmi}: the standard is 2 or 3")
    if interface not in ("cs", "me"):
        raise ParameterError("interface", f" {interface}: it is cs or me")
    solved = interface == "me"
    place = Path(target)
    if axis is not None and ssp is None:
        raise ParameterError("axis", " goes with ssp drive or pair")
    if place.suffix == (".ssp" if ssp is None else ".fmu"):
        raise ValueError(f"{place}: the name of an FMU ends in .fmu, of a system in .ssp")
    if ssp is not None:
        from stickslip.systems import values_of, write_system

        if fmi != 2:
            raise ParameterError("fmi", f" {fmi}: a system (SSP 1.0) is made of FMUs 2.0")
        values = values_of(ssp, law, axis)
        is_file = place.suffix == ".ssp"
        make_folder(place.parent if is_file else place, "target")
        with tempfile.TemporaryDirectory(prefix="stickslip-") as made:
            block = build(made, native=native, law=law, this_machine=this_machine)
            file = place if is_file else place / f"{block.stem}_{ssp}.ssp"
            return write_system(ssp, file, values, block)
    folder = place.parent if place.suffix == ".fmu" else place
    if not native and fmi == 2 and not solved:
        from stickslip_fmu.packer import build as packed

        make_folder(folder, "target")
        return packed(place, parts(fmi, law=law), law)
    from stickslip_native.compiler import compiler_for
    from stickslip_native.packer import build as compiled

    files = parts(fmi, compiler_for(this_machine).runtime(), law)
    make_folder(folder, "target")
    return compiled(place, files, fmi, this_machine, law, solved and fmi == 2)
