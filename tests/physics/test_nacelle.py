"""What a nacelle does to the air at its disk, and what it pays."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad

from hera_om.physics.nacelle import held_up, nacelle_drag

HUB, NACELLE = 0.2, 0.45
AREA = np.pi * (NACELLE**2 - HUB**2)
LENGTH = 2.0 * NACELLE


def growth(x):
    """dA/dx of the nacelle, m."""
    return 2.0 * AREA * x / LENGTH**2


def share(r, beta=1.0):
    """`held_up` at one radius or more."""
    return np.asarray(held_up(jnp.atleast_1d(r), hub_radius=HUB, nacelle_radius=NACELLE, beta=beta))


@pytest.mark.parametrize("beta", [1.0, 0.8])
@pytest.mark.parametrize("r", [0.2, 0.7, 1.5])
def test_line_of_sources(r, beta):
    """Against the sum of point sources, x stretched by 1 / beta after Goethert (fluxes and velocities along x too)."""

    def source(x):
        return growth(x) * x / (x**2 + (beta * r) ** 2) ** 1.5 / (4.0 * np.pi)

    np.testing.assert_allclose(share(r, beta), quad(source, 0.0, LENGTH)[0], rtol=1e-9)


@pytest.mark.parametrize("beta", [1.0, 0.8])
def test_half_of_the_displaced_air_passes_the_plane_of_the_disk(beta):
    """To infinity; the rest flows off ahead of it. The slipstream widens by the same half at the disk.

    Mass grows with beta^2 u where the stream is compressible.
    """
    missing = quad(lambda r: share(r, beta)[0] * 2.0 * np.pi * r, 0.0, np.inf, limit=200)[0]
    assert beta**2 * missing == pytest.approx(AREA / 2.0, rel=1e-6)


def test_drag_is_what_the_pressure_behind_the_disk_does():
    """Of a light load between two radii, against -rho V u dA along the axis of its two tubes."""
    v, inner, outer, n = 1e-6, 0.3, 1.0, 2000  # v at the disk over the flight speed; thrust by area 2 rho V^2 v

    def on_axis(x):
        return v * (x / np.hypot(x, outer) - x / np.hypot(x, inner))

    pressure = quad(lambda x: -on_axis(x) * growth(x), 0.0, LENGTH, epsabs=0.0)[0]
    edges = np.linspace(inner, outer, n + 1)
    r = (edges[1:] + edges[:-1]) / 2
    thrust = jnp.asarray(2.0 * v * np.pi * np.diff(edges**2))
    drag = nacelle_drag(thrust, jnp.asarray(share(r)), speed=jnp.ones(n), v_axial=jnp.full(n, v))
    assert pressure > 0.0
    np.testing.assert_allclose(drag, pressure, rtol=1e-5)


@pytest.mark.parametrize("v", [-0.3, 0.0, 0.5, 1.0])
def test_power_for_net_thrust_is_that_of_momentum_theory(v):
    """T (V (1 - s) + v) = (T - D) (V + v), from a windmill to a rotor as loaded as in a slow climb."""
    thrust, held = np.array([2.0]), np.array([0.05])
    drag = nacelle_drag(*map(jnp.asarray, (thrust, held)), speed=jnp.ones(1), v_axial=jnp.full(1, v))
    np.testing.assert_allclose(thrust[0] * (1.0 - held[0] + v), (thrust[0] - drag) * (1.0 + v), rtol=1e-12)


def test_nothing_behind_a_hub_as_wide():
    """No nacelle, and one that hides behind the hub."""
    for radius in (0.0, HUB):
        np.testing.assert_array_equal(held_up(jnp.array([0.2, 1.0]), hub_radius=HUB, nacelle_radius=radius), 0.0)
