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
        assert float(fj.edge_answer(jnp.array(eta**2), radius)) == pytest.approx(found, rel=error)


@pytest.mark.parametrize("radius", [0.2, 0.5, 1.0, 4.0])
def test_answer_summed_along_the_span(radius):
    """Closed form: the sources' and the vortex's fields, summed along the span, are plane flows."""
    at, lift, met, weight = plate(400)
    d = met[:, None] - at
    exact = weight @ (d * np.arcsinh(2 * radius / np.abs(d)) / np.sqrt(d**2 + 4 * radius**2)) @ lift
    eta = np.sinh(np.linspace(0.0, 6.0, 4001))
    found = 2.0 * radius * np.trapezoid(fj.edge_answer(jnp.asarray(eta) ** 2, radius), eta)
    assert found == pytest.approx(exact, rel=0.02)


def shares(n):
    xi = jnp.linspace(0.0, 1.0, n + 1)
    return np.asarray(fj.chord_shares(xi, jnp.full(n, 0.25), jnp.full(n, 0.75))), xi[:-1] + 0.75 / n


def test_normal_velocities_of_a_strip_give_its_circulation():
    """A plate, and a parabola with V . n = -cos theta, whose lift is half of that (Glauert); exact on any panels."""
    (weights, _), met = shares(4)
    assert weights.sum() == pytest.approx(1.0, rel=1e-12)
    assert weights @ (2.0 * met - 1.0) == pytest.approx(0.5, rel=1e-12)


def test_moment_of_the_lift():
    """None of a plate, all of the circulation for lift about the middle of the chord."""
    _, weights = shares(100)[0]
    at = (np.arange(100) + 0.25) / 100
    plate, middle = np.sqrt((1 - at) / at), np.sqrt(at * (1 - at))
    for load, expected in ((plate, 0.0), (middle, 1.0)):
        assert weights @ np.cumsum(load) / load.sum() == pytest.approx(expected, abs=0.02)


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


def behind(y, at, d, n=400):
    """Share by which a cylinder of radius 1 answers to half a vortex, from x = 0 aft, more (or less) than half as much
    as to a whole one, at x = d: the sources around it, each along x by Gauss's rule.
    """
    angle = (np.arange(n) + 0.5) / n * np.pi
    to_vortex, to_place = (np.sqrt(1 + v**2 - 2 * v * np.cos(angle))[:, None] for v in (at, y))
    t, w = np.polynomial.legendre.leggauss(60)
    x = d + to_place * t / np.sqrt(1 - t**2)
    weight = np.sin(angle) ** 2 / (to_vortex * to_place)[:, 0] ** 2
    return weight @ (x / np.sqrt(x**2 + to_vortex**2) @ w) / 2 / weight.sum()


def mean_behind(y, at, radius):
    """Its means over a plate's conditions and lift, and lift about the middle of the chord, chord 1."""
    load, lift, met, weight = plate(24)
    apart = np.linspace(0.0, 1.0, 17)[1:]
    table = np.append(0.0, [behind(y / radius, at / radius, d / radius) for d in apart])
    d = met[:, None] - load
    each = weight @ (np.sign(d) * np.interp(np.abs(d), np.append(0.0, apart), table))
    return each @ lift, each @ (2 * np.sin(np.arccos(1 - 2 * load)) ** 2 / len(load))


@pytest.mark.parametrize("at", [0.1, 0.35, 0.45, 0.8, -0.3, -1.5])
@pytest.mark.parametrize("y", [0.02, 0.3, -0.4, 0.7, -1.2])
def test_answer_to_what_trails(y, at, radius=0.5):
    """Against sources around the edge, at any two places; half of it and more at the wing."""
    how = {"radius": jnp.array(radius), "chord": jnp.array(1.0)}
    found, less = (float(v) for v in fj.trailing_answer(jnp.array(y), jnp.array(at), jnp.array(0.0), **how))
    across = -answer_to_a_vortex(y, at, radius)  # that one turns the other way
    quarter, middle = mean_behind(y, at, radius)
    error = 0.07 if abs(y) < radius or abs(at) < radius else 0.12
    assert found == pytest.approx(0.5 * across * (1.0 + quarter), rel=error)
    assert found - less == pytest.approx(0.5 * across * (1.0 + middle), rel=error)


def test_a_wing_above_the_axis_leaves_the_jet_where_it_is_narrower():
    """The answer to what trails changes its sign across the edge, sqrt(R^2 - z^2) from the axis."""
    how = {"radius": jnp.array(0.5), "chord": jnp.array(1.0)}
    edge = float(jnp.sqrt(0.5**2 - 0.3**2))
    answers = [
        float(fj.trailing_answer(edge * jnp.array(s), jnp.array(edge), jnp.array(0.3), **how)[0]) for s in (0.9, 1.1)
    ]
    assert answers[0] > 0.0 and answers[1] > 0.0
    assert max(answers) > 3 * float(fj.trailing_answer(jnp.array(0.5), jnp.array(0.0), jnp.array(0.3), **how)[0])


def test_bound_vortices_of_infinite_span_are_answered_by_the_edge():
    """From far away on both sides."""
    y, far, how = jnp.array([0.0, 0.3, 0.8]), 1e4, {"radius": jnp.array(0.5), "chord": jnp.array(1.0)}
    ends = [fj.bound_answer(y, jnp.array(v), jnp.array(0.0), **how)[0] for v in (far, -far)]
    np.testing.assert_allclose(np.pi * (ends[0] - ends[1]), fj.edge_answer(y**2 / 0.25, 0.5), rtol=1e-6)


def edges(excess, distance, radius=0.5, nodes=(-3.0, -0.2, 0.31, 3.0)):
    excess = jnp.atleast_1d(jnp.asarray(excess, float))
    place = jnp.asarray(distance, float)
    n = len(place)
    steps = radius * jnp.linspace(0.4, 1.0, excess.shape[0])
    return fj.jet_edges(
        place,
        jnp.zeros(n),
        jnp.asarray(nodes) - place[:, None],
        jnp.ones(n),
        radius=jnp.broadcast_to(steps, (n, *steps.shape)),
        excess=jnp.broadcast_to(excess, (n, *excess.shape)),
    )


PLACES = np.array([0.0, 0.2, 0.45, 0.5, 0.55, 1.5])


def test_nothing_without_a_jet():
    for v in edges([0.0, 0.0], PLACES):
        np.testing.assert_array_equal(v, 0.0)


def test_downwash_of_others_is_that_of_a_dielectric():
    """A full jet: inside k of a downwash that hardly changes, outside as of a dipole, all in still air."""
    found = edges([0.44, 0.44], [0.0, 0.7, 1.5])
    k = float(fj.reflection(1.44))
    np.testing.assert_allclose(found.others, k * np.array([1.0, (0.5 / 0.7) ** 2, (0.5 / 1.5) ** 2]), rtol=2e-3)
    assert float(edges([1e8, 1e8], [0.0]).others[0]) == pytest.approx(1.0, rel=1e-3)


def test_steps_in_a_row_answer_as_one_to_what_is_far_away():
    """Two concentric edges in an even flow: the closed form of a dielectric shell."""
    inner, outer, a2 = 4.0, 1.5, 0.4**2  # excesses, square of the ratio of the radii
    found = float(edges([inner, outer], [0.0]).others[0])
    e1, e2 = 1.0 / (1.0 + inner), 1.0 / (1.0 + outer)
    # velocity inside over that far away, times the speed of the jet squared over that of the stream (Phi)
    shell = 4 * e2 / ((e2 + 1) * (e1 + e2) + a2 * (e2 - 1) * (e1 - e2))
    assert found == pytest.approx(shell - 1.0, rel=2e-3)


def test_a_braking_rotor_takes_back_what_a_thrusting_one_gives():
    one, other = edges([0.01, 0.02], PLACES), edges([-0.01, -0.02], PLACES)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, -b, rtol=0.05, atol=1e-4)


@pytest.mark.parametrize("excess", [[0.0, 0.0], [0.1, 0.4], [-0.2, 0.3]])
def test_derivatives_are_finite_and_exact(excess):
    """On the axis, at edges and far away, of places and nodes too."""
    distance = jnp.array([0.0, 0.1, 0.49, 0.5, 0.51, 2.0])

    def total(v):
        found = edges(v[:2], distance + v[2], radius=0.5 + v[3], nodes=(0.0, 0.2, 0.5, 30.0))
        return jnp.sum(found.shed**2) + jnp.sum(found.moment) + jnp.sum(found.others)

    at = jnp.array([*excess, 0.011, 0.0])
    gradient = jax.grad(total)(at)
    assert np.all(np.isfinite(gradient)) and np.all(np.isfinite(jax.hessian(total)(at)))
    step = 1e-7
    for i in range(4):
        d = np.eye(4)[i] * step
        assert (total(at + d) - total(at - d)) / (2 * step) == pytest.approx(float(gradient[i]), rel=1e-5, abs=1e-6)
