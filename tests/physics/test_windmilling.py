"""Rotors in every state: solved everywhere, stopped, feathered, turning without torque."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics import blade_polar as bp
from hera_om.physics import polar_extension as pe
from hera_om.physics import rotor as ro
from hera_om.physics.section_polar import SectionPolar
from hera_om.physics.windmilling import Known, feathering_pitch, windmilling_speed

RADIUS, HUB, NR, NPSI = 1.95, 0.2925, 8, 6
R = jnp.linspace(0.15, 1.0, 6)
CHORD = jnp.array([0.11, 0.135, 0.15, 0.15, 0.13, 0.06])
TWIST = jnp.radians(jnp.array([30.0, 20.0, 11.0, 4.0, -2.5, -8.0]))
POLAR = SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 1.0)
AIR = dict(density=0.55, sound_speed=312.0, sense=-1.0, n_blades=6.0, radius=RADIUS, hub_radius=HUB)
TURNS = 17.0
STEPS = np.radians(np.array([-14.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0, 16.0]))


def table():
    """A section that stalls sharply, over three Reynolds numbers."""
    cl = np.interp(STEPS, np.radians([-14.0, -10.0, 12.0, 16.0]), [-0.8, -0.7, 1.5, 1.2])
    cd = 0.008 + 0.01 * cl**2 + 0.15 * (np.abs(STEPS) > 0.22)
    alpha, cl, cd = pe.full_incidence(
        STEPS, np.stack([cl] * 3, 1), np.stack([1.5 * cd, cd, 0.8 * cd], 1), aspect_ratio=8
    )
    return bp.make_blade_table(alpha, [3e5, 1e6, 3e6], [0.0], cl=cl[..., None], cd=cd[..., None])


def blade(polar=POLAR):
    return ro.blade_elements(RADIUS, HUB, R, CHORD, TWIST, polar=polar, n=NR)


def stream(speed, incidence=0.0):
    flow = speed * jnp.stack([jnp.cos(incidence), 0.0 * jnp.sin(incidence), jnp.sin(incidence)])
    return jnp.broadcast_to(flow, (NR, NPSI, 3))


BLADES = {"numbers": blade(), "table": blade(table())}


@jax.jit
def states(pitch, J, incidence, omega):
    """The rotor with either polar, the table with stall delay, in one program."""
    where = stream(J * TURNS * 2.0 * RADIUS, incidence)
    case = dict(pitch=pitch, omega=omega, **AIR)
    delayed = ro.solve_rotor(BLADES["table"], where, stall_delay=True, viscosity=1.6e-5, **case)
    return ro.solve_rotor(BLADES["numbers"], where, **case), delayed


@settings(max_examples=150)
@given(pitch=st.floats(-20.0, 90.0), J=st.floats(0.0, 5.0), incidence=st.floats(-20.0, 20.0), turning=st.booleans())
def test_every_state_is_solved(pitch, J, incidence, turning):
    """Pitch -20 to 90 degrees, J 0 to 5, shaft at up to 20 degrees, turning or stopped: residual below 1e-9."""
    omega = 2.0 * np.pi * TURNS * turning
    for found in states(np.radians(pitch), J, np.radians(incidence), omega):
        assert float(found.residual) < 1e-9
        assert all(bool(jnp.all(jnp.isfinite(leaf))) for leaf in found)


@jax.jit
def free(pitch, speed, incidence):
    """Speed without torque with either polar, and what the rotor does there."""
    found = []
    for name, more in (("numbers", {}), ("table", {"viscosity": 1.6e-5})):
        where = stream(speed, incidence)
        omega = windmilling_speed(BLADES[name], where, pitch=pitch, **more, **AIR)
        found.append((omega, ro.solve_rotor(BLADES[name], where, pitch=pitch, omega=omega, **more, **AIR)))
    return found


@settings(max_examples=40)
@given(pitch=st.floats(-20.0, 95.0), speed=st.floats(5.0, 200.0), incidence=st.floats(-20.0, 20.0))
def test_no_torque_at_the_windmilling_speed(pitch, speed, incidence):
    for omega, found in free(np.radians(pitch), speed, np.radians(incidence)):
        tip = np.hypot(speed, float(omega) * RADIUS)
        assert abs(float(found.torque)) < 1e-9 * 0.55 * tip**2 * RADIUS**3
        assert float(found.residual) < 1e-9
        direction = np.array([np.cos(np.radians(incidence)), 0.0, np.sin(np.radians(incidence))])
        assert float(found.force @ direction) > 0.0  # it takes energy from the stream, whatever the shaft's incidence


def test_frictionless_screw():
    """A helical blade without drag turns as a screw in a nut, omega = 2 pi V / h, and carries nothing."""
    pitch_length = 4.0
    x = jnp.linspace(0.15, 1.0, 40)
    angle = jnp.arctan(pitch_length / (2.0 * np.pi * RADIUS * x))
    polar = SectionPolar(6.0, 0.0, 1e-9, 0.0, 0.01, 1.4, 0.0)
    screw = ro.blade_elements(RADIUS, HUB, x, jnp.full(40, 0.15), angle, polar=polar, n=NR)
    omega = windmilling_speed(screw, stream(90.0), pitch=0.0, **AIR)
    np.testing.assert_allclose(omega, 2.0 * np.pi * 90.0 / pitch_length, rtol=2e-3)


def test_feathered_and_stopped_rotors_drag_less_than_windmilling_ones():
    """At 30 degrees a free rotor brakes hard; feathered to 83 degrees it hardly turns and drags a fortieth."""
    (braking, windmill), _ = free(np.radians(30.0), 100.0, 0.0)
    (slow, feathered), _ = free(np.radians(83.0), 100.0, 0.0)
    assert float(braking) > 80.0
    assert abs(float(slow)) < 10.0
    stopped, _ = states(np.radians(83.0), 100.0 / (TURNS * 2.0 * RADIUS), 0.0, 0.0)
    assert 0.0 < -float(stopped.thrust) < -3.0 * float(windmill.thrust)
    assert 0.0 < -float(feathered.thrust)
    assert float(stopped.power) == 0.0 and float(stopped.CT) == 0.0


def test_blade_feathered_past_flat_turns_backwards():
    (omega, found), _ = free(np.radians(95.0), 100.0, 0.0)
    assert float(omega) < 0.0
    np.testing.assert_allclose(found.moment[0], 0.0, atol=1e-6)


@jax.jit
def edge_on(speed, incidence, twist):
    """Feathering pitch of the blade with more or less twist, and what the rotor does there."""
    feathered = blade()._replace(twist=twist * blade().twist)
    pitch = feathering_pitch(feathered, stream(speed, incidence), **AIR)
    return pitch, ro.solve_rotor(feathered, stream(speed, incidence), pitch=pitch, omega=0.0, **AIR)


@settings(max_examples=20)
@given(speed=st.floats(5.0, 200.0), incidence=st.floats(-15.0, 15.0), twist=st.floats(0.0, 1.5))
def test_no_torque_at_the_feathering_pitch(speed, incidence, twist):
    """Edge-on within the twist of the blade; the drag is at least that of sections at cd_min."""
    pitch, found = edge_on(speed, np.radians(incidence), twist)
    assert abs(float(found.torque)) < 1e-9 * 0.55 * speed**2 * RADIUS**3
    assert 72.0 < np.degrees(float(pitch)) < 92.0
    area, direction = 6.0 * float(jnp.sum(blade().chord * blade().dr)), np.radians(incidence)
    drag = float(found.force @ np.array([np.cos(direction), 0.0, np.sin(direction)]))
    assert drag > 0.5 * 0.55 * (speed * np.cos(direction)) ** 2 * area * 0.008


def test_an_untwisted_blade_feathers_at_its_angle_of_zero_lift():
    pitch, found = edge_on(100.0, 0.0, 0.0)
    mean = np.degrees(float(pitch))
    assert mean == pytest.approx(90.0 - 3.0, abs=0.1)  # drag edge-on has no torque, lift is none at -3 degrees
    area = 6.0 * float(jnp.sum(blade().chord * blade().dr))
    cd = 0.008 + 0.010 * 0.3**2
    assert -float(found.thrust) == pytest.approx(0.5 * 0.55 * 100.0**2 * area * cd, rel=0.02)


def test_drag_of_failed_rotors_over_pitch():
    """The negative thrust of a free rotor grows as its pitch falls, and feathering greatly reduces the drag of a locked
    one (Hartman, NACA Report 464, 1933). Free from friction, a rotor at a high pitch drags little.
    """
    drag = {}
    for pitch in (3.0, 20.0, 45.0):
        (_, windmill), _ = free(np.radians(pitch), 100.0, 0.0)
        locked, _ = states(np.radians(pitch), 100.0 / (TURNS * 2.0 * RADIUS), 0.0, 0.0)
        drag[pitch] = -float(windmill.thrust), -float(locked.thrust)
    feathered = -float(edge_on(100.0, 0.0, 1.0)[1].thrust)
    assert drag[3.0][0] > 1.5 * drag[3.0][1]
    assert drag[3.0][0] > 10.0 * drag[20.0][0] > 10.0 * drag[45.0][0] > 0.0
    assert 0.0 < feathered < 0.1 * drag[20.0][1]
    assert feathered < drag[20.0][0]
    disk, area = np.pi * RADIUS**2, 6.0 * float(jnp.sum(blade().chord * blade().dr))
    assert drag[3.0][0] < 1.3 * 0.5 * 0.55 * 100.0**2 * disk  # no more than a parachute of its disk
    assert drag[3.0][1] == pytest.approx(1.4 * 0.5 * 0.55 * 100.0**2 * area, rel=0.15)  # blades square to the stream


def test_a_known_answer_gives_value_and_derivatives():
    """Both searches, and their derivatives, from what was found before."""
    where = stream(100.0, 0.1)

    def both(x, known):
        case = AIR | {"density": x[1]}
        free = windmilling_speed(blade(), where * x[2], pitch=x[0], known=known and known[0], **case)
        return jnp.stack([free / 100.0, feathering_pitch(blade(), where * x[2], known=known and known[1], **case)])

    x = jnp.array([0.6, 0.55, 1.0])
    value = jax.jit(lambda x: both(x, None))(x)
    at = [
        ro.solve_rotor(blade(), where, pitch=pitch, omega=omega, **AIR).phi
        for pitch, omega in ((0.6, 100.0 * value[0]), (value[1], 0.0))
    ]
    known = Known(100.0 * value[0], at[0]), Known(value[1], at[1])
    np.testing.assert_allclose(jax.jit(lambda x: both(x, known))(x), value, rtol=1e-12)
    slopes = jax.jit(jax.jacfwd(lambda x: both(x, known)))(x)
    for i, h in enumerate((1e-4, 1e-4, 1e-4)):
        step = np.eye(3)[i] * h
        run = jax.jit(lambda x: both(x, None))
        np.testing.assert_allclose(slopes[:, i], (run(x + step) - run(x - step)) / (2.0 * h), atol=2e-6)


def test_first_derivative_of_the_windmilling_speed():
    def speed(x):
        return windmilling_speed(blade(), stream(100.0 * x[1], x[2]), pitch=x[0], **AIR)

    x, h, direction = np.array([0.6, 1.0, 0.1]), 1e-5, np.array([1.0, 0.3, 0.7])
    value = jax.jit(speed)
    exact = jax.jit(lambda x: jax.jvp(speed, (x,), (jnp.asarray(direction),))[1])(x)
    np.testing.assert_allclose(exact, (value(x + h * direction) - value(x - h * direction)) / (2.0 * h), rtol=1e-6)


@pytest.mark.slow
def test_windmilling_derivatives(check_derivatives):
    """First and second, by pitch, speed and incidence."""

    def speed(x):
        return windmilling_speed(blade(), stream(100.0 * x[1], x[2]), pitch=x[0], **AIR)[None] / 100.0

    check_derivatives(speed, np.array([0.6, 1.0, 0.1]))


@pytest.mark.slow
def test_derivatives_with_a_table(check_derivatives):
    """Loads by pitch, speed, incidence and chord with polars from a table, with stall delay and a stalled root."""

    def loads(x):
        chord = ro.blade_elements(RADIUS, HUB, R, x[3] * CHORD, TWIST, polar=table(), n=NR)
        found = ro.solve_rotor(
            chord, stream(100.0 * x[1], x[2]), pitch=x[0], omega=106.8, viscosity=1.6e-5, stall_delay=True, **AIR
        )
        return jnp.concatenate([found.force / 1e3, found.moment / 1e3, found.v_axial / 10.0])

    check_derivatives(loads, np.array([0.6, 0.5, 0.1, 1.0]), rtol=1e-5, relative_step=1e-4)


def test_stall_delay_raises_the_thrust_of_a_stalled_root():
    _, delayed = states(np.radians(45.0), 0.2, 0.0, 2.0 * np.pi * TURNS)
    where = stream(0.2 * TURNS * 2.0 * RADIUS)
    plain = ro.solve_rotor(
        BLADES["table"], where, pitch=np.radians(45.0), omega=2.0 * np.pi * TURNS, viscosity=1.6e-5, **AIR
    )
    gain = np.asarray(delayed.blade_thrust / plain.blade_thrust).mean(axis=1)
    assert gain[0] > 1.1
    assert gain[0] > gain[-1]
