"""What docs/importing.md warns of, acted out.

Each function imports the importer that it is about: the others may be missing.
"""

from typing import Any


def ramp(fmu: str, _: Any) -> Any:
    """Return v and x_pull where FMPy's table of inputs rises from 0 to 1 m/s in 1 s."""
    import fmpy
    import numpy as np

    table = np.array(
        [(0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0)],
        dtype=[(name, np.float64) for name in ("time", "v", "load", "F_ext")],
    )
    result = fmpy.simulate_fmu(
        fmu, stop_time=0.3, output_interval=0.1, input=table, output=["v", "x_pull"]
    )
    return [result["v"].tolist(), result["x_pull"].tolist()]


def tunable(fmu: str, _: Any) -> Any:
    """Return F and z where k has a column in FMPy's table and doubles at 0.1 s."""
    import fmpy
    import numpy as np

    table = np.array(
        [(0.0, 0.02, 0.0, 0.0, 1e3), (0.1, 0.02, 0.0, 0.0, 2e3), (0.2, 0.02, 0.0, 0.0, 2e3)],
        dtype=[(name, np.float64) for name in ("time", "v", "load", "F_ext", "k")],
    )
    result = fmpy.simulate_fmu(
        fmu, stop_time=0.2, output_interval=0.05, input=table, output=["F", "z"]
    )
    return [result["F"].tolist(), result["z"].tolist()]


def coarse(fmu: str, _: Any) -> Any:
    """Return x_pull of a container with steps of 0.01 s, at communication steps of 0.015 s."""
    import fmpy

    from .by_fmucontainer import nest

    result = fmpy.simulate_fmu(
        nest(fmu, 0.01), stop_time=0.06, output_interval=0.015, output=["a.x_pull"]
    )
    return result["a.x_pull"].tolist()


def pending(fmu: str, _: Any) -> Any:
    """Return x_pull after the first step of a second run in Ecos, v set just before the reset."""
    from .by_ecospy import simulation

    with simulation(fmu, {"start": {}, "step": 0.01}) as opened:
        opened.init()
        opened.step()
        opened.set_real("block::v", 0.05)
        opened.reset()
        opened.init()
        opened.step()
        return opened.get_real("block::x_pull")


def standing_still(fmu: str, _: Any) -> Any:
    """Return x_pull before and after a reset through proxyfmu, and after ten steps more."""
    from .by_ecospy import simulation
    from .by_proxyfmu import prepare, uri

    prepare()
    shown = []
    with simulation(uri(fmu), {"start": {}, "step": 0.01}) as opened:
        opened.init()
        opened.step(5)
        shown.append(opened.get_real("block::x_pull"))
        opened.reset()
        opened.init()
        shown.append(opened.get_real("block::x_pull"))
        opened.step(10)
        shown.append(opened.get_real("block::x_pull"))
    return shown


def all_zero(fmu: str, _: Any) -> Any:
    """Return what Ecos shows of the block after it refused a k between two steps."""
    from .by_ecospy import simulation

    with simulation(fmu, {"start": {}, "step": 0.01}) as opened:
        opened.init()
        opened.step(50)
        opened.set_real("block::k", -1.0)
        opened.step(2)
        names = ("m", "k", "x_pull", "F_s", "x")
        return [opened.get_time(), *(opened.get_real(f"block::{name}") for name in names)]
