"""A trim point: balances closed, totals through the solver, saturation, the same answer as Table 4's problem."""

import numpy as np
import openmdao.api as om
import pytest

from hera_om.components.mass import MassProperties
from hera_om.models.cases import TRIM_BALANCE, table_4
from hera_om.models.problems import build_trim
from hera_om.models.trimmed import TrimPoint

STATES = ("alpha", "delta_e", "theta_hybrid", "theta_electric")


def trimmed(aircraft, **options):
    """A trim point with the masses of its aircraft, solved."""
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("mass_properties", MassProperties(aircraft=aircraft), promotes=["*"])
    point = TrimPoint(aircraft=aircraft, **options)
    problem.model.add_subsystem("cruise", point, promotes_inputs=["*", ("mass", "mass_cruise")], promotes_outputs=["*"])
    problem.setup()
    problem.set_solver_print(level=-1)
    problem.run_model()
    return problem, point


@pytest.fixture(scope="module")
def cruise(small):
    return trimmed(small)


def test_forces_and_moments_vanish(cruise):
    """Weight, thrust and air loads of the cruise balance in physical terms, not only as residuals."""
    problem, _ = cruise
    value = {n: problem.get_val(n).item() for n in ("CX", "CZ", "Cm", "alpha", "mass_cruise", "q_S")}
    weight, a = value["mass_cruise"] * 9.80665 / value["q_S"], np.radians(value["alpha"])
    left = [value["CX"] + weight * np.sin(a), value["CZ"] - weight * np.cos(a), value["Cm"]]
    np.testing.assert_allclose(left, 0.0, atol=1e-10)


def test_thrusts_keep_the_ratio_of_their_design(cruise):
    problem, _ = cruise
    ratio = problem.get_val("thrust_hybrid").item() / problem.get_val("thrust_electric").item()
    assert ratio == pytest.approx(5600.0 / 1330.0, rel=1e-9)


@pytest.mark.filterwarnings("ignore:The following groups have a nonlinear solver")
def test_totals_through_the_trim(cruise, check_totals):
    problem, _ = cruise
    steps = {"y_kink": 2e-3, "theta_tip": 2e-3, "y_prop": 5e-4, "htail_scale": 5e-4, "m_wing": 0.5}
    check_totals(problem, [*STATES, "L_over_D", "power", "Cm_alpha", "Cm_q"], steps)


def test_a_pull_up_needs_load_and_power_of_the_cruise_is_left_alone(small, cruise):
    problem, _ = trimmed(small, powered=False, load_factor=2.5)
    cl = problem.get_val("CZ").item() * np.cos(np.radians(problem.get_val("alpha").item()))
    cl -= problem.get_val("CX").item() * np.sin(np.radians(problem.get_val("alpha").item()))
    weight = problem.get_val("mass_cruise").item() * 9.80665 / problem.get_val("q_S").item()
    assert cl == pytest.approx(2.5 * weight, rel=1e-9)
    assert problem.get_val("theta_hybrid").item() == 46.5


def test_table_4_finds_the_same_trim_at_the_same_split(small, cruise):
    """Three balances and three free states leave one answer: the optimiser's is Newton's."""
    newton, _ = cruise
    problem = build_trim(small)
    split = newton.get_val("theta_hybrid").item()
    problem.model.set_design_var_options("theta_hybrid", lower=split - 1e-9, upper=split + 1e-9)
    problem.set_val("theta_hybrid", split)
    assert problem.run_driver().success
    for axis in "xzm":
        assert abs(problem.get_val(f"balance_{axis}").item()) < TRIM_BALANCE
    for state in STATES:
        assert problem.get_val(state).item() == pytest.approx(newton.get_val(state).item(), abs=1e-4), state


def test_table_4_chooses_the_split(small, cruise):
    """With the split free the balances close too, and L/D is no worse than at the ratio of the design thrusts."""
    newton, _ = cruise
    problem = build_trim(small)
    problem.run_driver()
    for axis in "xzm":
        assert abs(problem.get_val(f"balance_{axis}").item()) < TRIM_BALANCE
    assert problem.get_val("L_over_D").item() > newton.get_val("L_over_D").item()
    for state, (low, high) in table_4(small).items():
        assert low - 1e-9 <= problem.get_val(state).item() <= high + 1e-9


def test_a_saturated_elevator_is_named(small_aircraft):
    short = small_aircraft(htail__control__elevator__limit_deg=1.0)
    with pytest.raises(om.AnalysisError, match=r"cruise: no trim; saturated: delta_e at 1 deg; balances left"):
        trimmed(short)


def test_an_aircraft_without_masses_says_so(small_aircraft):
    with pytest.raises(ValueError, match=r"trim of 'wing_tail' needs mass in its definition"):
        build_trim(small_aircraft("wing_tail"))
