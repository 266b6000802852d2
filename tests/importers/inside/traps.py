"""What docs/importing.md warns of, acted out.

Each function imports the importer that it is about: the others may be missing.
"""

from typing import Any


def tabled(fmu: str, names: list[str], rows: list[list[float]], shown: list[str]) -> Any:
    """Return outputs, step by step of 0.05 s, of a run with a table of inputs in FMPy."""
    import fmpy
    import numpy as np

    table = np.array([tuple(row) for row in rows], dtype=[(name, np.float64) for name in names])
    result = fmpy.simulate_fmu(
        fmu, stop_time=rows[-1][0], output_interval=0.05, input=table, output=shown
    )
    return [result[name].tolist() for name in shown]


def coarse(fmu: str) -> Any:
    """Return x_pull of a container with steps of 0.01 s, at communication steps of 0.015 s."""
    import fmpy

    from .by_fmucontainer import Fmucontainer

    container = Fmucontainer.nest(fmu, 0.01)
    result = fmpy.simulate_fmu(
        container, stop_time=0.06, output_interval=0.015, output=["a.x_pull"]
    )
    return result["a.x_pull"].tolist()


def pending(fmu: str) -> Any:
    """Return x_pull after the first step of a second run in Ecos, v set just before the reset."""
    from .by_ecospy import Ecos

    with Ecos(fmu) as simulation:
        simulation.step()
        simulation.set("v", 0.05)
        simulation.reset()
        simulation.step()
        return simulation.get("x_pull")


def standing_still(fmu: str) -> Any:
    """Return x_pull before a reset through proxyfmu, after it, and after a step more."""
    from .by_ecospy import Ecos
    from .by_proxyfmu import Proxyfmu

    with Proxyfmu(fmu) as simulation:
        simulation.step()
        shown = [simulation.get("x_pull")]
        Ecos.reset(simulation)
        for _ in range(2):
            shown.append(simulation.get("x_pull"))
            simulation.step()
        return shown
