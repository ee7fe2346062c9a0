"""The fuselage by slender-body theory in the whole chain: what it adds to wing, tail and fin."""

import math

import openmdao.api as om
import pytest

from hera_om.aircraft import dumps, load_aircraft, loads
from hera_om.components.aero import Aerodynamics
from hera_om.physics.fuselage import Fuselage
from hera_om.physics.slender_body import Crossflow, bare_body_loads

BODY = Fuselage(20.0, 2.0, 2.0, 3.0, 6.0)
TABLE = """
[fuselage]
length_m = 20.0
width_m = 2.0
height_m = 2.0
nose_length_m = 3.0
tail_length_m = 6.0
model = "{model}"
"""
COARSE = {
    "lattice.wing_chordwise": 2,
    "lattice.tail_chordwise": 2,
    "lattice.tail_spanwise": 6,
    "lattice.fin_spanwise": 5,
}
NAMES = ("CL", "CL_alpha", "Cm_alpha", "CY_beta", "Cn_beta", "CDi", "CDi_near", "CD_fuselage")


def solved(model, height):
    """The shipped wing, tail and fin, moved behind a nose, the wing to a height above its axis, with a fuselage."""
    base = load_aircraft("wing_tail", COARSE | {"wing.x_le_root_m": 8.0, "wing.z_root_m": height})
    text = dumps(base).replace('convention = "avl"', 'convention = "ring"')
    problem = om.Problem(reports=False)
    aircraft = loads(text + TABLE.format(model=model))
    problem.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft, lateral=True), promotes=["*"])
    problem.setup()
    problem.run_model()
    return {name: float(problem.get_val(name)[0]) for name in NAMES}


@pytest.fixture(scope="module")
def mid():
    return solved("munk", 0.0), solved("slender", 0.0)


def test_in_sideslip_the_body_adds_about_its_own_side_force():
    """The fin gains a little by the flow round the body; a wing on the skin must not double its load."""
    munk, slender = (solved(model, 0.9) for model in ("munk", "slender"))
    own = float(bare_body_loads(BODY, flow=Crossflow(0.0, 1.0, 0.0, 0.0, 0.0)).force[1]) / 61.0
    assert own < -0.03
    assert 0.8 * own > slender["CY_beta"] - munk["CY_beta"] > 1.8 * own


def test_near_field_and_trefftz_plane_agree_in_the_flow_of_the_body(mid):
    """The body's flow is in the condition and not in the force: its reaction is on the body."""
    assert mid[1]["CDi_near"] == pytest.approx(mid[1]["CDi"], rel=0.03)


def test_lift_slope_of_wing_and_body(mid):
    """Wing with carry-over (1 - t^2)^2 of the wing alone, and the nose by its base area (NACA Report 1307)."""
    munk, slender = mid
    share = (1.0 / 13.525) ** 2
    expected = munk["CL_alpha"] * (1 - share) ** 2 + 2 * math.pi / 61.0
    assert slender["CL_alpha"] == pytest.approx(expected, rel=0.02)
