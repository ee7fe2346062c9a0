"""Sections in a jet of finite height: the plate in a plane jet, limits, a fit to flow solutions, derivatives."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import finite_jet as fj

# Patterson, Simplified Aerodynamics Models to Predict the Effects of Upstream Propellers on Wing Lift, PhD thesis,
# Georgia Institute of Technology (2016), and Patterson and German, AIAA 2015-1673: polynomial for beta in powers of
# R / c, rows of ascending power, columns 1, u, u^2, u mu, mu, mu^2 with u the distance of the disk ahead of the
# leading edge over the chord, mu the velocity ratio; fitted to plane flow with actuator disks for 0.25 <= R / c <= 3,
# 0.25 <= u <= 3, 1.25 <= mu <= 2.25. Coefficients as printed in FAST-OAD_CS23-HE (ISAE-SUPAERO).
PATTERSON = np.array(
    [
        [0.378269, 0.748135, -0.179986, -0.056464, -0.146746, -0.015255],
        [3.071020, -1.769885, 0.436595, 0.148643, -0.989332, 0.197940],
        [-2.827730, 2.054064, -0.467410, -0.277325, 0.698981, -0.008226],
        [0.997936, -0.916118, 0.199829, 0.157810, -0.143368, -0.057385],
        [-0.127645, 0.135543, -0.028919, -0.026546, 0.010470, 0.012221],
    ]
)


def plate(h, mu, panels=80):
    """A flat plate in a plane jet: vortices and conditions at quarters of many panels, and their images.

    At the edge the perturbations obey V_jet u_jet = V u and v_jet / V_jet = v / V: a vortex and its image of strength
    k, opposite one of strength m outside, give V_jet (1 - k) = V m and (1 + k) / V_jet = m / V.
    """
    k = np.linalg.solve([[mu, 1.0], [-1.0 / mu, 1.0]], [mu, 1.0 / mu])[0]
    at, met = (np.arange(panels) + 0.25) / panels, (np.arange(panels) + 0.75) / panels
    d = met[:, None] - at
    n = np.arange(1, 400)[:, None, None]
    wash = (1.0 / d + 2.0 * np.sum(k**n * d / (d**2 + (2.0 * n * h) ** 2), axis=0)) / (2.0 * np.pi)
    return np.sum(np.linalg.solve(wash, np.ones(panels))) / np.pi


@pytest.mark.parametrize("h", [0.2, 0.35, 0.6, 1.0, 2.5])
@pytest.mark.parametrize("mu", [0.85, 1.1, 1.4, 2.5])
def test_plate_in_a_plane_jet(h, mu):
    np.testing.assert_allclose(fj.jet_factor(h, mu), plate(h, mu), atol=0.0015)


def test_the_correction_of_a_typical_rotor_is_felt():
    """R / c = 0.5 and a slipstream a fifth faster: a fifth to a third of the gain of 0.44 in lift is not there."""
    gain = 1.2**2 * float(fj.jet_factor(fj.ROUND_JET * 0.5, 1.2)) - 1.0
    assert 0.67 < gain / (1.2**2 - 1.0) < 0.8


def test_limits():
    mu = jnp.array([1.1, 1.5, 2.5])
    np.testing.assert_allclose(fj.jet_factor(0.7, jnp.ones(1)), 1.0, rtol=0.0)
    np.testing.assert_allclose(fj.jet_factor(1e3, mu), 1.0, atol=1e-6)
    np.testing.assert_allclose(fj.jet_factor(0.0, mu), 1.0 / mu**2, rtol=0.02)


def test_lift_of_a_wing_spanning_a_free_jet_in_still_air():
    """All images as strong as the vortex: F = tanh(x) / x, x = pi / 4H, by the sum of 1 / (1 + (n t)^2)."""
    h = jnp.array([1.0, 2.0, 4.0])
    square = h**2 + (0.1160 - 0.1022) * h / (h + 0.3325 - 0.1057)
    x = jnp.pi / (4.0 * jnp.sqrt(square))
    np.testing.assert_allclose(fj.reflection(1e6), 1.0, atol=1e-11)
    np.testing.assert_allclose(fj.jet_factor(h, 1e6), jnp.tanh(x) / x, rtol=0.01)
    np.testing.assert_allclose(fj.jet_factor(h[2], 1e6), 1.0 - np.pi**2 / 48.0 / 16.0, atol=1e-3)


@pytest.mark.parametrize("mu", [1.5, 1.75, 2.0, 2.25])
def test_against_flow_solutions_behind_actuator_disks(mu):
    """Patterson's beta, lift over that of the plain stream = (1 + beta (mu - 1))^2, disk half a chord ahead."""
    for height in (0.25, 0.5, 1.0, 1.5):
        columns = np.array([1.0, 0.5, 0.25, 0.5 * mu, mu, mu**2])
        published = (PATTERSON @ columns) @ height ** np.arange(5.0)
        found = (mu * np.sqrt(float(fj.jet_factor(height, mu))) - 1.0) / (mu - 1.0)
        assert abs(found - published) < 0.12
        assert abs((1.0 + found * (mu - 1.0)) ** 2 / (1.0 + published * (mu - 1.0)) ** 2 - 1.0) < 0.1


def test_derivatives(check_derivatives):
    def factor(p):
        return fj.jet_factor(p[0] * jnp.array([0.2, 0.6, 2.0]), p[1] * jnp.array([0.9, 1.0, 1.8]))

    check_derivatives(factor, np.array([1.0, 1.0]))
