"""Velocity of filaments against the closed form and against quadrature; limits; points on a filament."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics.vortex_kernel import WAKE_CORE, arms, kernels

FAR = 1e3
coordinate = st.floats(-2.0, 2.0)
vector = st.tuples(coordinate, coordinate, coordinate).map(np.array)


def fields(points, rings):
    """Velocity by every filament of a surface: families of [points, rows, columns, 3]."""
    p, out = jnp.atleast_2d(jnp.asarray(points, float)), []
    for k, arm in zip(kernels(p, rings), arms(rings), strict=True):
        swirl = jnp.cross(p.reshape(-1, *[1] * (arm.ndim - 1), 3), arm[None, ..., :3]) + arm[..., 3:]
        out.append(np.asarray(k[..., None] * swirl))
    return out


def one_ring(a, b):
    """Nodes of one ring whose front line runs from a to b; its trailing edge is far below."""
    below = np.array([0.0, 0.0, -FAR])
    return jnp.asarray(np.array([[a, b], [a + below, b + below]], float))


def closed_form(p, a, b):
    """Segment of unit circulation: (cos A - cos B) / 4 pi h about its line (Biot-Savart)."""
    e = (b - a) / np.linalg.norm(b - a)
    h = (p - a) - e * ((p - a) @ e)
    cosines = e @ (p - a) / np.linalg.norm(p - a) - e @ (p - b) / np.linalg.norm(p - b)
    return cosines / (4 * np.pi * (h @ h)) * np.cross(e, h)


def quadrature(p, a, b):
    """The integral dl x r / 4 pi r^3 by Gauss-Legendre."""
    x, weight = np.polynomial.legendre.leggauss(400)
    r = p - (a + (b - a) * (x[:, None] + 1) / 2)
    integrand = np.cross(b - a, r) / np.linalg.norm(r, axis=1, keepdims=True) ** 3
    return weight @ integrand / (8 * np.pi)


def off_line(p, a, b):
    """Distance of p from the line through a and b, over the size of the problem."""
    return np.linalg.norm(np.cross(p - a, b - a)) / max(np.linalg.norm(b - a), 1e-9)


@given(vector, vector, vector)
def test_segment(p, a, b):
    if np.linalg.norm(b - a) < 0.1 or off_line(p, a, b) < 0.05:
        p, a, b = np.array([0.3, 0.4, 0.5]), np.array([-1.0, 0.0, 0.0]), np.array([1.0, 0.2, 0.0])
    found = fields(p, one_ring(a, b))[0][0, 0, 0]
    np.testing.assert_allclose(found, closed_form(p, a, b), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found, quadrature(p, a, b), rtol=1e-6, atol=1e-9)


def test_infinite_line():
    """Gamma / 2 pi h for a line without ends, upwards on the starboard side of a line that runs aft."""
    ring = jnp.asarray([[[-FAR, 0.0, 0.0], [-FAR, 9.0, 0.0]], [[FAR, 0.0, 0.0], [FAR, 9.0, 0.0]]])
    found = fields([0.0, 0.5, 0.0], ring)[1][0, 0, 0]
    np.testing.assert_allclose(found, [0.0, 0.0, 1 / (2 * np.pi * 0.5)], atol=1e-6)


@pytest.mark.parametrize("x", [-3.0, -0.2, 0.0, 0.2, 3.0, 300.0])
def test_half_line(x):
    """From its start downstream: (1 + cos) / 4 pi h, a half of the infinite line abreast of the start."""
    h = 0.4
    found = fields([x, h, 0.0], one_ring(np.zeros(3), np.array([0.0, 3.0, 0.0])) * jnp.array([1.0, 1.0, 0.0]))
    expected = (1 + x / np.hypot(x, h)) / (4 * np.pi * h)
    np.testing.assert_allclose(found[2][0, 0], [0.0, 0.0, expected], rtol=1e-6, atol=1e-12)


def test_a_long_segment_is_a_half_line():
    ring = jnp.asarray([[[0.0, 0.0, 0.0], [0.0, 5.0, 0.0]], [[FAR, 0.0, 0.0], [FAR, 5.0, 0.0]]])
    tail = ring - jnp.array([FAR, 0.0, 0.0])
    p = [0.7, 1.1, 0.3]
    np.testing.assert_allclose(fields(p, ring)[1][0, 0, 0], fields(p, tail)[2][0, 0], atol=1e-6)


def test_no_velocity_on_the_filament_itself():
    ring = jnp.asarray([[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]])
    points = [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0], [3.0, 0.0, 0.0]]
    bound, chordwise, wake = fields(points, ring)
    assert np.all(np.isfinite(np.concatenate([v.ravel() for v in (bound, chordwise, wake)])))
    assert not np.any(bound[0]) and not np.any(chordwise[1, 0, 0]) and not np.any(wake[3, 0])


@pytest.mark.parametrize("miss", [0.0, 1e-17, 3e-16, -2e-15])
def test_a_point_on_an_end_stays_finite(miss):
    """Where surfaces meet, rounding decides how near a node of one is to a point of the other."""
    rings = one_ring(np.array([14.4, 0.0, 2.0]), np.array([14.8, 0.0, 2.0]))
    for end in (14.4, 14.8):
        for family in fields([end + miss, miss, 2.0 - miss], rings):
            assert np.all(np.abs(family) < 10.0)


def test_the_wake_core_bounds_the_velocity():
    """Near a wake line the velocity peaks at 1 / 4 pi core instead of growing without end."""
    ring = one_ring(np.zeros(3), np.array([0.0, 3.0, 0.0])) * jnp.array([1.0, 1.0, 0.0])
    speeds = [np.linalg.norm(fields([50.0, h, 0.0], ring)[2][0, 0]) for h in WAKE_CORE * np.array([0.1, 1, 10])]
    assert max(speeds) == pytest.approx(1 / (4 * np.pi * WAKE_CORE), rel=1e-6)
