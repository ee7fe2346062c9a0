"""Two halves of a wing, and the same wing as one surface without an image: two systems of half size, and a full one."""

import openmdao.api as om
import pytest

from hera_om.aircraft import loads
from hera_om.components.aero import Aerodynamics
from hera_om.components.aero_plan import AeroPlan

HEAD = """name = "wing"
reference = { S_m2 = 16.0, c_m = 2.0, b_m = 8.0, x_m = 0.5, y_m = 0.2, z_m = 0.0 }
flight = { mach = 0.3, alpha_deg = 4.0, beta_deg = 6.0, p_hat = 0.03, q_hat = 0.01, r_hat = -0.02 }
lattice = { spacing = "uniform" }

[[surface]]
name = "plate"
chordwise = 3
polar = { cd_min = 0.006, cl_at_cd_min = 0.2, k = 0.01, re = 1e7, cl_max = 1.5 }
"""
SECTION = """
[[surface.section]]
name = "{name}"
x_le_m = {x}
y_m = {y}
z_m = {z}
chord_m = 2.0
twist_deg = {twist}
airfoil = "NACA 2412"
"""
ROOT = SECTION.format(name="root", x=0.0, y=0.0, z=0.0, twist=0.0)
TIP = SECTION.format(name="tip", x=1.0, y=4.0, z=0.2, twist=-2.0)
PORT = SECTION.format(name="port", x=1.0, y=-4.0, z=0.2, twist=-2.0)
HALVES = HEAD + "spanwise = 8\n" + ROOT + TIP
WHOLE = HEAD + 'side = "one"\nspanwise = 16\n' + PORT + ROOT + TIP
NAMES = (
    "CL",
    "CD",
    "CDi",
    "CDi_near",
    "CY",
    "Cl",
    "Cm",
    "Cn",
    "CL_alpha",
    "Cl_beta",
    "Cn_p",
    "CY_r",
    "Cm_q",
    "lift_margin",
)


def solved(text, *, lateral=True):
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("aero", Aerodynamics(aircraft=loads(text), lateral=lateral), promotes=["*"])
    problem.setup()
    problem.run_model()
    return {name: float(problem.get_val(name)[0]) for name in NAMES}


def test_two_halves_are_the_whole_wing():
    """At a state without any symmetry, every number to rounding."""
    halves, whole = solved(HALVES), solved(WHOLE)
    for name in NAMES:
        assert whole[name] == pytest.approx(halves[name], rel=1e-10, abs=1e-13), name
    assert abs(halves["CY"]) > 1e-4 and abs(halves["Cn"]) > 1e-3


def test_a_surface_without_an_image_needs_both_halves():
    with pytest.raises(ValueError, match="'plate' has no mirror image"):
        solved(WHOLE, lateral=False)


def test_rates_by_which_coefficients_are_differentiated():
    """By beta-dot in both halves only; by neither rate where a surface has no image."""
    plans = AeroPlan(loads(HALVES)), AeroPlan(loads(HALVES), True), AeroPlan(loads(WHOLE), True)
    rates = [tuple(by for by in plan.by if by.endswith("dot")) for plan in plans]
    assert rates == [("alphadot",), ("alphadot", "betadot"), ()]
