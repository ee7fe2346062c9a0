"""Balances of steady flight: against statics by hand, derivatives, what each kind of aircraft balances."""

import numpy as np
import openmdao.api as om
import pytest

from hera_om.components.trim import (
    ALPHA_BOUNDS,
    PITCH_BOUNDS,
    TrimBalance,
    TrimResiduals,
    start_values,
    state_bounds,
)

STATES = ("alpha", "delta_e", "theta_hybrid", "theta_electric")
WEIGHT = 28153.0 * 9.80665  # N
FORCE = 8149.0 * 70.0  # q S, N
POINT = {"CX": -0.02, "CZ": 0.49, "Cm": 0.013, "mass": 28153.0, "q_S": FORCE}
POINT |= {"thrust_hybrid": 5700.0, "thrust_electric": 1200.0}


def residuals(component, **values):
    """Balances of a TrimBalance at given inputs and states, by the state that closes them."""
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("c", component, promotes=["*"])
    problem.setup()
    for name, value in values.items():
        problem.set_val(name, value)
    problem.final_setup()
    problem.model.run_apply_nonlinear()
    return problem, {n: component._residuals[n].item() for n in component.equilibrium.states}


# --- statics by hand


@pytest.mark.parametrize("load_factor", [1.0, 2.5])
@pytest.mark.parametrize("alpha", [0.0, 4.0])
def test_a_free_body_in_balance_has_no_residual(small, alpha, load_factor):
    """Weight n m g normal to the flight path, resolved along the axes of the aircraft.

    With thrust along x everything that is left of CX is the component of weight: CX = -C_W sin alpha,
    CZ = C_W cos alpha.
    """
    c_w, a = load_factor * WEIGHT / FORCE, np.radians(alpha)
    point = POINT | {"CX": -c_w * np.sin(a), "CZ": c_w * np.cos(a), "Cm": 0.0, "load_factor": load_factor}
    point |= {"thrust_hybrid": 5600.0, "thrust_electric": 1330.0}  # the ratio of the design thrusts
    _, found = residuals(TrimBalance(aircraft=small), alpha=alpha, **point)
    assert set(found) == set(STATES)
    np.testing.assert_allclose(list(found.values()), 0.0, atol=1e-15)


def test_residuals_are_what_is_missing(small):
    """Each balance by its own formula; the split is the difference of the shares of the design thrusts."""
    _, found = residuals(TrimBalance(aircraft=small), alpha=2.0, load_factor=1.0, **POINT)
    a, c_w = np.radians(2.0), WEIGHT / FORCE
    assert found["alpha"] == pytest.approx(0.49 - c_w * np.cos(a), rel=1e-12)
    assert found["theta_hybrid"] == pytest.approx(-0.02 + c_w * np.sin(a), rel=1e-12)
    assert found["delta_e"] == 0.013
    assert found["theta_electric"] == pytest.approx(1200.0 / 1330.0 - 5700.0 / 5600.0, rel=1e-12)


def test_a_glide_balances_lift_and_moment_only(small_aircraft):
    """Without power CL = C_W, whatever the drag: CZ = CL cos a + CD sin a, CX = CD cos a - CL sin a."""
    bare = small_aircraft().model_copy(update={"rotor": (), "drag_area": ()})
    a, cl, cd = np.radians(5.0), 2.5 * WEIGHT / FORCE, 0.07
    point = {"CX": cd * np.cos(a) - cl * np.sin(a), "CZ": cl * np.cos(a) + cd * np.sin(a), "Cm": 0.0}
    point |= {"mass": 28153.0, "q_S": FORCE, "load_factor": 2.5}
    _, found = residuals(TrimBalance(aircraft=bare, powered=False), alpha=5.0, **point)
    assert set(found) == {"alpha", "delta_e"}
    np.testing.assert_allclose(list(found.values()), 0.0, atol=1e-15)
    _, heavier = residuals(TrimBalance(aircraft=bare, powered=False), alpha=5.0, **point | {"load_factor": 3.5})
    assert heavier["alpha"] == pytest.approx(-WEIGHT / FORCE, rel=1e-12)


# --- what is balanced by what


def test_states_and_their_bounds(small):
    bounds = state_bounds(small, powered=True)
    assert tuple(bounds) == STATES
    assert bounds["alpha"] == ALPHA_BOUNDS and bounds["delta_e"] == (-25.0, 25.0)
    assert bounds["theta_hybrid"] == bounds["theta_electric"] == (40.0, 60.0)
    assert tuple(state_bounds(small, powered=False)) == STATES[:2]
    assert start_values(small)["theta_hybrid"] == 46.5


def test_blade_pitch_without_bounds_has_wide_ones(small_aircraft):
    assert state_bounds(small_aircraft("wing_rotor"), powered=True) == {
        "alpha": ALPHA_BOUNDS,
        "theta_prop": PITCH_BOUNDS,
    }


# --- derivatives


@pytest.mark.parametrize("powered", [True, False])
def test_partials_of_the_balance(small, powered):
    problem, before = residuals(TrimBalance(aircraft=small, powered=powered), alpha=2.0, load_factor=1.7, **(
        POINT if powered else {k: v for k, v in POINT.items() if not k.startswith("thrust")}
    ))  # fmt: skip
    component = problem.model.c
    problem.model.run_linearize()
    jacobian = component._jacobian
    inputs = list(component._var_rel_names["input"])
    for wrt in (*inputs, *before):
        start = problem.get_val(wrt).item()
        step = 1e-4 * max(abs(start), 1.0)
        ends = []
        for side in (step, -step, step / 2, -step / 2):
            problem.set_val(wrt, start + side)
            problem.model.run_apply_nonlinear()
            ends.append(np.array([component._residuals[n].item() for n in before]))
        problem.set_val(wrt, start)
        slope = (8 * (ends[2] - ends[3]) - (ends[0] - ends[1])) / (6 * step)
        found = np.array([jacobian[f"c.{of}", f"c.{wrt}"].item() for of in before])
        np.testing.assert_allclose(found, slope, rtol=1e-6, atol=1e-9 / max(abs(start), 1.0), err_msg=wrt)


def test_residuals_for_an_optimiser(small, ready, check_partials):
    """The same balances as outputs, but the split of thrust is free."""
    component = TrimResiduals(aircraft=small)
    problem, inputs = ready(component, alpha=2.0, load_factor=1.7, **POINT)
    check_partials(component, inputs)
    _, found = residuals(TrimBalance(aircraft=small), alpha=2.0, load_factor=1.7, **POINT)
    names = {"balance_z": "alpha", "balance_m": "delta_e", "balance_x": "theta_hybrid"}
    assert set(component._var_rel_names["output"]) == set(names)
    for name, state in names.items():
        assert problem.get_val(name).item() == found[state]
