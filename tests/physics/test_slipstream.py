"""Slipstream: momentum and swirl balance, geometry, signs, derivatives."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics import slipstream as ss
from hera_om.physics.rotor import blade_elements, sense_sign, solve_rotor
from hera_om.physics.section_polar import SectionPolar

RADIUS, HUB = 1.95, 0.29
X_AXIS = jnp.array([1.0, 0.0, 0.0])
N = 12
R_MID = HUB + (RADIUS - HUB) * (jnp.arange(N) + 0.5) / N
field = jax.jit(ss.slipstream_velocity)


def hera_blade():
    table = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0])
    chord = np.array([0.130, 0.140, 0.147, 0.150, 0.151, 0.150, 0.143, 0.122, 0.100, 0.060])
    twist = np.radians([28.50, 22.19, 16.35, 11.02, 6.23, 1.96, -1.84, -5.22, -6.76, -8.21])
    polar = SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 1.0)
    return blade_elements(RADIUS, HUB, jnp.array(table), jnp.array(chord), jnp.array(twist), polar=polar, n=20)


def uniform(**changes):
    """A rotor with uniform inflow 10 m/s and a swirl of 4 m/s, as keyword arguments of the field."""
    values = dict(hub=jnp.zeros(3), axis=X_AXIS, radius=RADIUS, r=R_MID, v_axial=jnp.full(N, 10.0))
    values |= dict(v_swirl=jnp.full(N, 4.0), sense=-1.0, speed=60.0, edge_width=0.1 * RADIUS)
    return values | changes


@pytest.mark.parametrize(
    ("speed", "pitch", "tolerance"),
    [(158.0, 46.5, 0.01), (60.0, 35.0, 0.01), (0.0, 20.0, 0.03), (158.0, 40.0, 0.01)],
)
def test_far_wake_carries_thrust_and_torque(speed, pitch, tolerance):
    """Flux of momentum and of its moment far behind are the thrust and torque of a rotor without tip losses.

    Cruise, climb, static and windmilling. At rest the profile of a real blade is not uniform enough for one
    contraction of the whole tube: 2 %.
    """
    blade, density = hera_blade(), 0.55
    stream = jnp.broadcast_to(jnp.array([speed, 0.0, 0.0]), (20, 4, 3))
    rotor = jax.jit(partial(solve_rotor, tip_loss=False, hub_loss=False))(
        blade, stream, pitch=np.radians(pitch), omega=106.8, radius=RADIUS, hub_radius=HUB, n_blades=6.0,
        density=density, sound_speed=312.0, sense=-1.0,
    )  # fmt: skip
    edges = jnp.linspace(0.0, 1.5 * RADIUS, 4001)
    r = 0.5 * (edges[1:] + edges[:-1])
    points = jnp.stack([jnp.full_like(r, 60.0 * RADIUS), r, jnp.zeros_like(r)], axis=1)
    v = field(
        points, hub=jnp.zeros(3), axis=X_AXIS, radius=RADIUS, r=blade.r, v_axial=rotor.v_axial,
        v_swirl=rotor.v_swirl, sense=-1.0, speed=speed, edge_width=0.1 * RADIUS,
    )  # fmt: skip
    mass = density * (speed + v[:, 0]) * jnp.pi * jnp.diff(edges**2)
    np.testing.assert_allclose(jnp.sum(mass * v[:, 0]), rotor.thrust, rtol=tolerance)
    np.testing.assert_allclose(-jnp.sum(mass * r * v[:, 2]), rotor.torque, rtol=tolerance)


def test_axial_velocity_doubles_and_follows_the_vortex_cylinder():
    """1 + x / sqrt(x^2 + R^2) on the axis of a cylinder of vortex rings, at the same fraction of the
    tube's radius."""
    x = RADIUS * np.array([-1.0, 0.0, 1.0, 200.0])
    kappa = x / np.sqrt(x**2 + RADIUS**2)
    narrowing = ss.contraction(jnp.array(kappa), ss.disk_mean(R_MID, jnp.full(N, 10.0), RADIUS), 60.0)
    points = jnp.stack([jnp.array(x), 0.6 * RADIUS * narrowing, jnp.zeros(4)], axis=1)
    v = field(points, **uniform(v_swirl=jnp.zeros(N)))
    np.testing.assert_allclose(v[:, 0], 10.0 * (1.0 + kappa), rtol=1e-12)
    np.testing.assert_allclose(v[-1, 0], 20.0, rtol=1e-4)


def test_static_tube_contracts_to_the_square_root_of_one_half():
    np.testing.assert_allclose(ss.contraction(jnp.array(1.0), 10.0, 0.0), np.sqrt(0.5), rtol=1e-12)
    np.testing.assert_allclose(ss.contraction(jnp.array(1.0), 10.0, 60.0), np.sqrt(70.0 / 80.0), rtol=1e-12)
    assert float(ss.contraction(jnp.array(1.0), -55.0, 60.0)) < 2.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_inboard_up_lifts_the_air_behind_the_inboard_half(side):
    inboard = jnp.array([[0.5 * RADIUS, -side * 0.6 * RADIUS, 0.0], [0.5 * RADIUS, side * 0.6 * RADIUS, 0.0]])
    v = field(inboard, **uniform(sense=sense_sign("inboard-up", side)))
    assert float(v[0, 2]) > 7.0
    assert float(v[1, 2]) < -7.0


def test_swirl_starts_at_the_disk_and_keeps_its_moment():
    y = 0.5 * RADIUS
    v = field(jnp.array([[-0.2 * RADIUS, y, 0.0], [0.0, y, 0.0], [0.2 * RADIUS, y, 0.0]]), **uniform())
    np.testing.assert_allclose(v[0, 2], 0.0, atol=1e-14)
    np.testing.assert_allclose(v[1, 2], -4.0, rtol=1e-9)
    narrowing = ss.contraction(ss.axial_development(jnp.array(0.2 * RADIUS), RADIUS), 10.0 * 0.978, 60.0)
    np.testing.assert_allclose(v[2, 2] * narrowing, -8.0, rtol=1e-3)


def test_nothing_outside_the_tube_and_on_the_axis():
    points = jnp.array([[1.0, 1.06 * RADIUS, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.5 * HUB]])
    np.testing.assert_array_equal(field(points, **uniform()), jnp.zeros((3, 3)))


@settings(deadline=None, max_examples=25)
@given(angle=st.floats(-3.0, 3.0), x=st.floats(-2.0, 9.0), y=st.floats(-2.0, 2.0), z=st.floats(-2.0, 2.0))
def test_rotation_and_mirror_symmetry(angle, x, y, z):
    turn = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(angle), -np.sin(angle)], [0.0, np.sin(angle), np.cos(angle)]])
    point = np.array([[x, y, z]])
    v = field(jnp.array(point), **uniform())
    np.testing.assert_allclose(field(jnp.array(point @ turn.T), **uniform()), v @ turn.T, atol=1e-9)
    mirror = np.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(field(jnp.array(point * mirror), **uniform(sense=1.0)), v * mirror, atol=1e-9)


def parametrised(p):
    """Velocities at points in the edge, the hub zone, on the axis and ahead, by twelve parameters."""
    points = jnp.array(
        [
            [2.0, 1.9, 0.2],
            [0.1, 0.28, 0.05],
            [1.0, 0.0, 0.0],
            [-0.5, 1.0, 0.7],
            [9.0, -1.3, 0.4],
            [0.05, 1.2, -0.3],
        ]
    )
    axis = jnp.stack([jnp.cos(p[3]), jnp.zeros(()), jnp.sin(p[3])])
    profile = jnp.sin(jnp.pi * (R_MID - HUB) / (RADIUS - HUB))
    return ss.slipstream_velocity(
        points * p[9], hub=p[:3], axis=axis, radius=RADIUS * p[4], r=R_MID * p[4], v_axial=p[5] * profile,
        v_swirl=p[6] * profile, sense=-1.0, speed=p[7], edge_width=p[8],
    )  # fmt: skip


P0 = jnp.array([0.01, -0.02, 0.03, 0.05, 1.02, 11.0, 4.0, 60.0, 0.2, 1.0])


def test_first_and_second_derivatives():
    first = jax.jit(jax.jacfwd(parametrised))
    second = jax.jit(jax.jacfwd(jax.jacfwd(parametrised)))(P0)
    value, h = jax.jit(parametrised), 2e-5
    for function, exact, tolerance in ((value, first(P0), 1e-6), (first, second, 1e-5)):
        for i in range(P0.shape[0]):
            step = h * jnp.zeros_like(P0).at[i].set(1.0)
            coarse = (function(P0 + 2 * step) - function(P0 - 2 * step)) / (4 * h)
            fine = (function(P0 + step) - function(P0 - step)) / (2 * h)
            scale = float(jnp.max(jnp.abs(exact)))
            np.testing.assert_allclose(exact[..., i], (4 * fine - coarse) / 3, atol=tolerance * scale)


def test_reverse_mode_agrees():
    def total(p):
        return jnp.sum(parametrised(p) ** 2)

    np.testing.assert_allclose(jax.jit(jax.grad(total))(P0), jax.jit(jax.jacfwd(total))(P0), rtol=1e-9, atol=1e-9)
