"""The HERA-like aircraft with its six rotors: one state with all longitudinal power-on derivatives.

    OMP_NUM_THREADS=1 XLA_FLAGS=--xla_cpu_multi_thread_eigen=false python benchmarks/bench_coupled.py

CPU milliseconds of the process for one call, least of several means, one thread, without compiling: geometry to
factorised lattice (`assembly`), and at a new incidence the equilibrium with its derivatives and loads (`state`); with
the rotors and without them. The aims: both together under 500 ms, and at most three times those without rotors.
"""

import jax
import openmdao.api as om
from measure import cpu_time, emit

from hera_om.aircraft import Aircraft, load_aircraft
from hera_om.components.aero import Aerodynamics
from hera_om.components.aero_stages import stages

PANELS = {"wing_chordwise": 13}


def seconds_of(aircraft: Aircraft) -> tuple[int, float, float]:
    """Panels of the half model, seconds of the assembly and of a state."""
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft), promotes=["*"])
    problem.setup()
    problem.final_setup()
    aero = problem.model.aero
    static, values = aero._static(), aero.values(aero._inputs)
    compiled = stages(False)
    given = (static, aero.base, aero.constants)
    system = jax.block_until_ready(compiled.assemble(*static, *given[1:], values))
    _, found = compiled.state(*given, system, values)
    assert float(found.outputs["coupling_residual"]) < 1e-12
    return (
        system.lattice.chord.shape[0],
        cpu_time(lambda: jax.block_until_ready(compiled.assemble(*static, *given[1:], values))),
        cpu_time(lambda: jax.block_until_ready(compiled.state(*given, system, values))),
    )


def main() -> None:
    """Time the aircraft with its rotors and without them."""
    whole = load_aircraft("hera_like")
    whole = whole.model_copy(update={"lattice": whole.lattice.model_copy(update=PANELS)})
    kept = tuple(v for v in whole.variables if not v.path.startswith("rotor."))
    areas = tuple(d.model_copy(update={"rotor": None}) for d in whole.drag_area)
    bare = whole.model_copy(update={"rotor": (), "drag_area": areas, "variables": kept})
    totals = []
    for name, aircraft in (("with rotors", whole), ("without rotors", bare)):
        panels, assembly, state = seconds_of(aircraft)
        totals.append(assembly + state)
        emit("hera_om", f"{name}, assembly", assembly, panels=panels)
        emit("hera_om", f"{name}, state", state)
        emit("hera_om", f"{name}, both", totals[-1])
    emit("hera_om", "with rotors over without", ratio=totals[0] / totals[1])


if __name__ == "__main__":
    main()
