"""What Ecos can do, through ecospy."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import ecospy

from .by_ecospy import simulation
from .offering import offers

_STEP = 0.01
_WORDS = {bool: "bool", int: "integer", float: "real", str: "string"}


class Probes:
    """What may be tried on an FMU."""

    def at(self, fmu: str) -> str:
        """Return what Ecos calls the FMU by."""
        return fmu

    @contextmanager
    def begun(self, fmu: str, **start: float) -> Iterator[Any]:
        """Open a simulation of one block and initialize it."""
        with simulation(self.at(fmu), {"start": start, "step": _STEP}) as opened:
            opened.init(parameter_set="start")
            yield opened

    def kind(self, fmu: str, value: Any) -> bool:
        """Set an input of some kind, step, and find it in the output."""
        word = _WORDS[type(value)]
        with self.begun(fmu) as opened:
            try:
                getattr(opened, f"set_{word}")("block::given", value)
            except Exception as error:
                # Ecos raises no class of its own.
                if "property block::given found" not in str(error):
                    raise
                return False
            opened.step()
            return bool(getattr(opened, f"get_{word}")("block::shown") == value)

    def inputs(self, fmu: str) -> bool:
        """Change an input between two steps."""
        with self.begun(fmu) as opened:
            opened.step()
            opened.set_real("block::v", 0.05)
            opened.step()
            return bool(abs(opened.get_real("block::x_pull") - _STEP * 0.07) < 1e-15)

    def parameters(self, fmu: str) -> bool:
        """Change a tunable parameter between two steps."""
        with self.begun(fmu) as opened:
            opened.step()
            opened.set_real("block::k", 2000.0)
            opened.step()
            return bool(opened.get_real("block::F") == 2000.0 * opened.get_real("block::z"))

    def state(self, fmu: str) -> bool:
        """Look for calls that keep and restore a state."""
        return offers("save|restore|state", ecospy.EcosSimulation)

    def serialize(self, fmu: str) -> bool:
        """Look for calls that give a state as bytes."""
        return offers("serial", ecospy.EcosSimulation)

    def reset(self, fmu: str) -> bool:
        """Begin again in the same simulation."""
        with self.begun(fmu) as opened:
            opened.step(30)
            first = opened.get_real("block::x")
            opened.set_real("block::v", 0.05)
            opened.step()
            opened.reset()
            opened.init(parameter_set="start")
            opened.step(30)
            return bool(opened.get_real("block::x") == first)

    def variable_step(self, fmu: str) -> bool:
        """Step for two lengths, the second no multiple of the first."""
        with self.begun(fmu) as opened:
            opened.step_for(0.01)
            opened.step_for(0.037)
            return bool(abs(opened.get_real("block::x_pull") - 0.02 * 0.047) < 1e-15)

    def several(self, fmu: str) -> bool:
        """Run two instances in one simulation."""
        with ecospy.EcosSimulationStructure() as structure:
            for name in ("one", "other"):
                structure.add_model(name, self.at(fmu))
            structure.add_parameter_set("start", {"other::v": 0.05})
            with ecospy.EcosSimulation(structure=structure, step_size=_STEP) as opened:
                opened.init(parameter_set="start")
                opened.step(10)
                ways = opened.get_real("one::x_pull"), opened.get_real("other::x_pull")
                opened.terminate()
        return bool(max(abs(ways[0] - 0.002), abs(ways[1] - 0.005)) < 1e-15)

    def units(self, fmu: str) -> bool:
        """Look for a unit in the table that Ecos writes, and for a call that gives units."""
        with simulation(self.at(fmu), {"start": {}, "step": _STEP}) as opened:
            opened.add_csv_writer("results.csv")
            opened.init()
            opened.step()
        head = Path("results.csv").read_text(encoding="utf-8").splitlines()[0]
        assert "block::F[REAL]" in head
        return "[N]" in head or offers("unit", ecospy.EcosSimulation)

    def log(self, fmu: str) -> None:
        """Have the FMU send a warning, with messages asked for."""
        ecospy.EcosLib.set_log_level("trace")
        with self.begun(fmu, mu_k=0.9) as opened:
            opened.step()

    def refused(self, fmu: str) -> str:
        """Set what the FMU refuses; return what comes of it."""
        with simulation(self.at(fmu), {"start": {"k": -1.0}, "step": _STEP}) as opened:
            if not opened.init(parameter_set="start"):
                return f"init() returns False: {ecospy.EcosLib.get_last_error()}"
            return _gone_on(opened)

    def refused_later(self, fmu: str) -> str:
        """Set it between two steps; return what comes of it."""
        with self.begun(fmu) as opened:
            opened.step()
            opened.set_real("block::k", -1.0)
            return _gone_on(opened)


def _gone_on(opened: Any) -> str:
    """Step a block that has refused something; return how it goes on."""
    before = opened.get_time()
    assert opened.step(3) > before
    # At rest most outputs are 0, but never these two.
    shown = {opened.get_real(f"block::{name}") for name in ("m", "F_s")}
    return "goes on: every output is 0" if shown == {0.0} else f"goes on with {shown}"


PROBES = Probes()
