"""The yardstick: a stock pythonfmu slave that has our variables and does nothing."""

from pathlib import Path

from pythonfmu.builder import FmuBuilder

from stickslip_fmu.spec import TABLE

_SOURCE = """\
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Integer, Real

KINDS = {{"Real": Real, "Integer": Integer, "Boolean": Boolean}}
VARIABLES = {variables!r}


class EmptySlave(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name, kind, causality, variability, start in VARIABLES:
            setattr(self, name, start)
            self.register_variable(
                KINDS[kind](
                    name,
                    causality=Fmi2Causality[causality],
                    variability=Fmi2Variability[variability],
                )
            )

    def do_step(self, current_time, step_size):
        return True
"""


def build_empty_slave(folder: Path) -> Path:
    """Build the empty slave's FMU in `folder` and return its path."""
    variables = [
        (each.name, each.kind, each.causality, each.variability, each.start or 0)
        for each in TABLE.rows
    ]
    script = folder / "empty_slave_script.py"
    script.write_text(_SOURCE.format(variables=variables), encoding="utf-8")
    target = folder / "EmptySlave.fmu"
    FmuBuilder.build_FMU(script, target)
    return target
