"""Lattice and rotors as a component: derivatives, conservation of what adds up, failures, no recompiling."""

import jax
import numpy as np
import openmdao.api as om
import pytest

from hera_om.aircraft import load_aircraft
from hera_om.aircraft.mission import Variable
from hera_om.components import aero as module
from hera_om.components.aero import Aerodynamics
from hera_om.components.aero_plan import COEFFICIENTS

POINT = {
    "alpha": 2.3,
    "q_hat": 0.004,
    "delta_e": -3.0,
    "mach": 0.45,
    "altitude": 5000.0,
    "x_cg": 12.2,
    "z_cg": 0.4,
    "load_factor": 1.3,
    "theta_hybrid": 47.2,
    "theta_electric": 44.6,
    "y_kink": 5.9,
    "theta_tip": -2.2,
    "y_prop": 8.3,
    "htail_scale": 1.07,
}
RESIDUAL = ("coupling_residual",)
DRAG = ("CDi_near", "CD_slipstream", "CD_profile", "CD_fuselage", "CD_areas")


@pytest.fixture(scope="module")
def flown(small, ready):
    """The aircraft with its rotors on, at a point where nothing is zero."""
    component = Aerodynamics(aircraft=small)
    problem, inputs = ready(component, **POINT)
    assert set(inputs) == set(POINT)
    return component, problem, inputs


# --- derivatives


def test_partials_of_the_whole_aircraft(flown, check_partials):
    """The floor is what rounding leaves: 1e-11 of the flow of a disk, see `vortex_tube`.

    What slipstreams take by thickness and give by swirl nearly cancels here in CD_slipstream, but not its noise, which
    asks for a wide step of the twist; what moves a slipstream's edge, rounded over half a percent, for a small one.
    """
    component, _, inputs = flown
    check_partials(component, inputs, relative_step=5e-5, floor=1e-6, noise=RESIDUAL, steps={"theta_tip": 2e-4})


@pytest.mark.parametrize(
    ("name", "point", "variables"),
    [
        ("wing_alone", {"alpha": 3.0, "z_cg": 0.2, "tip": 0.5}, {"tip": ("wing.section.tip.twist_deg", -3, 3)}),
        ("wing_tail", {"alpha": 3.0, "delta_e": 2.0}, {"tail": ("htail.scale", 0.8, 1.2)}),
        ("rotor_alone", {"alpha": 4.0, "theta_prop": 16.0}, {"size": ("rotor.prop.diameter_m", 1.5, 1.7)}),
        ("wing_rotor", {"alpha": 3.0, "theta_prop": 37.0}, {"y_prop": ("rotor.prop.y_m", 4.0, 6.0)}),
    ],
)
def test_partials_of_parts_of_an_aircraft(name, point, variables, small_aircraft, ready, check_partials):
    chosen = tuple(Variable(name=n, path=p, lower=a, upper=b) for n, (p, a, b) in variables.items())
    aircraft = small_aircraft(name).model_copy(update={"variables": chosen})
    component = Aerodynamics(aircraft=aircraft)
    _, inputs = ready(component, mach=0.3, altitude=1000.0, q_hat=0.01, load_factor=1.1, **point)
    check_partials(component, inputs, relative_step=1e-4, floor=1e-7, noise=RESIDUAL, least=1e-10)


def test_balances_alone_are_the_same_numbers(flown):
    """Newton's method inside a trim is handed a part of the partials, from another path of the code."""
    component, _, inputs = flown
    full, part = {}, {}
    component.compute_partials(inputs, full)
    component.states_only = True
    try:
        component.compute_partials(inputs, part)
    finally:
        component.states_only = False
    states = ("alpha", "delta_e", "theta_hybrid", "theta_electric")
    balances = (*COEFFICIENTS, "thrust_hybrid", "thrust_electric")
    assert set(part) == {(of, wrt) for of in balances for wrt in states}
    for key, value in part.items():
        np.testing.assert_allclose(value, full[key].item(), rtol=1e-9, atol=1e-12, err_msg=str(key))


def test_coefficient_derivatives_are_the_partials(flown):
    """Outputs such as CL_alpha (per radian) are the component's own derivatives (per degree)."""
    component, problem, inputs = flown
    partials = {}
    component.compute_partials(inputs, partials)
    for c in COEFFICIENTS:
        for by in ("alpha", "delta_e", "theta_hybrid", "theta_electric"):
            slope = problem.get_val(f"{c}_{by}").item()
            assert slope == pytest.approx(np.degrees(partials[c, by].item()), rel=1e-9, abs=1e-11)
        assert problem.get_val(f"{c}_q").item() == pytest.approx(partials[c, "q_hat"].item(), rel=1e-9)


# --- values


def test_drag_is_the_sum_of_its_parts(flown):
    _, problem, _ = flown
    parts = sum(problem.get_val(name).item() for name in DRAG)
    assert problem.get_val("CD").item() == pytest.approx(parts, rel=1e-12)


def test_axes_turn_into_each_other_but_for_hub_loads(flown):
    """CX and CZ hold the rotors' hub loads, CL and CD do not."""
    _, problem, _ = flown
    value = {n: problem.get_val(n).item() for n in (*COEFFICIENTS, "q_S", "alpha")}
    a, hub = np.radians(value["alpha"]), 2 * problem.get_val("rotor_force").sum(axis=0) / value["q_S"]
    cx, cz = value["CX"] - hub[0], value["CZ"] - hub[2]
    assert value["CD"] == pytest.approx(cx * np.cos(a) + cz * np.sin(a), rel=1e-12)
    assert value["CL"] == pytest.approx(cz * np.cos(a) - cx * np.sin(a), rel=1e-12)


def test_thrust_of_all_rotors(flown):
    _, problem, _ = flown
    one = {g: problem.get_val(f"thrust_{g}").item() for g in ("hybrid", "electric")}
    assert problem.get_val("thrust").item() == pytest.approx(2 * one["hybrid"] + 4 * one["electric"], rel=1e-12)
    assert -2 * problem.get_val("rotor_force")[:, 0].sum() == pytest.approx(problem.get_val("thrust").item())
    for g in ("hybrid", "electric"):
        work = one[g] * problem.get_val("speed").item()
        eta = problem.get_val(f"eta_{g}").item()
        assert eta == pytest.approx(work / problem.get_val(f"power_{g}").item(), rel=1e-3) and 0 < eta < 1


def test_pull_up_turns_the_aircraft(flown, small, ready):
    """q = (n - 1) g / V, so q_hat grows by (n - 1) g c / 2V^2."""
    _, problem, _ = flown
    extra = 0.3 * 9.80665 * 2.4755 / (2 * problem.get_val("speed").item() ** 2)
    level, _ = ready(Aerodynamics(aircraft=small), **POINT | {"load_factor": 1.0, "q_hat": 0.004 + extra})
    for name in ("CL", "Cm", "CX"):
        assert level.get_val(name).item() == pytest.approx(problem.get_val(name).item(), rel=1e-10)


def test_rotor_alone_is_the_reference_propeller(reference, ready):
    """CCBlade's propeller of the ATR-like case at J = 1.4 (1200 rpm, 110.04 m/s), the wing taken off."""
    rows = (reference / "atr_like" / "bemt_propeller.csv").read_text().splitlines()
    table = [row.split(",") for row in rows if row and not row.startswith("#")]
    wanted = next(dict(zip(table[0], map(float, row), strict=True)) for row in table[1:] if float(row[0]) == 1.4)
    whole = load_aircraft("wing_rotor", {"lattice.rotor_radial": 40, "lattice.rotor_azimuthal": 4})
    alone = {"x_m": 0.0, "z_m": 0.0, "x_ahead_of_leading_edge_m": None, "z_offset_m": None}
    rotor = whole.rotor[0].model_copy(update=alone)
    aircraft = whole.model_copy(update={"wing": None, "rotor": (rotor,)})
    problem, _ = ready(Aerodynamics(aircraft=aircraft), alpha=0.0)
    assert problem.get_val("CT_prop").item() == pytest.approx(wanted["CT"], rel=0.01)
    assert problem.get_val("CP_prop").item() == pytest.approx(wanted["CP"], rel=0.01)


def test_wing_and_tail_are_those_of_avl(ready):
    """AVL on the same lattice at 2 degrees: see the head of the definition."""
    problem, _ = ready(Aerodynamics(aircraft=load_aircraft("wing_tail")))
    found = {n: problem.get_val(n).item() for n in ("CL", "CDi", "Cm", "CL_alpha")}
    assert found["CL"] == pytest.approx(0.343127, rel=1e-4)
    assert found["CDi"] == pytest.approx(0.003148, rel=1e-3)
    assert found["Cm"] == pytest.approx(-0.141830, rel=1e-3)
    assert found["CL_alpha"] == pytest.approx(5.780533, rel=1e-4)


# --- failures


def test_a_result_that_is_not_finite_is_named(small, ready):
    with pytest.raises(om.AnalysisError, match=r"c: not finite: .*CL"):
        ready(Aerodynamics(aircraft=small), **POINT | {"alpha": np.nan})


def test_an_unconverged_coupling_is_an_error(flown, monkeypatch):
    _, problem, _ = flown
    assert 0 < problem.get_val("coupling_residual").item() < 1e-11
    monkeypatch.setattr(module, "UNCONVERGED", 1e-20)
    with pytest.raises(om.AnalysisError, match="lattice and rotors have not converged"):
        problem.run_model()


def test_slipstreams_too_fast_for_the_model_are_an_error(flown):
    """A take-off run from standstill is not for this model; the component goes on where it is."""
    _, problem, _ = flown
    mach = float(problem.get_val("mach").item())
    problem.set_val("mach", 0.02)
    with pytest.raises(om.AnalysisError, match=r"slipstreams have \d+\.\d times the flight speed, limit 3"):
        problem.run_model()
    problem.set_val("mach", mach)
    problem.run_model()


# --- compilation


def test_nothing_is_compiled_after_the_first_evaluation(flown, small, small_aircraft, ready, compilations):
    """Other values, another instance, and other numbers of the same structure use what is compiled."""
    component, _, inputs = flown
    component.compute_partials(inputs, {})

    def evaluate(aircraft, **moved):
        other = Aerodynamics(aircraft=aircraft)
        _, here = ready(other, **POINT | moved)
        other.compute_partials(here, {})

    evaluate(small, alpha=2.0)
    before = len(compilations)
    evaluate(small, alpha=1.0, y_kink=5.5, mach=0.5)
    evaluate(small_aircraft(wing__incidence_deg=1.5, flight__mach=0.48), theta_hybrid=46.0)
    assert compilations[before:] == []
    jax.jit(lambda x: 2.0 * x)(np.zeros(17))  # the counter counts
    assert len(compilations) > before
