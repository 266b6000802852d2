"""The block in Ecos, through ecospy. StickSlip.fmu lies in the working folder."""

from ecospy import EcosSimulation, EcosSimulationStructure

with EcosSimulationStructure() as structure:
    structure.add_model("block", "StickSlip.fmu")
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
            raise SystemExit("the block refused a value: see its message above")
        simulation.terminate()

print(f"x = {x:.9f} m, T = {T:.9f} s, {n_slips} slips")
