"""Rotors that have failed: moments by hand, mirror images, no torque, derivatives, what models refuse."""

from importlib import resources

import numpy as np
import pytest

from hera_om.aircraft import load_aircraft, loads
from hera_om.aircraft.mission import Variable
from hera_om.aircraft.rotors import FailedRotor
from hera_om.components import arrays
from hera_om.components.aero import Aerodynamics
from hera_om.core.errors import InputError

SHIPPED = (resources.files("hera_om.aircraft") / "data" / "wing_rotor.toml").read_text("utf-8")
SMALL = """
[lattice]
wing_chordwise = 2
wing_spanwise = 8
rotor_radial = 4
rotor_azimuthal = 6
"""
WINGED = SHIPPED.replace("count_per_side = 1\ny_m = 5.0 ", "count_per_side = 2\nspacing_m = 4.5\ny_m = 3.0 ") + SMALL
REFERENCE = "[reference]\nS_m2 = 50.0\nc_m = 2.5\nb_m = 20.0\nx_m = 0.0\ny_m = 0.0\nz_m = 0.0\n"
BARE = WINGED[: WINGED.index("[wing]")] + REFERENCE + WINGED[WINGED.index("[[rotor]]") :]
BARE = BARE.replace("x_ahead_of_leading_edge_m = 1.6", "x_m = 0.0").replace("z_offset_m", "z_m")
INNER, OUTER = 3.0, 7.5
LATERAL = ("CY", "Cl", "Cn")
EVEN = ("CL", "CD", "CX", "CZ", "Cm", "thrust", "power", "thrust_prop", "eta_prop")


def failing(text, *failed):
    """A definition with failed rotors: number, side, state."""
    rows = [f'[[flight.failed]]\nrotor = "prop"\nnumber = {n}\nside = "{s}"\nstate = "{o}"\n' for n, s, o in failed]
    return loads(text + "\n".join(["", *rows]))


@pytest.fixture(scope="module")
def flown(ready):
    """Values by name of both halves of an aircraft with failed rotors, in a given state."""

    def solve(text, *failed, **state):
        component = Aerodynamics(aircraft=failing(text, *failed), lateral=True)
        problem, _ = ready(component, **state)
        names = component._var_rel_names["output"]
        return {n: np.array(problem.get_val(n)) for n in names} | {"parts": component.statics.parts}

    return solve


# --- rotors alone, where every number follows by hand


@pytest.fixture(scope="module")
def whole(flown):
    return flown(BARE, alpha=0.0)


@pytest.mark.parametrize("state", ["windmilling", "feathered", "stopped"])
def test_moments_of_an_outboard_failure_by_hand(state, flown, whole):
    """Nose and wing go towards the failed rotor: its thrust lost and its drag at its arm, the torque of its image."""
    found = flown(BARE, (2, "starboard", state), alpha=0.0)
    running, thrust = float(whole["thrust_prop"][0]), -found["rotor_force"][:, 0]
    torque = abs(whole["rotor_moment"][0, 0])
    q_S_b = float(found["q_S"][0]) * 20.0
    assert thrust[0] == pytest.approx(running, rel=1e-12) and thrust[1] < 0.0
    assert float(found["Cn"][0]) == pytest.approx((running - thrust[1]) * OUTER / q_S_b, rel=1e-9)
    left = found["rotor_moment"][1, 0]
    assert float(found["Cl"][0]) == pytest.approx((torque - left) / q_S_b, rel=1e-9)
    assert left == pytest.approx(0.0, abs=1e-9 * torque) if state != "stopped" else left < -0.1 * torque
    assert float(found["thrust"][0]) == pytest.approx(3.0 * running + thrust[1], rel=1e-12)
    assert float(found["power"][0]) == pytest.approx(0.75 * float(whole["power"][0]), rel=1e-9)
    for family in ("thrust", "power", "CT", "CP", "eta"):  # of those that run
        assert float(found[f"{family}_prop"][0]) == pytest.approx(float(whole[f"{family}_prop"][0]), rel=1e-12)


def test_partials_with_one_rotor_in_each_state(ready, check_partials):
    """At incidence and sideslip, by all inputs, blade pitch and chord among them."""
    paths = {"size": ("rotor.prop.diameter_m", 3.8, 4.0), "tip": ("blade.prop.c.7", 0.1, 0.11)}
    chosen = tuple(Variable(name=n, path=p, lower=a, upper=b) for n, (p, a, b) in paths.items())
    cases = ((2, "starboard", "windmilling"), (1, "port", "feathered"), (2, "port", "stopped"))
    aircraft = failing(BARE, *cases).model_copy(update={"variables": chosen})
    component = Aerodynamics(aircraft=aircraft, lateral=True)
    _, inputs = ready(component, alpha=3.0, beta=2.0, p_hat=0.02, q_hat=0.01, r_hat=0.03, theta_prop=37.0)
    check_partials(component, inputs, relative_step=1e-4, floor=1e-7, noise=("coupling_residual",), least=1e-10)


# --- with a wing in their slipstreams

STATE = {"alpha": 4.0, "beta": 3.0, "p_hat": 0.02, "q_hat": 0.01, "r_hat": -0.01}
MIRRORED = STATE | {"beta": -3.0, "p_hat": -0.02, "r_hat": 0.01}


@pytest.fixture(scope="module")
def starboard(flown):
    return flown(WINGED, (2, "starboard", "windmilling"), **STATE)


@pytest.mark.slow
def test_port_failure_is_the_mirror_image(flown, starboard):
    port = flown(WINGED, (2, "port", "windmilling"), **MIRRORED)
    for name in (*EVEN, "CL_alpha", "Cn_beta", "Cl_p"):
        assert float(port[name][0]) == pytest.approx(float(starboard[name][0]), rel=1e-9), name
    for name in (*LATERAL, "CL_beta", "Cm_r", "Cn_alpha", "Cl_theta_prop"):
        assert float(port[name][0]) == pytest.approx(-float(starboard[name][0]), rel=1e-9), name


@pytest.mark.slow
def test_an_engine_out_on_a_wing(flown):
    """The rotors' part of the yawing moment is that by hand within 3 %, which is what the wing's upwash and the other
    slipstreams change; the wing that is blown on one side alone rolls towards the failure.
    """
    ahead = {"alpha": 4.0}
    out, whole = flown(WINGED, (2, "starboard", "windmilling"), **ahead), flown(WINGED, **ahead)
    for name in LATERAL:
        assert abs(float(whole[name][0])) < 1e-12
    thrust = -out["rotor_force"][1, 0]
    by_hand = (-whole["rotor_force"][1, 0] - thrust) * OUTER / (float(out["q_S"][0]) * 20.0)
    parts = dict(zip(out["parts"], out["Cn_parts"], strict=True))
    assert parts["rotors"] == pytest.approx(by_hand, rel=0.03)
    assert 0.8 * by_hand < float(out["Cn"][0]) < 1.2 * by_hand
    assert abs(out["rotor_moment"][1, 0]) < 1e-9 * abs(out["rotor_moment"][0, 0])
    lift = float(whole["CL"][0] - out["CL"][0])
    assert lift > 0.0
    wing = dict(zip(out["parts"], out["Cl_parts"], strict=True))["wing"]
    arm = wing * 20.0 / lift  # of the lift lost, behind the rotor and inboard of it, where its swirl went up
    assert 0.3 * OUTER < arm < OUTER


def test_nothing_runs(flown):
    """All windmill: no power, no torque, drag."""
    found = flown(BARE, (1, "both", "windmilling"), (2, "both", "windmilling"), alpha=4.0)
    scale = 0.5 * 1.225 * 110.04**2 * 3.93**3
    assert abs(float(found["power"][0])) < 1e-9 * scale * 110.0
    assert float(found["thrust"][0]) < 0.0
    assert float(found["thrust"][0]) == pytest.approx(4.0 * float(found["thrust_prop"][0]), rel=1e-12)
    assert [float(found[f"{name}_prop"][0]) for name in ("CT", "CP", "eta")] == [0.0, 0.0, 0.0]
    np.testing.assert_allclose(found["rotor_moment"][:, 0], 0.0, atol=1e-9 * scale)


@pytest.mark.slow
def test_derivatives_of_an_engine_out_on_a_wing(starboard, flown):
    """Outputs such as Cn_beta, which hold the response of the failed rotor's speed, against differences of outputs."""
    step, state = 0.02, {"theta_prop": 38.0, **STATE}
    for name in ("beta", "alpha", "theta_prop"):
        ends = []
        for h in (step, -step, step / 2, -step / 2):
            ends.append(flown(WINGED, (2, "starboard", "windmilling"), **state | {name: state[name] + h}))
        for c in ("CX", "CZ", "Cm", *LATERAL):
            wide, narrow = ((ends[i][c] - ends[i + 1][c]) / (2.0 * d) for i, d in ((0, step), (2, step / 2)))
            expected = np.degrees(float(((4.0 * narrow - wide) / 3.0)[0]))
            assert float(starboard[f"{c}_{name}"][0]) == pytest.approx(expected, rel=1e-6, abs=1e-8), (c, name)


# --- the half model


def test_half_models_refuse_what_they_cannot_hold(small):
    def failed(*rows):
        flight = small.flight.model_copy(update={"failed": tuple(FailedRotor(**row) for row in rows)})
        return small.model_copy(update={"flight": flight})

    one = {"rotor": "electric", "number": 2, "side": "port", "state": "stopped"}
    said = r"hera_like: flight\.failed\[0\]\.side: got 'port', expected 'both': this model"
    with pytest.raises(InputError, match=said):
        Aerodynamics(aircraft=failed(one)).setup()
    assert arrays.plan(failed(one), True).failed == ((1, 2, "stopped"),)
    both = one | {"side": "both"}
    assert arrays.plan(failed(both), False).failed == ((0, 2, "stopped"), (1, 2, "stopped"))
    said = r"flight\.failed: got 'all of electric', expected a rotor of electric that runs"
    with pytest.raises(InputError, match=said):
        arrays.plan(failed(both, both | {"number": 1}), False)


def test_a_pair_fails_in_a_half_model_as_in_both_halves(ready, flown):
    pair = (2, "both", "stopped")
    half, _ = ready(Aerodynamics(aircraft=failing(BARE, pair)), alpha=4.0)
    found = flown(BARE, pair, alpha=4.0)
    for name in ("CX", "CZ", "Cm", "thrust", "power", "thrust_prop", "eta_prop", "CZ_alpha"):
        assert half.get_val(name).item() == pytest.approx(float(found[name][0]), rel=1e-9), name


def test_a_definition_keeps_its_failures():
    aircraft = failing(WINGED, (2, "port", "feathered"))
    assert aircraft.flight.failed[0] == FailedRotor(rotor="prop", number=2, side="port", state="feathered")
    assert load_aircraft("wing_rotor").flight.failed == ()
