"""PteraSoftware, steady rings, full model with as many unknowns. Usage: pterasoftware_case.py UNKNOWNS"""

import sys
import time
from pathlib import Path

import numpy as np
import pterasoftware as ps

sys.path.insert(0, str(Path(__file__).parents[1]))
import measure
import wing

nc, ns = wing.PANELS[int(sys.argv[1])]
ns //= 2
segments = 10 if ns % 10 == 0 else 5


def airplane():
    """A new one for every solve: its panels can be used once."""
    y, x, chord = wing.sections(segments + 1)
    places = np.stack([np.diff(x, prepend=0.0), np.diff(y, prepend=0.0), 0 * x], axis=1)
    cuts = [
        ps.geometry.wing_cross_section.WingCrossSection(
            airfoil=ps.geometry.airfoil.Airfoil(name="naca0012"),
            control_surface_symmetry_type="symmetric",
            num_spanwise_panels=None if i == segments else ns // segments,
            chord=float(chord[i]),
            Lp_Wcsp_Lpp=tuple(places[i]),
            spanwise_spacing=None if i == segments else "uniform",
        )
        for i in range(segments + 1)
    ]
    half = ps.geometry.wing.Wing(
        wing_cross_sections=cuts,
        symmetric=True,
        symmetryNormal_G=(0.0, 1.0, 0.0),
        symmetryPoint_G_Cg=(0.0, 0.0, 0.0),
        num_chordwise_panels=nc,
        chordwise_spacing="uniform",
        Ler_Gs_Cgs=(-wing.X_REF, 0.0, 0.0),
    )
    return ps.geometry.airplane.Airplane(wings=[half], s_ref=wing.AREA, c_ref=wing.CHORD, b_ref=wing.SPAN)


def solve(made):
    point = ps.operating_point.OperatingPoint(rho=wing.DENSITY, vCg__E=wing.SPEED, alpha=wing.ALPHA)
    problem = ps.problems.SteadyProblem(airplanes=[made], operating_point=point)
    solver = ps.steady_ring_vortex_lattice_method.SteadyRingVortexLatticeMethodSolver(problem)
    solver.run(calculate_streamlines=False)
    return made


def timed():
    """CPU seconds of one solve without the making of the airplane."""
    made = airplane()
    start = time.process_time()
    solve(made)
    return time.process_time() - start


made = airplane()
measure.emit("PteraSoftware", "solve memory", memory=measure.extra_memory(lambda: solve(made)))
measure.emit("PteraSoftware", "solve", min(timed() for _ in range(5)), CL=float(-made.forceCoefficients_W[2]))
