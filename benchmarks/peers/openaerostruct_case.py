"""OpenAeroStruct, aerodynamic point, half model: one solve. Usage: openaerostruct_case.py UNKNOWNS"""

import itertools
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENMDAO_REPORTS", "0")
import numpy as np
import openmdao.api as om
from openaerostruct.aerodynamics.aero_groups import AeroPoint

sys.path.insert(0, str(Path(__file__).parents[1]))
import measure
import wing

nodes = wing.mesh(int(sys.argv[1]))[:, ::-1] * np.array([1.0, -1.0, 1.0])  # tip first, on the port side
surface = {
    "name": "wing",
    "symmetry": True,
    "S_ref_type": "projected",
    "fem_model_type": "tube",
    "mesh": nodes,
    "CL0": 0.0,
    "CD0": 0.0,
    "with_viscous": False,
    "with_wave": False,
    "k_lam": 0.05,
    "t_over_c_cp": np.array([0.12]),
    "c_max_t": 0.303,
}
problem = om.Problem(reports=False)
inputs = problem.model.add_subsystem("inputs", om.IndepVarComp(), promotes=["*"])
state = {
    "v": (wing.SPEED, "m/s"),
    "alpha": (wing.ALPHA, "deg"),
    "Mach_number": (0.0, None),
    "re": (1e6, "1/m"),
    "rho": (wing.DENSITY, "kg/m**3"),
    "cg": (np.array([wing.X_REF, 0, 0]), "m"),
}
for name, (value, units) in state.items():
    inputs.add_output(name, val=value, units=units)
inputs.add_output("mesh", val=nodes, units="m")
inputs.add_output("thickness", val=0.12 * np.ones(nodes.shape[1] - 1))
problem.model.add_subsystem("aero", AeroPoint(surfaces=[surface]), promotes_inputs=list(state))
for target in ("wing.def_mesh", "aero_states.wing_def_mesh"):
    problem.model.connect("mesh", f"aero.{target}")
problem.model.connect("thickness", "aero.wing_perf.t_over_c")
problem.setup(mode="rev")
shift = itertools.cycle((0.0, 1e-3))


def solve():
    problem["alpha"] = wing.ALPHA + next(shift)
    problem.run_model()


measure.emit("OpenAeroStruct", "solve memory", memory=measure.extra_memory(solve))
measure.emit("OpenAeroStruct", "solve", measure.cpu_time(solve, repeats=2), CL=float(problem["aero.CL"][0]))
