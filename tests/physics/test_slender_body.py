"""Slender body against closed forms: base lift, Munk's couple, yaw, rates, upwash, wing and body together."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics import slender_body
from hera_om.physics.fuselage import Fuselage, fuselage_moment_slope
from hera_om.physics.slender_body import (
    Crossflow,
    axis_points,
    bare_body_loads,
    body_field,
    body_loads,
    finite_length_factor,
    load_distribution,
    mean_body_field,
    segment_loads,
    separation_station,
)

BODY = Fuselage(27.5, 2.87, 2.63, 3.9, 8.3)
ROUND = Fuselage(30.0, 2.0, 2.0, 4.0, 6.0)
ROOT, X_TAIL = (11.0, 13.9), 26.0
PITCHED = Crossflow(0.1, 0.0, 0.0, 0.0, 0.0)
MODULE = "hera_om.physics.slender_body."


def spheroid(length, radius):
    """Area of a spheroid by station, its ends at 0 and ``length``."""
    return lambda x: 4.0 * np.pi * radius**2 * x * (length - x) / length**2


def test_lift_slope_of_a_body_with_a_base():
    # Munk: CN_alpha = 2 per radian on the base area, whatever the shape ahead; cone with its tip at 0
    force, moment = segment_loads(
        lambda x: np.pi * (0.1 * x) ** 2, lambda x: 0.0 * x + 1.0, jnp.asarray([0.0, 5.0]), x_ref=0.0
    )
    base = np.pi * 0.5**2
    np.testing.assert_allclose(force, 2.0 * base, rtol=1e-12)
    # a cone's lift acts at two thirds of its length
    np.testing.assert_allclose(moment, -2.0 * base * 5.0 * 2.0 / 3.0, rtol=1e-12)


@pytest.mark.parametrize("x_ref", [0.0, 7.0])
def test_couple_of_a_closed_body(x_ref):
    # Munk, NACA Report 184: no force, moment 2 Vol per radian about any point; spheroid: Vol = 2/3 pi r^2 l
    force, moment = segment_loads(spheroid(12.0, 1.0), lambda x: 0.0 * x + 1.0, jnp.asarray([0.0, 12.0]), x_ref=x_ref)
    np.testing.assert_allclose(force, 0.0, atol=1e-12)
    np.testing.assert_allclose(moment, 2.0 * 2.0 / 3.0 * np.pi * 12.0, rtol=1e-12)


def test_finite_length_is_that_of_the_spheroid():
    # exact potential flow of a spheroid: moment (k2 - k1) 2 Vol; Lamb's table at fineness 9.97: 0.960 - 0.021
    body = Fuselage(9.97, 1.0, 1.0, 2.0, 2.0)
    np.testing.assert_allclose(finite_length_factor(body), 0.939, atol=2e-3)


def test_moment_constant_of_multhopp():
    # per degree the couple is 1 / 36.5 of sum(w^2 dbeta/dalpha dx): Multhopp, NACA TM 1036; Nelson, eq. 2.29
    width, step = 2.0, 10.0
    _, moment = segment_loads(
        lambda x: np.pi / 4 * width**2 + 0.0 * x, lambda x: 0.0 * x + 1.0, jnp.asarray([0.0, step]), x_ref=0.0
    )
    cut = moment + 2.0 * np.pi / 4 * width**2 * step  # without the force at the open end
    np.testing.assert_allclose(np.deg2rad(float(cut)), width**2 * step / 36.5, rtol=1e-3)


def test_steady_turning_of_a_body_with_a_base():
    # slender-body theory (Nielsen, Missile Aerodynamics, section 10-4) of a cone of length l turning about its
    # tip: w = q x / V, N = 2 S_base q l / V, M = -2 (int S x dq - ...): centre of pressure at 3/4 of the length
    force, moment = segment_loads(lambda x: np.pi * (0.1 * x) ** 2, lambda x: x, jnp.asarray([0.0, 5.0]), x_ref=0.0)
    base = np.pi * 0.25
    np.testing.assert_allclose(force, 2.0 * base * 5.0, rtol=1e-12)
    np.testing.assert_allclose(-moment / force, 0.75 * 5.0, rtol=1e-12)


def test_nose_lift_and_moment_of_the_bare_body():
    # CN_alpha on the area at separation; cross-check of the moment by its distribution
    x0 = float(separation_station(ROUND))
    np.testing.assert_allclose(x0, 0.378 * 30.0 + 0.527 * 24.0)
    area = np.pi * (1.0 if x0 < 24.0 else (30.0 - x0) / 6.0) ** 2
    flow = PITCHED._replace(alpha=1.0, x_ref=11.0)
    loads = bare_body_loads(ROUND, flow=flow)
    k = finite_length_factor(ROUND)
    np.testing.assert_allclose(loads.force, [0.0, 0.0, 2.0 * k * area], rtol=1e-12)
    edges = np.concatenate([np.linspace(0, 4, 401), np.linspace(4, 24, 11)[1:], np.linspace(24, x0, 4001)[1:]])
    middle = (edges[1:] + edges[:-1]) / 2
    lift = load_distribution(ROUND, jnp.asarray(middle), flow=flow)[0] * np.diff(edges)
    np.testing.assert_allclose(np.sum(lift), loads.force[2], rtol=1e-6)
    np.testing.assert_allclose(-np.sum(lift * (middle - 11.0)), loads.moment[1], rtol=1e-6)


def test_signs_of_sideslip_and_yaw():
    # wind from starboard pushes the nose to port: CY < 0, nose to port (unstable, +z); turning the nose to
    # starboard, the air meets the rear from port and drives it to starboard
    slip = bare_body_loads(BODY, flow=Crossflow(0.0, 0.1, 0.0, 0.0, 12.0))
    assert slip.force[1] < 0.0 and slip.moment[2] > 0.0 and slip.force[2] == 0.0
    turn = bare_body_loads(BODY, flow=Crossflow(0.0, 0.0, 0.0, 0.01, 12.0))
    assert turn.force[1] > 0.0
    # a round body does not know pitch from yaw
    pitch = bare_body_loads(ROUND, flow=Crossflow(0.1, 0.0, 0.01, 0.0, 12.0))
    yaw = bare_body_loads(ROUND, flow=Crossflow(0.0, -0.1, 0.0, 0.01, 12.0))
    np.testing.assert_allclose(pitch.force[2], yaw.force[1], rtol=1e-12)
    np.testing.assert_allclose(pitch.moment[1], -yaw.moment[2], rtol=1e-12)


# Upwash d eps/d alpha ahead of a wing by distance to the leading edge over the root chord: Pamadi, Performance,
# Stability, Dynamics and Control of Airplanes, figure 3.9 (b), after Multhopp, read off the chart; for a wing
# of CL_alpha 0.0785 a degree.
CHART = np.array([[0.6, 0.316], [0.8, 0.235], [1.0, 0.182], [1.2, 0.150], [1.4, 0.112], [1.8, 0.068], [2.4, 0.042]])


def test_multhopp_by_his_sum():
    # the sum of the handbook, per degree, on 3000 pieces, for the upwash of the chart and the linear law aft
    (x_le, x_te), chord, downwash = ROOT, 2.9, 0.35
    x = np.linspace(0.0, float(separation_station(BODY)), 3001)
    middle, step = (x[1:] + x[:-1]) / 2, np.diff(x)
    share = np.clip(np.minimum(middle / 3.9, ((27.5 - middle) / 8.3) ** 2), 0.0, 1.0)
    upwash = np.interp((x_le - middle) / chord, *CHART.T)
    local = np.where(middle < x_le, 1.0 + upwash, 0.0)
    local = np.where(middle > x_te, (1.0 - downwash) * (middle - x_te) / (X_TAIL - x_te), local)
    per_degree = np.sum(2.87**2 * share * local * step) / 36.5
    points = axis_points(BODY, x_le=x_le, x_tail=X_TAIL)
    induced = jnp.append(np.interp((x_le - points[:-1, 0]) / chord, *CHART.T), -downwash)
    loads = body_loads(BODY, flow=PITCHED._replace(alpha=1.0), root=ROOT, x_tail=X_TAIL, induced=induced)
    k = float(finite_length_factor(BODY))
    # the handbook leaves out what the loads at the open ends turn about the nose
    ends = np.array([-x_le * 1.0, -x[-1] * (1.0 - downwash) * (x[-1] - x_te) / (X_TAIL - x_te)])
    ends *= 2.0 * np.pi / 4 * 2.87**2 * np.array([1.0, share[-1]])
    np.testing.assert_allclose(loads.moment[1] / k - np.sum(ends), per_degree * 180.0 / np.pi, rtol=2e-3)


def test_wing_makes_the_body_less_stable_than_munk_ahead_and_more_behind():
    nothing = jnp.zeros(9)
    points = axis_points(BODY, x_le=ROOT[0], x_tail=X_TAIL)
    assert points.shape == (9, 3) and np.all(points[:-1, 0] < ROOT[0]) and points[-1, 0] == X_TAIL
    calm = body_loads(BODY, flow=PITCHED, root=ROOT, x_tail=X_TAIL, induced=nothing)
    up = body_loads(BODY, flow=PITCHED, root=ROOT, x_tail=X_TAIL, induced=nothing.at[:-1].set(0.02))
    down = body_loads(BODY, flow=PITCHED, root=ROOT, x_tail=X_TAIL, induced=nothing.at[-1].set(-0.04))
    assert up.moment[1] > calm.moment[1]
    np.testing.assert_allclose(up.force, calm.force, rtol=1e-14)
    assert down.force[2] < calm.force[2]


def test_closed_body_reduces_to_the_present_slope(monkeypatch):
    # with the section's width in both directions and no separation it is Munk's 2 (k2 - k1) Vol
    monkeypatch.setattr(MODULE + "separation_station", lambda body: jnp.asarray(body.length))
    loads = bare_body_loads(ROUND, flow=PITCHED._replace(alpha=1.0))
    slope = fuselage_moment_slope(ROUND, S=1.0, length_ref=1.0, munk_factor=1.0)
    np.testing.assert_allclose(loads.moment[1], slope, rtol=1e-12)
    np.testing.assert_allclose(loads.force, 0.0, atol=1e-12)


def flow_past_circle(y, z):
    """Velocity of a unit stream along z past the unit circle, from the complex potential."""
    stream = y + 1j * z
    speed = -1j - 1j / stream**2  # d/dZ of -i (Z - 1 / Z): v - i w
    return speed.real, -speed.imag


@given(radius=st.floats(1.2, 20.0), angle=st.floats(0.0, 2 * np.pi))
def test_upwash_of_a_cylinder(radius, angle):
    y, z = radius * np.cos(angle), radius * np.sin(angle)
    field = body_field(ROUND, jnp.asarray([[12.0, y, z]]))
    v, w = flow_past_circle(y, z)
    np.testing.assert_allclose(field.by_w[0] + jnp.asarray([0.0, 0.0, 1.0]), [0.0, v, w], atol=1e-12)
    # the same flow turned by a right angle: along y
    v, w = flow_past_circle(-z, y)
    np.testing.assert_allclose(field.by_v[0] + jnp.asarray([0.0, 1.0, 0.0]), [0.0, w, -v], atol=1e-12)
    np.testing.assert_allclose(field.shield, 1.0)


def test_no_flow_inside_and_nothing_off_the_body():
    inside = jnp.asarray([[12.0, 0.0, 0.0], [12.0, 0.4, 0.3], [12.0, -0.84, 0.0]])
    field = body_field(ROUND, inside)
    np.testing.assert_array_equal(field.shield, 0.0)
    np.testing.assert_array_equal(field.by_w, 0.0)
    field = body_field(ROUND, jnp.asarray([[-1.0, 0.0, 0.0], [31.0, 0.0, 0.0], [31.0, 2.0, 1.0]]))
    np.testing.assert_array_equal(field.shield, 1.0)
    np.testing.assert_array_equal(field.by_v, 0.0)


def combined_lift(ratio):
    """Lift of a slender wing on a circular body over that of the wing alone, from the field at its points.

    A flat slender wing of elliptic loading in the normal velocity w(y) lifts as the mean of w weighted with
    its own load (reverse-flow theorem, exact for a slender wing: Jones, NACA Report 835).
    """
    angle = (np.arange(4000) + 0.5) * np.pi / 4000
    y = np.cos(angle) / ratio  # body of unit radius
    points = np.stack([np.full_like(y, 12.0), y, np.zeros_like(y)], axis=-1)
    field = body_field(ROUND, jnp.asarray(points))
    weight = np.sin(angle) ** 2
    return float(np.sum(weight * (field.shield + field.by_w[:, 2])) / np.sum(weight))


@pytest.mark.parametrize(("ratio", "rtol"), [(0.05, 0.002), (0.1, 0.006), (0.2, 0.02)])
def test_wing_with_carry_over_is_that_of_slender_body_theory(ratio, rtol):
    # NACA Report 1307: wing with carry-over (1 - a^2 / s^2)^2 of the wing through the body
    np.testing.assert_allclose(combined_lift(ratio), (1.0 - ratio**2) ** 2, rtol=rtol)


@pytest.mark.parametrize("switch", ["UPWASH", "SHIELD"])
def test_that_needs_both_upwash_and_shield(monkeypatch, switch):
    monkeypatch.setattr(slender_body, switch, 0.0)
    assert abs(combined_lift(0.1) - 0.99**2) > 0.08


def test_mean_over_a_strip_that_the_skin_cuts():
    # from the axis to two radii: half of it inside; upwash int_1^2 dy / y^2 / 2 = 1/4
    field = mean_body_field(ROUND, jnp.asarray([[12.0, 1.0, 0.0]]), jnp.asarray([[0.0, 2.0, 0.0]]))
    np.testing.assert_allclose(field.shield, 0.5, rtol=0.02)
    np.testing.assert_allclose(field.by_w[0], [0.0, 0.0, 0.25], atol=0.01)


def test_high_wing_in_sideslip_rolls_away_from_the_wind():
    # wind from starboard (v < 0) rises on the starboard side of the upper half: a high wing has dihedral effect
    field = body_field(BODY, jnp.asarray([[12.0, 2.5, 1.2], [12.0, -2.5, 1.2], [12.0, 2.5, -1.2]]))
    rise = -field.by_v[:, 2]
    assert rise[0] > 0.0
    np.testing.assert_allclose(rise[1:], -rise[0], rtol=1e-12)


def test_derivatives(check_derivatives):
    points = jnp.asarray([[12.0, 1.3, 0.4], [2.0, 2.0, 0.1], [24.0, 0.3, 0.2]])

    def outputs(x):
        body = Fuselage(27.5 * x[0], 2.87 * x[1], 2.63, 3.9 * x[2], 8.3)
        flow = Crossflow(0.1 * x[3], 0.05, 0.01, 0.01, 12.0)
        loads = body_loads(body, flow=flow, root=(11.0 * x[4], 13.9), x_tail=26.0, induced=0.02 * jnp.ones(9))
        field = body_field(body, points)
        return jnp.concatenate([loads.force, loads.moment / 10, field.shield, field.by_w.ravel(), field.by_v.ravel()])

    check_derivatives(outputs, np.ones(5), relative_step=1e-3, rtol=2e-6)
    assert np.all(np.isfinite(jax.jit(jax.jacfwd(outputs))(np.ones(5))))
