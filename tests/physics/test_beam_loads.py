"""Section loads of a cantilever against closed forms, signs, smoothness and relief."""

import tomllib

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics import beam_loads
from hera_om.physics.beam_loads import (
    SpanLoad,
    inertia_load,
    outboard_share,
    point_load,
    point_mass,
    section_loads,
    spread_mass,
    strip_load,
)

N = 6
SPAN = 10.0


def straight_axis(y, x=0.0, z=0.0):
    return jnp.stack([jnp.full_like(y, x), y, jnp.full_like(y, z)], axis=1)


def lift_strips(edges, running, x=0.0):
    """Strips with lift ``running(y)`` per metre at their middle."""
    middle = 0.5 * (edges[1:] + edges[:-1])
    forces = jnp.zeros((middle.size, 3)).at[:, 2].set(running(middle) * jnp.diff(edges))
    return strip_load(edges, straight_axis(middle, x), forces=forces, moments=jnp.zeros_like(forces))


def single(position, force, moment=(0.0, 0.0, 0.0)):
    return point_load(jnp.array([position]), forces=jnp.array([force]), moments=jnp.array([moment]))


def test_cantilever_under_uniform_load():
    q = 1000.0
    y = jnp.linspace(1.0, SPAN, N)
    loads = section_loads(y, straight_axis(y), lift_strips(jnp.linspace(0.0, SPAN, 21), lambda s: q + 0 * s))
    arm = SPAN - np.asarray(y)
    # The rounding adds q w^2 / 24 to the bending and takes q w / 8 from the shear at the very tip.
    np.testing.assert_allclose(loads.V[:-1], q * arm[:-1], rtol=1e-12)
    np.testing.assert_allclose(loads.M[:-1], q * arm[:-1] ** 2 / 2 + q * 0.1**2 / 24, rtol=1e-10)
    np.testing.assert_allclose(loads.M[0], q * arm[0] ** 2 / 2, rtol=2e-5)


def test_elliptic_load_acts_at_four_over_three_pi(reference):
    value = tomllib.loads((reference / "structures_closed_form.toml").read_text())["elliptic_load_semispan"]["value"]
    y = jnp.linspace(0.5, SPAN, N)
    edges = SPAN * jnp.sin(jnp.linspace(0.0, jnp.pi / 2, 101))
    loads = section_loads(y, straight_axis(y), lift_strips(edges, lambda s: 1e4 * jnp.sqrt(1 - (s / SPAN) ** 2)))
    whole = 1e4 * np.pi / 4 * SPAN

    def outboard(eta):  # lift and first moment outboard of eta, exact
        lift = whole * 2 / np.pi * (np.arccos(eta) - eta * np.sqrt(1 - eta**2))
        return lift, whole * SPAN * 4 / (3 * np.pi) * (1 - eta**2) ** 1.5

    lift, first = outboard(np.asarray(y) / SPAN)
    np.testing.assert_allclose(loads.V[:-1], lift[:-1], rtol=1e-3)
    np.testing.assert_allclose(loads.M[:-1], (first - lift * np.asarray(y))[:-1], rtol=2e-3)
    whole_span = y - 0.7  # the first station lies inboard of all the load
    root = section_loads(
        whole_span,
        straight_axis(whole_span),
        lift_strips(edges, lambda s: 1e4 * jnp.sqrt(1 - (s / SPAN) ** 2)),
    )
    centroid = (root.M[0] / root.V[0] - 0.2) / SPAN
    assert float(centroid) == pytest.approx(value, rel=1e-3)


def test_signs_of_bending_and_torsion():
    y = jnp.linspace(0.0, SPAN, N)
    axis = straight_axis(y, x=2.0, z=1.0)
    lift_ahead = section_loads(y, axis, single([1.5, 5.0, 1.0], [0.0, 0.0, 100.0]))
    np.testing.assert_allclose([lift_ahead.V[0], lift_ahead.M[0], lift_ahead.T[0]], [100.0, 500.0, 50.0], rtol=1e-9)
    # Thrust (forward, -x) below the axis turns the nose up; thrust bends the tip forward.
    thrust = section_loads(y, axis, single([0.0, 5.0, 0.7], [-100.0, 0.0, 0.0]))
    np.testing.assert_allclose([thrust.T[0], thrust.Mz[0], thrust.H[0]], [30.0, 500.0, -100.0], rtol=1e-9)
    np.testing.assert_allclose(thrust.M, 0.0, atol=1e-9)
    torque = section_loads(y, axis, single([0.0, 5.0, 0.7], [0.0, 0.0, 0.0], [7.0, 11.0, 13.0]))
    np.testing.assert_allclose([torque.M[0], torque.T[0], torque.Mz[0]], [7.0, 11.0, 13.0], rtol=1e-9)
    np.testing.assert_allclose(torque.T[y > 5.5], 0.0, atol=1e-12)


@given(st.floats(0.05, 0.6), st.floats(-0.3, 0.3))
def test_root_loads_are_the_resultant_on_a_swept_dihedral_axis(sweep, dihedral):
    y = jnp.linspace(0.0, SPAN, N)
    axis = jnp.stack([sweep * y, y, dihedral * y], axis=1)
    point, force, moment = np.array([3.0, 6.0, 0.4]), np.array([-20.0, 5.0, 100.0]), np.array([4.0, 5.0, 6.0])
    loads = section_loads(y, axis, single(list(point), list(force), tuple(moment)))
    total = np.cross(point, force) + moment
    # The resolved parts must have the length and the axis component of the vectors.
    along = np.array([sweep, 1.0, dihedral]) / np.linalg.norm([sweep, 1.0, dihedral])
    assert float(loads.T[0]) == pytest.approx(total @ along, rel=1e-9)
    length = np.sqrt(float(loads.M[0]) ** 2 + float(loads.T[0]) ** 2 + float(loads.Mz[0]) ** 2)
    assert length == pytest.approx(np.linalg.norm(total), rel=1e-9)


@given(st.lists(st.floats(0.2, 3.0), min_size=5, max_size=5))
def test_share_is_a_partition_of_unity(widths):
    edges = jnp.cumsum(jnp.asarray([0.0, *widths]))
    y = jnp.linspace(-1.0, float(edges[-1]) + 1.0, 8)
    share, arm = outboard_share(y, edges[:-1], edges[1:])
    whole, whole_arm = outboard_share(y, edges[:1], edges[-1:])
    # A uniform load cut into strips is the uniform load.
    fractions = jnp.diff(edges) / edges[-1]
    np.testing.assert_allclose(share @ fractions, whole[:, 0], atol=1e-12)
    np.testing.assert_allclose(arm @ fractions, whole_arm[:, 0], atol=1e-12)


def test_loads_are_smooth_while_a_hub_crosses_a_station():
    y = jnp.linspace(0.0, SPAN, N)

    def loads(hub):
        position = jnp.stack([-1.0 + 0 * hub, hub, 0 * hub])[None]
        force = jnp.array([[0.0, 0.0, -3e3]])
        result = section_loads(y, straight_axis(y), point_load(position, forces=force, moments=0 * force))
        return jnp.concatenate([result.V, result.M, result.T])

    jacobian = jax.jit(jax.jacfwd(loads))
    h = 1e-5
    for hub in np.linspace(3.75, 4.25, 26) + 1e-3:  # a station lies at 4
        central = (loads(jnp.asarray(hub + h)) - loads(jnp.asarray(hub - h))) / (2 * h)
        scale = float(jnp.max(jnp.abs(central)))
        np.testing.assert_allclose(jacobian(jnp.asarray(hub)), central, atol=2e-4 * scale)
    # The slope itself has no step: neighbouring values differ by what the steps of 0.1 mm allow.
    slopes = np.stack([jacobian(jnp.asarray(hub)) for hub in np.arange(3.8, 3.8003, 1e-4)])
    assert np.max(np.abs(np.diff(slopes, axis=0))) < 20.0 < np.max(np.abs(slopes))


def test_derivatives_by_everything(check_derivatives):
    y = jnp.linspace(1.0, SPAN, N)
    edges = jnp.linspace(0.0, SPAN, 5)

    def loads(p):
        strips = lift_strips(edges * (1 + 0.1 * p[0]), lambda s: 1e3 * (1 + p[1] * s), x=0.2 * p[2])
        mass = spread_mass(100.0 * p[3], edges, intensity=1.0 + edges[1:], points=straight_axis(edges[1:]))
        axis = straight_axis(y * (1 + 0.01 * p[4]), x=0.1)
        result = section_loads(y, axis, strips, inertia_load(mass, 2.5))
        return jnp.concatenate([result.V / 1e4, result.M / 1e4, result.T / 1e4])

    check_derivatives(loads, [0.3, 0.2, 0.7, 1.1, 0.4])


def wing_case(hub=4.1, load_factor=2.5):
    y = jnp.linspace(1.45, 14.5, N)
    edges = jnp.linspace(0.0, 14.5, 13)
    air = lift_strips(edges, lambda s: 3e4 * jnp.sqrt(1 - (s / 14.5) ** 2))
    none = jnp.zeros((1, 3))
    rotor = point_load(jnp.array([[-1.6, hub, -0.35]]), forces=none, moments=none)
    structure = spread_mass(1650.0, edges, intensity=1.0 - 0.03 * edges[1:], points=straight_axis(edges[1:]))
    motor = point_mass(jnp.array([1075.0]), jnp.array([[-1.6, hub, -0.35]]))
    relief = (inertia_load(item, load_factor) for item in (structure, motor))
    return section_loads(y, straight_axis(y), air, rotor, *relief)


def test_masses_relieve_and_an_engine_farther_out_relieves_more(monkeypatch):
    base, outboard = wing_case(), wing_case(hub=8.0)
    arm = 8.0 - 4.1
    relief = 2.5 * 9.80665 * 1075.0 * arm
    assert float(base.M[0] - outboard.M[0]) == pytest.approx(relief, rel=1e-9)
    monkeypatch.setattr(beam_loads, "inertia_forces", lambda mass, n: jnp.zeros((mass.size, 3)))
    bare = wing_case()
    assert float(bare.M[0]) > 1.15 * float(base.M[0])
    weight = 2.5 * 9.80665 * 1075.0
    # Engine weight alone at the root, and structure that sums to its mass.
    assert float(bare.V[0] - base.V[0]) > weight


def test_spread_mass_keeps_the_total():
    edges = jnp.asarray([0.0, 1.0, 4.0, 5.0])
    mass = spread_mass(600.0, edges, intensity=jnp.asarray([3.0, 2.0, 1.0]), points=straight_axis(edges[1:]))
    np.testing.assert_allclose(mass.mass, [180.0, 360.0, 60.0], rtol=1e-12)
    assert isinstance(inertia_load(mass, 1.0), SpanLoad)
    np.testing.assert_allclose(inertia_load(mass, -1.0).forces[:, 2], 9.80665 * mass.mass, rtol=1e-12)
