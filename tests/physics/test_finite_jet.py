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


def shares(n):
    xi = jnp.linspace(0.0, 1.0, n + 1)
    return np.asarray(fj.chord_shares(xi, jnp.full(n, 0.25), jnp.full(n, 0.75))), xi[:-1] + 0.75 / n


def test_normal_velocities_of_a_strip_give_its_circulation():
    """A plate, and a parabola with V . n = -cos theta, whose lift is half of that (Glauert); exact on any panels."""
    (weights, _), met = shares(4)
    assert weights.sum() == pytest.approx(1.0, rel=1e-12)
    assert weights @ (2.0 * met - 1.0) == pytest.approx(0.5, rel=1e-12)


def test_lift_about_the_middle_of_the_chord_is_answered_less():
    """Rings of a plate count whole, those of an even load `MIDDLE` times."""
    _, weights = shares(100)[0]
    at = (np.arange(100) + 0.25) / 100
    plate, middle = np.sqrt((1 - at) / at), np.sqrt(at * (1 - at))
    for load, expected in ((plate, 1.0), (middle, fj.MIDDLE)):
        assert weights @ np.cumsum(load) / load.sum() == pytest.approx(expected, rel=0.01)


def answer_to_a_vortex(y, at, radius, n=4000):
    """Downwash at y of a dielectric cylinder's answer to a unit vortex, by sources around it (Green, in planes)."""
    angle = (np.arange(n) + 0.5) * 2 * np.pi / n
    ring = radius * np.exp(1j * angle)
    # a vortex with u - i v = i / (2 pi (z - at)) has -v = downwash 1 / (2 pi (y - at)) at y on the real axis
    flow = np.conj(-1j / (2 * np.pi * (ring - at)))
    source = 2 * np.real(flow * np.exp(-1j * angle))
    source -= source.mean()  # a circle of even sources has its flow outside alone
    velocity = np.conj(np.sum(source * radius * 2 * np.pi / n / (2 * np.pi * (y - ring))))
    return -np.imag(velocity)


@pytest.mark.parametrize("at", [0.1, 0.35, 0.8, -0.3, -1.5])
@pytest.mark.parametrize("y", [0.02, 0.3, -0.4, 0.7, -1.2])
def test_images_of_what_trails(y, at, radius=0.5):
    """Against sources around the edge, at any two places."""
    images = fj.trailing_images(jnp.array([y]), jnp.array([[at - y]]), jnp.array([radius]))[0, 0]
    across = min(1.0, (radius / y) ** 2)
    found = across * (1.0 / (y - at) + float(images)) / (2 * np.pi)
    assert found == pytest.approx(answer_to_a_vortex(y, at, radius), rel=0.004, abs=1e-6)


def test_derivatives_of_images_are_finite_and_exact():
    """Vortices and places inside, on the edge and outside, on the axis and the farthest away."""
    nodes = jnp.array([[0.1, 0.4, -0.7, 30.0]] * 4)

    def total(p):
        place = jnp.array([0.0, 0.5, -0.5, 2.0]) + p[0]
        return jnp.sum(fj.trailing_images(place, nodes, (0.5 + p[1]) * jnp.ones(4)))

    at, step = jnp.zeros(2), 1e-6
    assert np.all(np.isfinite(jax.hessian(total)(at)))
    for i, exact in enumerate(np.asarray(jax.grad(total)(at))):
        d = step * jnp.eye(2)[i]
        assert exact == pytest.approx(float(total(at + d) - total(at - d)) / (2 * step), rel=1e-6)


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
        images=jnp.zeros((n, 0)),
    )


PLACES = np.array([0.0, 0.2, 0.45, 0.5, 0.55, 1.5])


def test_nothing_without_a_jet_and_all_in_still_air():
    none = edges([0.0, 0.0], PLACES)
    np.testing.assert_array_equal(none.bound, 0.0)
    np.testing.assert_array_equal(none.trailing, 0.0)
    np.testing.assert_array_equal(none.relief, 0.0)
    still = edges([1e8, 1e8], PLACES)
    assert 0.99 < float(still.relief[-1]) < 1.0


def test_outside_the_relief_is_that_of_the_image():
    """A full jet takes 1 - k = 2 / (1 + mu^2) of the added lift outside, whatever the distance."""
    radius = jnp.broadcast_to(jnp.array([1e-4, 0.5]), (3, 2))
    at, jet = jnp.array([0.7, 1.5, 5.0]), {"excess": jnp.full((3, 1), 0.44), "share": jnp.ones(1)}
    found = fj.jet_edges(at, jnp.ones(3), radius=radius, images=jnp.zeros((3, 0)), **jet)
    np.testing.assert_allclose(found.relief, float(fj.reflection(1.2)), rtol=0.02)
    # downwash that hardly changes: inside k of it, outside as of a dipole
    np.testing.assert_allclose(found.trailing, float(fj.reflection(1.2)) * (0.5 / at) ** 2, rtol=1e-3)


def test_a_braking_rotor_takes_back_what_a_thrusting_one_gives():
    one, other = edges([0.01, 0.02], PLACES), edges([-0.01, -0.02], PLACES)
    np.testing.assert_allclose(one.bound, -other.bound, rtol=0.03)
    np.testing.assert_allclose(one.trailing, -other.trailing, rtol=0.03)
    np.testing.assert_allclose(one.relief, -other.relief, rtol=0.05)


@pytest.mark.parametrize("excess", [[0.0, 0.0], [0.1, 0.4], [-0.2, 0.3]])
def test_derivatives_are_finite_and_exact(excess):
    distance = jnp.array([0.0, 0.1, 0.49, 0.5, 0.51, 2.0])

    def total(v):
        found = edges(v[:2], distance + v[2], radius=0.5 + v[3])
        return jnp.sum(found.bound) + jnp.sum(found.relief**2) + jnp.sum(found.trailing)

    at = jnp.array([*excess, 0.01, 0.0])
    gradient = jax.grad(total)(at)
    assert np.all(np.isfinite(gradient)) and np.all(np.isfinite(jax.hessian(total)(at)))
    step = 1e-6
    for i in range(4):
        if not any(excess) and i < 2:
            continue  # one-sided: the mean of an excess that is nothing
        d = np.eye(4)[i] * step
        assert (total(at + d) - total(at - d)) / (2 * step) == pytest.approx(float(gradient[i]), rel=1e-5, abs=1e-8)
