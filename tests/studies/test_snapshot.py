"""Pressures for pictures: shapes, places and, over the chord, the lift of the strips."""

import numpy as np
import openmdao.api as om

from hera_om.aircraft import loads
from hera_om.components.aero import Aerodynamics
from hera_om.studies.snapshot import panel_pressures

WING = """name = "plate"
reference = { S_m2 = 12.0, c_m = 2.0, b_m = 6.0, x_m = 0.5, y_m = 0.0, z_m = 0.0 }
flight = { mach = 0.0, alpha_deg = 3.0 }
lattice = { spacing = "uniform" }

[[surface]]
name = "plate"
chordwise = 4
spanwise = 3
polar = { cd_min = 1e-9, cl_at_cd_min = 0.0, k = 0.0, re = 1e7, cl_max = 1.5 }

[[surface.section]]
name = "root"
x_le_m = 0.3
y_m = 0.0
z_m = 0.0
chord_m = 2.0
twist_deg = 0.0
airfoil = "flat"

[[surface.section]]
name = "tip"
x_le_m = 0.3
y_m = 3.0
z_m = 0.0
chord_m = 2.0
twist_deg = 0.0
airfoil = "flat"
"""


def test_pressures_over_the_chord_are_the_lift():
    """The first value holds from the leading edge to the first condition, three quarters of a panel."""
    aircraft = loads(WING)
    (found,) = panel_pressures(aircraft, aircraft, {"alpha": 5.0})
    corners, pressure = np.asarray(found["corners"]), np.asarray(found["pressure"])
    assert found["name"] == "plate" and corners.shape == (5, 4, 3) and pressure.shape == (4, 3)
    np.testing.assert_allclose(corners[[0, -1], 0], [[0.3, 0.0, 0.0], [2.3, 0.0, 0.0]], atol=1e-12)
    assert np.all(np.diff(pressure, axis=0) < 0.0) and np.all(pressure > 0.0)
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft), promotes=["*"])
    problem.setup()
    problem.set_val("alpha", 5.0)
    problem.run_model()
    normal = (pressure.sum(axis=0) - pressure[0] / 4) / 4
    np.testing.assert_allclose(np.mean(normal), problem.get_val("CZ")[0], rtol=1e-6)
