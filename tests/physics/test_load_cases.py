"""Gusts against Pratt's formula and the rule's numbers, landing and gyroscopes by hand, the table of cases."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.gust import alleviation, gust_factor, profile_alleviation, reference_gust
from hera_om.physics.load_cases import CASES, UNIT_LOADS, CaseWeights, case_matrix, gyroscopic_moment, landing_factor

G = 9.80665
RULES = dict(V_C=128.6, ceiling=7620.0, altitude=6096.0)
WEIGHTS = CaseWeights(28153.0, 27653.0, 3300.0, 28153.0)
FLIGHT = dict(limit_factor=2.5, lift_slope=6.5, area=70.0, chord=2.4755, speed=158.0, stroke=0.35) | RULES
ROW, COLUMN = {n: i for i, n in enumerate(CASES)}, {n: i for i, n in enumerate(UNIT_LOADS)}


@pytest.mark.parametrize("mu", [10.0, 20.0, 40.0, 80.0, 160.0])
def test_alleviation_is_pratts_at_his_gradient(mu):
    """NACA Report 1206: K = 0.88 mu / (5.3 + mu) for H of 12.5 chords, his straight fit to such solutions, 3 to 4 %."""
    assert float(alleviation(mu, 25.0)) == pytest.approx(0.88 * mu / (5.3 + mu), rel=0.04)


def test_limits_of_the_alleviation():
    assert float(alleviation(1e7, 250.0)) == pytest.approx(1.0, rel=2e-3)  # heavy, slow gust: all of it
    sharp = float(alleviation(1e7, 1.0))  # heavy, sharp gust: the largest value of Kuessner's function of it
    s = np.linspace(0.0, 2.0, 4001)
    rise = np.pi / 2 * np.sin(np.pi * s)
    kuessner = 1 - 0.5 * np.exp(-0.13 * s) - 0.5 * np.exp(-s)
    seen = np.convolve(rise, kuessner)[: len(s)] * (s[1] - s[0])
    assert sharp == pytest.approx(seen.max(), rel=2e-3)


def test_gust_velocities_and_profile_factor_of_the_rule():
    np.testing.assert_allclose([reference_gust(h) for h in (0.0, 4572.0, 18288.0, 2286.0)], [17.07, 13.41, 6.36, 15.24])
    ratios = dict(ceiling=7620.0, landing_ratio=0.97, zero_fuel_ratio=0.91)
    by_hand = 0.5 * (0.9 + np.sqrt(0.91 * np.tan(np.pi / 4 * 0.97)))
    assert float(profile_alleviation(0.0, **ratios)) == pytest.approx(by_hand)
    assert float(profile_alleviation(7620.0, **ratios)) == pytest.approx(1.0)


def test_gust_factor_is_near_the_old_rule():
    """FAR 25.341 before 1996: U_de 50 ft/s at V_C below 20 000 ft with Pratt's factor; the tuned gust is near it."""
    found = gust_factor(
        28153.0, lift_slope=6.5, area=70.0, chord=2.4755, landing_ratio=1.0, zero_fuel_ratio=1.0, **RULES
    )
    mu = 2 * 28153.0 / (1.225 * 2.4755 * 6.5 * 70.0)
    old = 1.225 * 128.6 * 15.24 * 6.5 * 70.0 / (2 * 28153.0 * G) * 0.88 * mu / (5.3 + mu)
    assert float(found) == pytest.approx(old, rel=0.15)


def test_landing_and_gyroscopes_by_hand():
    assert float(landing_factor(0.35)) == pytest.approx(3.05**2 / (2 * G * 0.8 * 0.35))
    # A starboard rotor, inner blade up, turns about -x; nose up is +y: the moment is about -z.
    moment = gyroscopic_moment(jnp.asarray([128.0]), jnp.asarray([[-106.8, 0, 0]]), jnp.asarray([0, 0.093, 0]))
    np.testing.assert_allclose(moment, [[0.0, 0.0, -128.0 * 106.8 * 0.093]])


def test_the_table_of_cases():
    table = np.asarray(case_matrix(WEIGHTS, **FLIGHT))
    assert table.shape == (len(CASES), len(UNIT_LOADS))
    np.testing.assert_allclose(table[ROW["pull-up"]], [0, 1, 0, 2.5, 2.5, 2.5, G * 1.5 / 158.0], atol=1e-12)
    np.testing.assert_allclose(table[ROW["motor failed"]], [1, 0, -1, 1, 1, 1, 0], atol=1e-12)
    np.testing.assert_allclose(table[ROW["taxi"]], [0, 0, 0, 2, 2, 2, 0])
    # Lift by the two air loads is n times the weight of each loading; the landing has 1 g of lift.
    lift = table[:, :2] @ [27653.0, 2.5 * 28153.0]
    n, fuel = table[:, COLUMN["structure"]], table[:, COLUMN["fuel"]] / table[:, COLUMN["structure"]]
    mass = 28153.0 - 3300.0 * (1 - fuel)
    flying = [ROW[c] for c in ("pull-up", "pull-up, dry", "push-over", "gust up", "gust up, dry", "gust down")]
    np.testing.assert_allclose(lift[flying], (n * mass)[flying], rtol=1e-12)
    assert lift[ROW["landing"]] == pytest.approx(28153.0) and n[ROW["landing"]] > 2.0
    assert n[ROW["gust up, dry"]] > n[ROW["gust up"]] > 2.0  # lighter, rougher
    assert n[ROW["gust up"]] - 1.0 == pytest.approx(1.0 - n[ROW["gust down"]])


def test_derivatives_by_mass_and_lift_slope(check_derivatives):
    def outputs(p):
        weights = CaseWeights(28153.0 * p[0], 27653.0, 3300.0 * p[1], 28153.0)
        changed = FLIGHT | dict(lift_slope=6.5 * p[2], V_C=128.6 * p[3], stroke=0.35 * p[4])
        return case_matrix(weights, **changed).ravel()

    # The instant of the largest lift jumps between steps: the second derivative is not that of the value.
    point = np.asarray([1.0, 1.02, 0.98, 1.01, 0.97])
    exact = np.asarray(jax.jit(jax.jacfwd(outputs))(point))
    run = jax.jit(outputs)
    h = 1e-5
    central = np.stack([(run(point + h * e) - run(point - h * e)) / (2 * h) for e in np.eye(5)], axis=-1)
    np.testing.assert_allclose(exact, central, atol=1e-7 * np.max(np.abs(exact)))
