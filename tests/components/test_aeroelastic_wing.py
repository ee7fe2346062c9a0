"""The option wing.structure.aeroelastic: the lattice's own operator, its coupling with the box, partials, failure."""

import numpy as np
import openmdao.api as om
import pytest

from hera_om.aircraft import load_aircraft
from hera_om.aircraft.mission import Lattice
from hera_om.components.aero import Aerodynamics
from hera_om.components.wingbox import WingBox

STRIPS, STATIONS = 8, 8


@pytest.fixture(scope="module")
def hera():
    """The reference aircraft without rotors on a coarse lattice, its wing elastic."""
    aircraft = load_aircraft("hera_like")
    lattice = Lattice(wing_spanwise=STRIPS, wing_chordwise=3, box_stations=STATIONS)
    structure = aircraft.wing.structure.model_copy(update={"aeroelastic": True})
    wing = aircraft.wing.model_copy(update={"structure": structure})
    areas = tuple(a for a in aircraft.drag_area if a.rotor is None)
    masses = tuple(m for m in aircraft.mass if not (m.tracks or "").startswith("rotor"))
    parts = {"lattice": lattice, "wing": wing, "rotor": (), "drag_area": areas, "mass": masses, "variables": ()}
    return aircraft.model_copy(update=parts)


def turned(aircraft, twist_deg):
    """Outputs of the lattice with the tip turned."""
    sections = list(aircraft.wing.section)
    sections[-1] = sections[-1].model_copy(update={"twist_deg": sections[-1].twist_deg + twist_deg})
    wing = aircraft.wing.model_copy(update={"section": tuple(sections)})
    problem = om.Problem(reports=False)
    problem.model.add_subsystem(
        "aero", Aerodynamics(aircraft=aircraft.model_copy(update={"wing": wing})), promotes=["*"]
    )
    problem.setup()
    problem.run_model()
    return {name: np.array(problem.get_val(name)) for name in ("strip_force", "strip_lift_by_twist", "y_span")}


def test_lift_by_twist_is_that_of_a_twisted_lattice(hera):
    """Tip turned by half a degree either way: meshes, matrices and all, against the operator."""
    up, down, here = turned(hera, 0.5), turned(hera, -0.5), turned(hera, 0.0)
    kink, tip = hera.wing.section[-2].y_m, hera.wing.section[-1].y_m
    twist = np.radians(np.clip((here["y_span"] - kink) / (tip - kink), 0.0, None))
    found, expected = here["strip_lift_by_twist"] @ twist, (up["strip_force"] - down["strip_force"])[:, 2]
    np.testing.assert_allclose(found, expected, atol=0.03 * np.max(expected))


def box(hera, values):
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("box", WingBox(aircraft=hera), promotes=["*"])
    problem.setup()
    problem.final_setup()
    edges = problem.get_val("cruise_strip_edge")
    share = np.sqrt(1.0 - (0.5 * (edges[1:] + edges[:-1]) / 14.5) ** 2) * np.diff(edges)
    for prefix, n in (("pullup_", 2.5), ("cruise_", 1.0)):
        lift = np.zeros((STRIPS, 3))
        lift[:, 2] = n * 28153.0 * 9.80665 / 2.0 * share / np.sum(share)
        problem.set_val(f"{prefix}strip_force", lift)
    for name, value in ({"mass": 28153.0, "mass_cruise": 28153.0} | values).items():
        problem.set_val(name, value)
    return problem


def slope(pressure=8000.0):
    return np.diag(pressure * 2.2 * 5.5 * np.full(STRIPS, 14.5 / STRIPS))


def test_a_soft_wing_is_loaded_otherwise_and_a_rigid_one_is_not(hera):
    soft = {"EI_flying": np.linspace(60.0, 2.0, STATIONS), "GJ_flying": np.linspace(30.0, 1.0, STATIONS)}
    found = {}
    for name, values in (("off", {}), ("rigid", {"strip_lift_by_twist": slope()}), ("soft", soft)):
        problem = box(hera, values | ({"strip_lift_by_twist": slope()} if name == "soft" else {}))
        problem.run_model()
        loads = problem.model.box.last["case_loads"]
        found[name] = {k: np.array(getattr(loads, k)) for k in ("V", "M")}
    np.testing.assert_allclose(found["rigid"]["M"], found["off"]["M"], rtol=1e-5)
    change = found["soft"]["M"] - found["off"]["M"]
    # the wing is nearly straight and lift acts ahead of its axis: load moves outboard, lift stays
    assert np.all(change[0, :4] > 0.005 * np.max(found["off"]["M"]))
    assert abs(found["soft"]["V"][0, 0] - found["off"]["V"][0, 0]) < 0.02 * found["off"]["V"][0, 0]
    assert np.all(change[2, :4] < 0.0)  # the push-over the other way
    np.testing.assert_allclose(change[7], 0.0, atol=1e-9)  # taxi: no air


def test_divergence_is_a_failed_analysis(hera):
    problem = box(hera, {"strip_lift_by_twist": slope(), "GJ_flying": np.full(STATIONS, 0.02)})
    with pytest.raises(om.AnalysisError, match=r"box: the wing diverges at 0\.\d+ of the dynamic pressure"):
        problem.run_model()


def test_partials(hera, check_partials):
    values = {"EI_flying": np.linspace(60.0, 2.0, STATIONS), "GJ_flying": np.linspace(30.0, 1.0, STATIONS)}
    problem = box(hera, values | {"strip_lift_by_twist": slope()})
    problem.run_model()
    component = problem.model.box
    inputs = {n: np.array(problem.get_val(n)) for n in component._var_rel_names["input"]}
    noise = (*component.PIECEWISE, "omega_bending", "omega_torsion")
    check_partials(component, inputs, relative_step=2e-5, noise=noise)
