"""Edges of a round jet: their answer against quadrature and a closed form, limits, derivatives."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import finite_jet as fj


def downwash(d, eta, around=60, nodes=40):
    """Of the sources on a cylinder of radius 1, twice the normal velocity of an infinite vortex strong one across its
    axis: at the distance d behind the vortex and eta from the axis. Gauss's rule on both sides of a crossing.
    """
    angle = (np.arange(around) + 0.5) / around * np.pi
    a, b = np.sin(angle), np.sqrt((eta - np.cos(angle)) ** 2 + np.sin(angle) ** 2)
    x, w = np.polynomial.legendre.leggauss(nodes)

    def side(low, high, centre, width):
        ends = [np.arcsinh((end - centre) / width) for end in (low, high)]
        q = (ends[0] + ends[1])[:, None] / 2 + (ends[1] - ends[0])[:, None] / 2 * x
        s = centre + width[:, None] * np.sinh(q)
        f = s / (s**2 + a[:, None] ** 2) / ((s - d) ** 2 + b[:, None] ** 2) ** 1.5 * width[:, None] * np.cosh(q)
        return f @ w * (ends[1] - ends[0]) / 2

    total = side(-1e5, d / 2, 0.0, a) + side(d / 2, 1e5, d, b)
    return np.sum(a**2 * total) / around / (2 * np.pi)


def plate(n):
    """Places and weights of a plate's lift, and of its conditions: the lift in reversed flow."""
    load, met = (np.arange(n) + 0.5) * np.pi / n, (np.arange(n + 1) + 0.5) * np.pi / (n + 1)
    return (1 - np.cos(load)) / 2, (1 + np.cos(load)) / n, (1 - np.cos(met)) / 2, (1 - np.cos(met)) / (n + 1)


@pytest.mark.parametrize("radius,error", [(0.35, 0.06), (0.5, 0.08), (1.0, 0.10), (2.0, 0.08)])
def test_answer_against_quadrature(radius, error):
    at, lift, met, weight = plate(30)
    apart = np.linspace(0.0, 1.0, 13) ** 2
    for eta in (0.0, 0.5, 1.3):
        table = np.append(0.0, [downwash(d / radius, eta) for d in apart[1:]])
        d = met[:, None] - at
        found = weight @ (np.sign(d) * np.interp(np.abs(d), apart, table)) @ lift * np.pi / radius
        assert float(fj.edge_answer(jnp.array(eta), radius)) == pytest.approx(found, rel=error)


@pytest.mark.parametrize("radius", [0.2, 0.5, 1.0, 4.0])
def test_answer_summed_along_the_span(radius):
    """Closed form: the sources' and the vortex's fields, summed along the span, are plane flows."""
    at, lift, met, weight = plate(400)
    d = met[:, None] - at
    exact = weight @ (d * np.arcsinh(2 * radius / np.abs(d)) / np.sqrt(d**2 + 4 * radius**2)) @ lift
    eta = np.sinh(np.linspace(0.0, 6.0, 4001))
    found = 2.0 * radius * np.trapezoid(fj.edge_answer(jnp.asarray(eta), radius), eta)
    assert found == pytest.approx(exact, rel=0.02)


def test_lift_about_the_middle_of_the_chord_is_answered_less():
    """Weights of a strip: one for a plate, `MIDDLE` for a load by camber (V . n = -cos theta), Glauert's integrals."""
    xi = np.linspace(0.0, 1.0, 201)
    weights = np.asarray(fj.chord_shares(jnp.asarray(xi)))
    slope = 1.0 - (xi[1:] + xi[:-1])  # cos theta at the middles
    assert np.sum(weights) == pytest.approx(1.0, rel=1e-12)
    assert weights @ -slope == pytest.approx(0.5 * fj.MIDDLE, rel=1e-3)


def edges(excess, distance, radius=0.5):
    excess = jnp.atleast_1d(jnp.asarray(excess, float))
    n = len(distance)
    steps = radius * jnp.linspace(0.2, 1.0, excess.shape[0] + 1)
    share = jnp.diff(steps**2) / radius**2
    return fj.jet_edges(
        jnp.asarray(distance, float),
        jnp.ones(n),
        radius=jnp.broadcast_to(steps, (n, *steps.shape)),
        excess=jnp.broadcast_to(excess, (n, *excess.shape)),
        share=share,
    )


PLACES = np.array([0.0, 0.2, 0.45, 0.5, 0.55, 1.5])


def test_nothing_without_a_jet_and_all_in_still_air():
    none = edges([0.0, 0.0], PLACES)
    np.testing.assert_array_equal(none.answer, 0.0)
    np.testing.assert_array_equal(none.relief, 0.0)
    still = edges([1e8, 1e8], PLACES)
    assert 0.99 < float(still.relief[-1]) < 1.0


def test_outside_the_relief_is_that_of_the_image():
    """A full jet takes 1 - k = 2 / (1 + mu^2) of the added lift outside, whatever the distance."""
    radius = jnp.broadcast_to(jnp.array([1e-4, 0.5]), (3, 2))
    found = fj.jet_edges(
        jnp.array([0.7, 1.5, 5.0]), jnp.ones(3), radius=radius, excess=jnp.full((3, 1), 0.44), share=jnp.ones(1)
    )
    np.testing.assert_allclose(found.relief, float(fj.reflection(1.2)), rtol=0.02)


def test_a_braking_rotor_takes_back_what_a_thrusting_one_gives():
    one, other = edges([0.01, 0.02], PLACES), edges([-0.01, -0.02], PLACES)
    np.testing.assert_allclose(one.answer, -other.answer, rtol=0.03)
    np.testing.assert_allclose(one.relief, -other.relief, rtol=0.05)


@pytest.mark.parametrize("excess", [[0.0, 0.0], [0.1, 0.4], [-0.2, 0.3]])
def test_derivatives_are_finite_and_exact(excess):
    distance = jnp.array([0.0, 0.1, 0.49, 0.5, 0.51, 2.0])

    def total(v):
        found = edges(v[:2], distance + v[2], radius=0.5 + v[3])
        return jnp.sum(found.answer) + jnp.sum(found.relief**2)

    at = jnp.array([*excess, 0.01, 0.0])
    gradient = jax.grad(total)(at)
    assert np.all(np.isfinite(gradient)) and np.all(np.isfinite(jax.hessian(total)(at)))
    step = 1e-6
    for i in range(4):
        if not any(excess) and i < 2:
            continue  # one-sided: the mean of an excess that is nothing
        d = np.eye(4)[i] * step
        assert (total(at + d) - total(at - d)) / (2 * step) == pytest.approx(float(gradient[i]), rel=1e-5, abs=1e-8)
