"""Vortex tube and disk of sinks: closed forms, direct summation of vortex rings, invariants, derivatives."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import special
from scipy.integrate import quad

from hera_om.physics import vortex_tube as vt

RADIUS, HUB, N = 1.3, 0.2, 20
FINE = 1e-6 * RADIUS
EDGES = jnp.linspace(HUB, RADIUS, N + 1)
MIDDLES = 0.5 * (EDGES[1:] + EDGES[:-1])
OFF_SHEET = np.array(
    [[0.5, 0.4], [0.5, 2.0], [-0.5, 0.4], [-0.7, 1.31], [3.0, 1.0], [0.2, 1.6], [0.0, 0.9], [0.0, 2.2]]
)
tube = jax.jit(lambda x, r: jnp.stack(vt.tube_velocity(x, r, RADIUS, core=FINE)))


def loads():
    """Radial loads of a blade with tip loss, of one loaded inboard, and of an ideal disk with a hub."""
    span = (MIDDLES - HUB) / (RADIUS - HUB)
    shapes = (MIDDLES / RADIUS * jnp.sqrt(span * (1.0 - span)), jnp.sin(jnp.pi * span), jnp.ones(N))
    return [s / jnp.max(s) for s in shapes]


@jax.jit
def tubes(x, r, values):
    """Concentric tubes, each as strong as the load changes across it."""
    strength = -jnp.diff(jnp.pad(values, 1))
    each = jax.vmap(lambda a: jnp.stack(vt.tube_velocity(x, r, a, core=FINE)))(EDGES)
    return jnp.tensordot(strength, each, axes=1)


@jax.jit
def disk(x, r, values):
    """The disk of sinks of a load: axial and radial velocity, on either side."""
    amplitudes = vt.disk_amplitudes(EDGES, values, RADIUS)
    axial, radial = vt.disk_velocity(jnp.abs(x), r**2, RADIUS, amplitudes=amplitudes)
    return jnp.stack([jnp.sign(x) * axial, radial * r])


def ring_sheet(x, r):
    """Velocity of vortex rings of strength 2 per length from x = 0 aft, by the law of Biot and Savart.

    Quadrature by Gauss along the tube, mapped to infinity, and by the trapezoidal rule around it.
    """
    t, weight = np.polynomial.legendre.leggauss(400)
    s, scale = 2.0 * (1.0 + t) / (1.0 - t), weight * 4.0 / (1.0 - t) ** 2
    angle = 2.0 * np.pi * np.arange(400) / 400
    dx, y, z = x - s[:, None], r - RADIUS * np.cos(angle), -RADIUS * np.sin(angle)
    distance = (dx**2 + y**2 + z**2) ** 1.5
    # dl x d, dl along (-sin, cos) in (y, z), d from the ring to the point
    axial = -np.sin(angle) * z - np.cos(angle) * y
    radial = np.cos(angle) * dx
    factor = 2.0 * RADIUS / (4.0 * np.pi) * scale[:, None] / distance * 2.0 * np.pi / 400
    return np.sum(factor * axial), np.sum(factor * radial)


def test_elliptic_integrals():
    kc, one = jnp.array([1e-6, 1e-3, 0.3, 0.999]), jnp.ones(4)
    m1 = np.asarray(kc) ** 2
    np.testing.assert_allclose(vt.complete_elliptic(kc, one, one, one), special.ellipkm1(m1), rtol=1e-14)
    np.testing.assert_allclose(vt.complete_elliptic(kc, one, one, kc**2), special.ellipe(1.0 - m1), rtol=1e-14)
    for p in (1e-4, 0.2, 3.0):  # Pi by quadrature

        def integrand(t, p=p):
            c, s = np.cos(t) ** 2, np.sin(t) ** 2
            return 1.0 / ((c + p * s) * np.sqrt(c + 0.09 * s))

        expected = quad(integrand, 0.0, np.pi / 2, epsabs=1e-11, epsrel=1e-11, limit=200)[0]
        np.testing.assert_allclose(vt.complete_elliptic(0.3 * one, p * one, one, one), expected, rtol=1e-9)


def test_axis_of_a_tube():
    x = np.linspace(-8.0, 8.0, 9)
    axial, radial = tube(jnp.array(x), jnp.zeros(9))
    np.testing.assert_allclose(axial, 1.0 + x / np.hypot(x, RADIUS), rtol=1e-11)
    np.testing.assert_allclose(radial, 0.0, atol=1e-15)


def test_tube_is_a_sheet_of_vortex_rings():
    """Inside and outside, ahead and behind, against direct summation."""
    found = np.asarray(tube(*jnp.array(OFF_SHEET.T))).T
    np.testing.assert_allclose(found, [ring_sheet(x, r) for x, r in OFF_SHEET], atol=1e-9)


def test_uniform_inflow_at_the_disk_and_none_outside():
    axial = tube(jnp.zeros(4), RADIUS * jnp.array([0.2, 0.9, 1.1, 3.0]))[0]
    np.testing.assert_allclose(axial, [1.0, 1.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("field", ["tube", "disk"])
def test_no_divergence_and_no_vorticity_off_the_sheet(field):
    flow = tube if field == "tube" else lambda x, r: disk(x, r, loads()[0])
    for x, r in OFF_SHEET[[0, 1, 2, 3, 4, 5]]:
        (ux, by_x), (_, by_r) = (
            jax.jvp(flow, (jnp.array([x]), jnp.array([r])), tangent)
            for tangent in ((jnp.ones(1), jnp.zeros(1)), (jnp.zeros(1), jnp.ones(1)))
        )
        np.testing.assert_allclose(by_x[0] + by_r[1] + ux[1] / r, 0.0, atol=1e-9)
        np.testing.assert_allclose(by_x[1] - by_r[0], 0.0, atol=1e-9)


@pytest.mark.parametrize("angle", [0.8, 2.0, 3.0])
def test_far_away_it_is_a_sink_at_the_disk(angle):
    """Half the flow of the tube comes from either side: R^2 / 2 d^2 towards the hub."""
    d = 400.0 * RADIUS
    axial, radial = tube(jnp.array(d * np.cos(angle)), jnp.array(d * np.sin(angle)))
    size = RADIUS**2 / (2.0 * d**2)
    np.testing.assert_allclose(axial, -size * np.cos(angle), atol=1e-4 * size)
    np.testing.assert_allclose(radial, -size * np.sin(angle), atol=1e-4 * size)


@pytest.mark.parametrize("field", ["tube", "disk"])
def test_mass_through_a_cylinder_about_the_disk(field):
    """What enters through front and side leaves through the back: for the disk, with the tube of air added."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    outer, front, back = 1.7 * RADIUS, -0.8 * RADIUS, 1.2 * RADIUS
    load = loads()[0]
    flow = tube if field == "tube" else lambda x, r: disk(x, r, load)
    total = 0.0
    for lo, hi in ((0.0, RADIUS), (RADIUS, outer)):
        r, w = lo + 0.5 * (hi - lo) * (nodes + 1.0), 0.5 * (hi - lo) * weights
        ends = flow(jnp.full(60, back), jnp.array(r))[0] - flow(jnp.full(60, front), jnp.array(r))[0]
        total += np.sum(2.0 * np.pi * r * w * ends)
    x, w = front + 0.5 * (back - front) * (nodes + 1.0), 0.5 * (back - front) * weights
    total += 2.0 * np.pi * outer * np.sum(w * flow(jnp.array(x), jnp.full(60, outer))[1])
    if field == "disk":
        total += 4.0 * np.pi * np.sum(load * MIDDLES) * (EDGES[1] - EDGES[0])
    np.testing.assert_allclose(total, 0.0, atol=1e-5)


@pytest.mark.parametrize(("ahead", "tolerance"), [(0.2, 0.03), (0.4, 0.003), (1.0, 1e-4), (3.0, 1e-7)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_harmonics_are_the_superposed_tubes(ahead, tolerance, side):
    """Axial and radial velocity from the axis to three radii, relative to the largest load."""
    r = jnp.linspace(0.013, 3.0 * RADIUS, 60)
    x = jnp.full_like(r, side * ahead * RADIUS)
    for load in loads():
        inside = jnp.where((r > HUB) & (r < RADIUS), load[jnp.clip(jnp.searchsorted(EDGES, r) - 1, 0, N - 1)], 0.0)
        inside = jnp.stack([2.0 * inside * (side > 0.0), jnp.zeros_like(r)])
        np.testing.assert_allclose(disk(x, r, load) + inside, tubes(x, r, load), atol=tolerance)


def test_amplitudes_are_the_multipoles_and_close_at_the_edge():
    load = loads()[1]
    found = vt.disk_amplitudes(EDGES, load, RADIUS)
    mean = 2.0 * jnp.sum(load * MIDDLES) * (EDGES[1] - EDGES[0]) / RADIUS**2
    np.testing.assert_allclose(found[0], 0.5 * mean, rtol=1e-13)
    np.testing.assert_allclose(vt.EDGE @ found, 0.0, atol=1e-14)


def test_closed_forms_and_inverse_powers_meet():
    eta = vt.FAR * np.array([1.0 - 1e-13, 1.0 + 1e-13])
    at = jnp.array(eta)[:, None]
    for found in vt._decay(at, jnp.arctan2(1.0, at)):
        np.testing.assert_allclose(found[0], found[1], atol=2e-9)


def test_derivatives(check_derivatives):
    """Across the far switch, near the edge and the sheet, by places, radius, core and load."""
    x0, r0 = jnp.array([0.3, -0.2, 1.0, 9.0]), jnp.array([0.4, 1.35, 1.2, 3.0])

    def both(p):
        x, r = p[0] * x0, p[1] * r0
        exact = vt.tube_velocity(x, r, RADIUS * p[2], core=0.1 * p[3])
        amplitudes = vt.disk_amplitudes(EDGES * p[2], p[4] * loads()[0] + p[5] * loads()[1], RADIUS * p[2])
        fast = vt.disk_velocity(jnp.abs(x), r**2, RADIUS * p[2], amplitudes=amplitudes)
        return jnp.concatenate([*exact, *fast])

    check_derivatives(both, np.array([1.0, 1.0, 1.0, 1.0, 0.7, 0.3]))
