"""The block in Ecos, in a process of its own. StickSlip.fmu lies in the working folder.

To be started with libpython preloaded: LD_PRELOAD="$LIBPYTHON" python with_proxyfmu.py
"""

from pathlib import Path

from ecospy import EcosSimulation, EcosSimulationStructure

fmu = Path("StickSlip.fmu").resolve()

with EcosSimulationStructure() as structure:
    structure.add_model("block", f"proxyfmu://localhost?file={fmu}")
    structure.add_parameter_set("start", {"block::c": 2.0})
    with EcosSimulation(structure=structure, step_size=0.01) as simulation:
        simulation.init(parameter_set="start")
        simulation.step(500)
        simulation.set_real("block::v", 0.05)
        simulation.step(500)
        x, T = simulation.get_real("block::x"), simulation.get_real("block::T")
        n_slips = simulation.get_integer("block::n_slips")
        # Ecos goes on where the block refuses a value, and then shows 0 for everything.
        if simulation.get_real("block::m") == 0.0:
            raise SystemExit("the block refused a value, and its message is lost here")
        simulation.terminate()

print(f"x = {x:.9f} m, T = {T:.9f} s, {n_slips} slips")
