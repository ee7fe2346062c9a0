"""OptVL (AVL with adjoint), half model: solve, stability derivatives, gradients. Usage: optvl_case.py UNKNOWNS"""

import itertools
import sys
from pathlib import Path

import numpy as np
from optvl import OVLSolver

sys.path.insert(0, str(Path(__file__).parents[1]))
import measure
import wing

unknowns = int(sys.argv[1])
nc, ns = wing.PANELS[unknowns]
y, x, chord = wing.sections(wing.STATIONS)
none = np.zeros(wing.STATIONS)
surface = {
    "num_sections": wing.STATIONS,
    "num_controls": none.astype(int),
    "num_design_vars": none.astype(int),
    "component": 1,
    "scale": np.ones(3),
    "translate": np.zeros(3),
    "angle": 0.0,
    "wake": 1,
    "albe": 1,
    "load": 1,
    "claf": none + 1,
    "xles": x,
    "yles": y,
    "zles": none,
    "chords": chord,
    "aincs": none,
    "nchordwise": nc,
    "cspace": 0.0,
    "nspan": ns,
    "sspace": 0.0,
    "use surface spacing": True,
    "naca": np.array(["0012"] * wing.STATIONS),
}
case = {
    "title": "benchmark",
    "mach": 0.0,
    "iysym": 1,
    "izsym": 0,
    "zsym": 0.0,
    "Sref": wing.AREA,
    "Cref": wing.CHORD,
    "Bref": wing.SPAN,
    "XYZref": np.array([wing.X_REF, 0, 0]),
    "CDp": 0.0,
    "surfaces": {"Wing": surface},
}
solver = OVLSolver(input_dict=case)
flip = itertools.cycle((0.0, 1e-6))


def solve():
    """A changed twist, so that matrix and factors are new as in a design loop."""
    solver.set_surface_params({"Wing": {"aincs": np.full(wing.STATIONS, next(flip))}})
    solver.set_variable("alpha", wing.ALPHA)
    solver.execute_run()


def derivatives():
    solve()
    solver.get_stab_derivs()


def gradient():
    solve()
    solver.execute_run_sensitivities(["CL", "CD", "Cm"])


def gradient_of_derivatives():
    solve()
    solver.execute_run_sensitivities([], stab_derivs=["dCL/dalpha", "dCm/dalpha", "dCm/dq'"])


measure.emit("OptVL", "solve memory", memory=measure.extra_memory(solve))
values = solver.get_total_forces()
measure.emit("OptVL", "solve", measure.cpu_time(solve), CL=float(values["CL"]), Cm=float(values["Cm"]))
measure.emit("OptVL", "derivatives", measure.cpu_time(derivatives))
measure.emit("OptVL", "gradient", measure.cpu_time(gradient, repeats=1))
measure.emit("OptVL", "gradient of derivatives", measure.cpu_time(gradient_of_derivatives, repeats=1))
