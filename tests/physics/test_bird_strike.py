"""Leading edge: the formula's worked example, its trends, the mass by hand."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.bird_strike import bird_gauge, leading_edge
from hera_om.physics.wingbox_types import BoxConcept, BoxGeometry, Material

ALUMINIUM = Material(71.7e9, 26.9e9, 0.33, 2810.0, 476e6, 469e6, 538e6, 324e6)


def test_worked_example_of_the_reference():
    """structures_closed_form.toml, [bird_strike]: 128.6 m/s, r = 40 mm, 4 deg sweep -> 1.154 mm."""
    found = bird_gauge(128.6, jnp.asarray([0.040]), jnp.cos(jnp.deg2rad(jnp.asarray([4.0]))))
    assert float(found[0]) == pytest.approx(1.154e-3, rel=1e-3)


def test_sharper_noses_and_slower_birds_need_less():
    t = np.asarray(bird_gauge(128.6, jnp.asarray([0.02, 0.04, 0.10]), jnp.ones(3)))
    assert np.all(np.diff(t) > 0)
    np.testing.assert_allclose(bird_gauge(64.3, jnp.asarray([0.02, 0.04, 0.10]), jnp.ones(3)), t / 2)


def test_mass_of_a_straight_leading_edge_by_hand():
    y = jnp.linspace(0.0, 10.0, 4)
    geometry = BoxGeometry(jnp.stack([0 * y, y, 0 * y], axis=1), jnp.full(4, 2.0), jnp.full(4, 0.15))
    concept = BoxConcept(0.15, 0.62, 0.6, 0.15, 0.0025)
    found = leading_edge(geometry, ALUMINIUM, concept, speed=128.6)
    x = 0.5 * (1 - np.cos(np.linspace(0, np.arccos(0.7), 4001)))
    half = 5 * 0.15 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)
    arc = 2 * 2.0 * np.sum(np.hypot(np.diff(x), np.diff(half)))
    np.testing.assert_allclose(found.t, 0.0025)  # the gauge, above the bird's
    assert float(found.mass) == pytest.approx(2 * 10.0 * 2810.0 * 0.0025 * arc, rel=3e-3)
    thin = leading_edge(geometry, ALUMINIUM, concept._replace(t_min=5e-4), speed=128.6)
    radius = jnp.full(4, 1.1019 * 2.0 * 0.15**2)
    np.testing.assert_allclose(thin.t, bird_gauge(128.6, radius, jnp.ones(4)))
