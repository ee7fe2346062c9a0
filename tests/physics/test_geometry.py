"""Cutting a surface into panels: spacing, shares, hinges, meshes and normals by hand, derivatives."""

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics.geometry import (
    CAMBER,
    FLAT,
    Sections,
    make_grid,
    make_panels,
    span_weights,
    surface_mesh,
)


def sections(*, y=(0.0, 4.0), x=(0.0, 1.0), z=(0.0, 0.0), chord=(2.0, 1.0), twist=(0.0, 0.0)):
    return Sections(*[jnp.asarray(v, float) for v in (x, y, z, chord, twist)])


def cut(y=(0.0, 4.0), airfoil="flat", **changes):
    return make_grid(y, [airfoil] * len(y), **(dict(nc=3, ns=4, span="uniform", chord="uniform") | changes))


@given(
    st.lists(st.floats(0.05, 1.0), min_size=1, max_size=4),
    st.integers(4, 12),
    st.sampled_from([0.0, -2.0, 1.0, 2.5]),
)
def test_edges_contain_the_sections_and_middles_lie_inside(widths, n, law):
    y = np.r_[0.0, np.cumsum(widths)]
    weights, middle = span_weights(y, n, law)
    edges = weights @ y
    assert weights.shape == (n + 1, len(y)) and middle.shape == (n,)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, rtol=1e-12)
    assert np.all(np.diff(edges) > 0) and np.all((middle > 0.2) & (middle < 0.8))
    assert all(np.min(np.abs(edges - at)) < 1e-12 for at in y)


def test_strips_are_shared_by_length():
    """A quarter of the span gets a quarter of the strips."""
    weights, _ = span_weights([0.0, 1.0, 4.0], 40, 0.0)
    assert np.sum(weights @ [0.0, 1.0, 4.0] < 1.0 - 1e-9) == 10


def test_too_few_strips_are_refused():
    with pytest.raises(ValueError, match="2 strips cannot resolve 3 segments"):
        span_weights([0.0, 1.0, 2.0, 3.0], 2, 0.0)


def test_mesh_by_hand():
    """Leading and trailing edges of a twisted section turned about its quarter chord, nose up."""
    twist = np.radians(5.0)
    mesh = surface_mesh(sections(twist=(0.0, twist)), cut())
    np.testing.assert_allclose(mesh[:, 0], [[0, 0, 0], [2 / 3, 0, 0], [4 / 3, 0, 0], [2, 0, 0]], atol=1e-14)
    c, s = np.cos(twist), np.sin(twist)
    np.testing.assert_allclose(mesh[0, -1], [1.25 - 0.25 * c, 4.0, 0.25 * s], rtol=1e-12)
    np.testing.assert_allclose(mesh[-1, -1], [1.25 + 0.75 * c, 4.0, -0.75 * s], rtol=1e-12)
    flat = surface_mesh(sections(twist=(0.0, twist)), cut(airfoil="NACA 2412"), FLAT)
    assert not np.any(flat[..., 2])


def test_the_camber_surface_has_the_camber_lines_height():
    mesh = surface_mesh(sections(chord=(2.0, 2.0), x=(0.0, 0.0)), cut(airfoil="NACA 2412", nc=5))
    assert float(jnp.max(mesh[..., 2])) == pytest.approx(0.04, rel=1e-12)  # 2 % of 2 m at 40 %


@pytest.mark.parametrize("shape", [CAMBER, FLAT])
def test_normals_by_hand(shape):
    """Twist tilts the normal aft; dihedral tilts it inboard."""
    twist, dihedral, grid = 0.1, 0.2, cut()
    plain = make_panels(sections(twist=(twist, twist), x=(0.0, 0.0), chord=(1.0, 1.0)), grid, shape)
    np.testing.assert_allclose(plain.normal, np.broadcast_to([np.sin(twist), 0, np.cos(twist)], (3, 4, 3)), atol=1e-14)
    raised = make_panels(sections(z=(0.0, 4.0 * np.tan(dihedral)), x=(0.0, 0.0), chord=(1.0, 1.0)), grid, shape)
    expected = np.broadcast_to([0, -np.sin(dihedral), np.cos(dihedral)], (3, 4, 3))
    np.testing.assert_allclose(raised.normal, expected, atol=1e-14)
    np.testing.assert_allclose(raised.strip_width, 1.0 / np.cos(dihedral), rtol=1e-12)


def test_rings_start_at_the_quarter_and_conditions_stand_at_three_quarters_of_a_panel():
    panels = make_panels(sections(x=(0.0, 0.0), chord=(3.0, 3.0)), cut())
    np.testing.assert_allclose(panels.rings[:, 0, 0], [0.25, 1.25, 2.25, 3.0], rtol=1e-12)
    np.testing.assert_allclose(panels.collocation[:, 0], [[0.75, 0.5, 0], [1.75, 0.5, 0], [2.75, 0.5, 0]], atol=1e-14)
    np.testing.assert_allclose(panels.strip_edges[:, 0], 0.75, rtol=1e-12)


def test_area_of_a_trapezoid():
    panels = make_panels(sections(), cut(ns=7))
    assert float(panels.strip_chord @ panels.strip_width) == pytest.approx(6.0, rel=1e-12)


@pytest.mark.parametrize("shape", [CAMBER, FLAT])
def test_derivatives(check_derivatives, shape):
    grid = cut(airfoil="NACA 2412", nc=2, ns=2)

    def run(v):
        p = make_panels(sections(twist=(v[0], v[1]), chord=(2.0, v[2]), z=(0.0, v[3])), grid, shape)
        return jnp.concatenate([q.ravel() for q in (p.rings, p.collocation, p.normal, p.strip_width)])

    check_derivatives(run, [0.05, -0.03, 1.2, 0.4])
