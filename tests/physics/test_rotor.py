"""Rotor: reference cases, momentum theory, states of operation, symmetry, derivatives."""

from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics import blade_loads as bl
from hera_om.physics import rotor as ro
from hera_om.physics.section_polar import SectionPolar

REFERENCE = Path(__file__).parents[1] / "reference"
solve = jax.jit(ro.solve_rotor, static_argnames=("tip_loss", "hub_loss"))
without_losses = partial(solve, tip_loss=False, hub_loss=False)

RADIUS, HUB = 1.95, 0.2925
R_TABLE = jnp.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0])
C_TABLE = jnp.array([0.130, 0.140, 0.147, 0.150, 0.151, 0.150, 0.143, 0.122, 0.100, 0.060])
TWIST_TABLE = jnp.radians(jnp.array([28.50, 22.19, 16.35, 11.02, 6.23, 1.96, -1.84, -5.22, -6.76, -8.21]))
POLAR = SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 1.0)
NR, NPSI = 10, 12
BLADE = ro.blade_elements(RADIUS, HUB, R_TABLE, C_TABLE, TWIST_TABLE, polar=POLAR, n=NR)
CRUISE = dict(pitch=np.radians(46.5), omega=106.8, radius=RADIUS, hub_radius=HUB, n_blades=6.0)
CRUISE |= dict(density=0.55, sound_speed=312.0, sense=-1.0)


def stream(velocity, nr=NR, npsi=NPSI):
    """The same velocity at every element."""
    return jnp.broadcast_to(jnp.asarray(velocity, dtype=float), (nr, npsi, 3))


def read(name):
    """Numbers of a reference file: comment lines, then one line of names, then rows."""
    text = (REFERENCE / name).read_text().splitlines()
    rows = [line.split(",") for line in text if line and not line.startswith("#")]
    return np.array([[float(value) for value in row] for row in rows[1:]])


def test_analytic_propeller():
    """The file's 40 speeds, windmilling included, to its own tolerance of 1e-2 N and 2e-3 N m."""
    r = jnp.linspace(0.08, 0.8, 11)
    polar = SectionPolar(6.2, 0.0, 0.008 - 0.000225, 0.15, 0.01, 1e9, 0.0)
    blade = ro.Blade(r, jnp.full(11, 0.072), jnp.full(11, 0.1), jnp.arctan(1.0 / (2.0 * jnp.pi * r)), polar)
    for speed, thrust, torque in read("prop_bemt_analytic_T_Q.csv"):
        found = without_losses(
            blade, stream([speed, 0.0, 0.0], 11, 4), pitch=0.0, omega=2100.0 * 2.0 * np.pi / 60.0, radius=0.8,
            hub_radius=0.08, n_blades=2.0, density=1.225, sound_speed=340.0, sense=1.0,
        )  # fmt: skip
        np.testing.assert_allclose(found.thrust, thrust, atol=1e-2)
        np.testing.assert_allclose(found.torque, torque, atol=2e-3)


def test_ccblade_propeller():
    """CT and CP of CCBlade within 1 %.

    Its polar is replaced by the law that it obeys where attached; the file does not say how many elements
    CCBlade used, and a difference of 0.2 % lies between 40 and 80 of ours.
    """
    table = read("atr_like/prop6.csv")
    radius = 0.5 * 3.93
    polar = SectionPolar(5.9, np.radians(-2.0), 0.010, 0.35, 0.008, 1.4, 0.0)
    blade = ro.blade_elements(
        radius, 0.2 * radius, jnp.array(table[:, 0]), jnp.array(table[:, 1]), jnp.radians(table[:, 3] - 38.0),
        polar=polar, n=40,
    )  # fmt: skip
    for J, CT, CP, eta in read("atr_like/bemt_propeller.csv"):
        found = solve(
            blade, stream([J * 20.0 * 3.93, 0.0, 0.0], 40, 4), pitch=np.radians(38.0), omega=40.0 * np.pi,
            radius=radius, hub_radius=0.2 * radius, n_blades=6.0, density=1.225, sound_speed=340.0,
            sense=-1.0,
        )  # fmt: skip
        np.testing.assert_allclose(found.CT, CT, rtol=0.01)
        np.testing.assert_allclose(found.CP, CP, rtol=0.01)
        np.testing.assert_allclose(bl.efficiency(found, J * 20.0 * 3.93), eta, rtol=2e-3)


def test_momentum_and_turbulent_wake_states():
    """Thrust coefficient of every annulus against a: 4a(1-a) up to a = 0.4, then Buhl's line within 0.04."""
    seen = []
    for pitch in np.radians([2.0, 5.0, 8.0, 11.0, 14.0, 17.0]):
        polar = SectionPolar(6.0, 0.0, 1e-4, 0.0, 0.0, 1e9, 0.0)
        blade = BLADE._replace(polar=polar, chord=3.0 * BLADE.chord)
        found = without_losses(blade, stream([60.0, 0.0, 0.0]), **(CRUISE | dict(pitch=pitch)))
        a = -np.asarray(found.v_axial) / 60.0
        area_pressure = 0.5 * 0.55 * 60.0**2 * 2.0 * np.pi * np.asarray(blade.r)
        loading = -6.0 * np.asarray(found.blade_thrust).mean(axis=1) / area_pressure
        seen.append(np.stack([a, loading]))
    a, loading = np.concatenate(seen, axis=1)
    low, high = a < 0.4, (a > 0.45) & (a < 1.0)
    assert low.sum() > 5 and high.sum() > 5
    np.testing.assert_allclose(loading[low], (4.0 * a * (1.0 - a))[low], atol=1e-6)
    buhl = 8.0 / 9.0 - 4.0 / 9.0 * a + 14.0 / 9.0 * a**2
    np.testing.assert_allclose(loading[high], buhl[high], atol=0.04)


def test_static_thrust_against_the_ideal_rotor():
    """Figure of merit below one and not absurd; mean induced velocity near sqrt(T / 2 rho A)."""
    found = solve(BLADE, stream([0.0, 0.0, 0.0]), **(CRUISE | dict(pitch=np.radians(20.0))))
    ideal = float(found.thrust) ** 1.5 / np.sqrt(2.0 * 0.55 * np.pi * RADIUS**2)
    assert 0.6 < ideal / float(found.power) < 0.9
    mean = np.sum(np.asarray(found.v_axial * BLADE.r * BLADE.dr)) * 2.0 / RADIUS**2
    ideal_velocity = np.sqrt(float(found.thrust) / (2.0 * 0.55 * np.pi * RADIUS**2))
    np.testing.assert_allclose(mean, ideal_velocity, rtol=0.08)


def test_static_thrust_is_continuous_through_zero_speed():
    thrust = [
        float(solve(BLADE, stream([v, 0.0, 0.0]), **(CRUISE | dict(pitch=np.radians(p)))).thrust)
        for p in (20.0, -20.0)
        for v in (-1e-3, 0.0, 1e-3)
    ]
    np.testing.assert_allclose(thrust[0:3], thrust[1], rtol=1e-4)
    np.testing.assert_allclose(thrust[3:6], thrust[4], rtol=1e-4)
    assert thrust[4] < 0.0 < thrust[1]


def test_every_state_is_finite_with_its_derivatives():
    """J from -0.3 to 3, pitch from -20 to 90 degrees: finite, solved, and of the right sign."""

    def state(x):
        velocity = x[1] * jnp.ones((NR, 4, 1)) * jnp.array([1.0, 0.0, 0.0])
        return ro.solve_rotor(BLADE, velocity, **(CRUISE | {"pitch": x[0]}))

    both = jax.jit(lambda x: (state(x), jax.jacfwd(state)(x)))
    for J in (-0.3, 0.0, 0.2, 0.7, 1.5, 2.3, 3.0):
        for pitch in np.radians([-20.0, 0.0, 20.0, 40.0, 60.0, 80.0, 90.0]):
            found, slopes = both(jnp.array([pitch, J * 17.0 * 3.9]))
            leaves = jax.tree_util.tree_leaves((found, slopes))
            assert all(bool(jnp.all(jnp.isfinite(leaf))) for leaf in leaves)
            assert float(found.residual) < 1e-10
    propeller, brake = both(jnp.array([0.7, 60.0]))[0], both(jnp.array([0.35, 160.0]))[0]
    assert propeller.thrust > 0.0 and propeller.torque > 0.0
    assert brake.thrust < 0.0 and brake.torque < 0.0


def test_stopped_rotors():
    """Feathered in the stream it drags a little, square to the stream a lot; in still air nothing at all."""
    drag = []
    for pitch in (90.0, 0.0):
        found = solve(BLADE, stream([100.0, 0.0, 0.0]), **(CRUISE | dict(pitch=np.radians(pitch), omega=0.0)))
        drag.append(-float(found.thrust))
        assert float(found.CT) == 0.0 and float(found.power) == 0.0
    assert 0.0 < 5.0 * drag[0] < drag[1]
    still = solve(BLADE, stream([0.0, 0.0, 0.0]), **(CRUISE | dict(omega=0.0)))
    np.testing.assert_allclose(still.force, np.zeros(3), atol=1e-9)


def test_inclined_rotor_has_the_normal_force_of_its_side_area():
    """Ribner (NACA Report 820): a fin of the projected side area, aspect ratio 8, in the stream at the disk.

    Three blades, as in his tests: the one aspect ratio cannot stand for the mutual induction of six.
    """
    incidence, speed = 0.02, 158.0
    blade = BLADE._replace(polar=POLAR._replace(compressible=0.0))
    direction = np.array([np.cos(incidence), 0.0, np.sin(incidence)])
    found = solve(blade, stream(speed * direction), **(CRUISE | dict(n_blades=3.0)))
    side_area = 1.5 * float(jnp.sum(BLADE.chord * BLADE.dr * jnp.sin(BLADE.twist + CRUISE["pitch"])))
    mean = float(jnp.sum(found.v_axial * BLADE.r * BLADE.dr)) * 2.0 / RADIUS**2
    fin = 0.5 * 0.55 * (speed + mean) ** 2 * side_area * 6.0 / (1.0 + 2.0 / 8.0) * incidence
    np.testing.assert_allclose(found.force[2], fin, rtol=0.25)
    assert float(found.moment[2]) > 0.0  # the starboard blade goes down, sees more, and yaws the nose to port
    np.testing.assert_allclose(found.moment[0], found.torque, rtol=1e-12)


def test_loads_of_a_section_around_the_disk():
    """At incidence the going-down blade, to starboard of a rotor turning clockwise, carries most (Fig. 9's 1/rev)."""
    found = solve(BLADE, stream([158.0, 0.0, 12.0]), **CRUISE)
    case = dict(omega=CRUISE["omega"], radius=RADIUS, density=CRUISE["density"])
    loading = bl.section_loading(found, BLADE, 0.75, **case)
    first = np.fft.rfft(np.asarray(loading))
    np.testing.assert_allclose(np.angle(first[1]), 0.0, atol=0.05)
    assert abs(first[1]) > 10.0 * abs(first[2])
    every = np.array([bl.section_loading(found, BLADE, r / RADIUS, **case) for r in BLADE.r]).mean(axis=1)
    thrust = 6.0 * np.sum(every * np.asarray(BLADE.dr)) / (2.0 * RADIUS)
    np.testing.assert_allclose(thrust, found.CT, rtol=1e-12)
    assert float(bl.efficiency(solve(BLADE, stream([0.0, 0.0, 0.0]), **(CRUISE | dict(omega=0.0))), 0.0)) == 0.0


@settings(deadline=None, max_examples=15)
@given(w=st.floats(-40.0, 40.0), v=st.floats(-40.0, 40.0), speed=st.floats(0.0, 200.0), pitch=st.floats(0.2, 1.2))
def test_mirror_and_quarter_turn(w, v, speed, pitch):
    """Opposite sense in the mirrored stream gives mirrored loads; a turned stream gives turned loads."""
    case = CRUISE | {"pitch": pitch}
    base = solve(BLADE, stream([speed, v, w]), **case)
    mirrored = solve(BLADE, stream([speed, -v, w]), **(case | dict(sense=1.0)))
    turned = solve(BLADE, stream([speed, -w, v]), **case)
    scale = float(jnp.max(jnp.abs(base.moment))) + float(jnp.max(jnp.abs(base.force)))
    np.testing.assert_allclose(mirrored.force, base.force * jnp.array([1.0, -1.0, 1.0]), atol=1e-9 * scale)
    np.testing.assert_allclose(mirrored.moment, base.moment * jnp.array([-1.0, 1.0, -1.0]), atol=1e-9 * scale)
    np.testing.assert_allclose(mirrored.v_swirl, base.v_swirl, atol=1e-9 * (1.0 + speed))
    quarter = base.force[jnp.array([0, 2, 1])] * jnp.array([1.0, -1.0, 1.0])
    np.testing.assert_allclose(turned.force, quarter, atol=1e-9 * scale)


@settings(deadline=None, max_examples=10)
@given(density=st.floats(0.3, 1.3), speed_scale=st.floats(0.5, 1.5))
def test_similarity(density, speed_scale):
    """At equal advance ratio and Mach number, forces go with density and the square of the speed."""
    base = solve(BLADE, stream([100.0, 5.0, 9.0]), **CRUISE)
    scaled_case = CRUISE | dict(density=density, omega=106.8 * speed_scale, sound_speed=312.0 * speed_scale)
    scaled = solve(BLADE, stream(speed_scale * np.array([100.0, 5.0, 9.0])), **scaled_case)
    factor = density / 0.55 * speed_scale**2
    np.testing.assert_allclose(scaled.force, base.force * factor, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(scaled.CP, base.CP, rtol=1e-9)


def by_parameters(x):
    """Loads by pitch, speed, incidence, sideslip, omega, radius, chord and twist."""
    blade = ro.blade_elements(RADIUS * x[5], HUB * x[5], R_TABLE, C_TABLE * x[6], TWIST_TABLE * x[7], polar=POLAR, n=NR)
    direction = jnp.stack([jnp.cos(x[2]) * jnp.cos(x[3]), jnp.sin(x[3]), jnp.sin(x[2]) * jnp.cos(x[3])])
    found = ro.solve_rotor(
        blade, jnp.broadcast_to(x[1] * direction, (NR, 4, 3)),
        **(CRUISE | dict(pitch=x[0], omega=x[4], radius=RADIUS * x[5], hub_radius=HUB * x[5])),
    )  # fmt: skip
    return jnp.concatenate([found.force / 1e3, found.moment / 1e3, found.v_axial, found.v_swirl])


CASES = {
    "cruise": [0.81, 158.0, 0.03, 0.02, 106.8, 1.0, 1.0, 1.0],
    "take-off": [0.45, 20.0, 0.2, -0.1, 110.0, 1.0, 1.0, 1.0],
    "windmill": [0.60, 158.0, 0.1, 0.05, 106.8, 1.0, 1.0, 1.0],
}
SCALE = jnp.array([1.0, 100.0, 1.0, 1.0, 100.0, 1.0, 1.0, 1.0])
first_derivatives = jax.jit(jax.jacfwd(by_parameters))
values = jax.jit(by_parameters)


def richardson(function, x, i, h):
    step = h * SCALE[i] * jnp.zeros_like(x).at[i].set(1.0)
    coarse = (function(x + 2 * step) - function(x - 2 * step)) / (4 * h)
    fine = (function(x + step) - function(x - step)) / (2 * h)
    return (4 * fine - coarse) / 3


@pytest.mark.parametrize("case", CASES)
def test_first_derivatives(case):
    x = jnp.array(CASES[case])
    exact = first_derivatives(x) * SCALE
    numeric = jnp.stack([richardson(values, x, i, 1e-5) for i in range(8)], axis=1)
    np.testing.assert_allclose(exact, numeric, atol=1e-6 * float(jnp.max(jnp.abs(exact))))


def test_second_derivatives():
    x = jnp.array(CASES["cruise"])
    exact = jax.jit(jax.jacfwd(jax.jacfwd(by_parameters)))(x) * SCALE
    numeric = jnp.stack([richardson(first_derivatives, x, i, 1e-5) for i in range(8)], axis=2)
    np.testing.assert_allclose(exact, numeric, atol=1e-5 * float(jnp.max(jnp.abs(exact))))


def test_reverse_mode_agrees():
    x = jnp.array(CASES["take-off"])
    gradient = jax.jit(jax.grad(lambda y: jnp.sum(by_parameters(y)[:6])))(x)
    np.testing.assert_allclose(gradient, jnp.sum(first_derivatives(x)[:6], axis=0), rtol=1e-8, atol=1e-10)


def test_blade_elements_follow_the_table():
    np.testing.assert_allclose(jnp.sum(BLADE.dr), RADIUS - HUB)
    inside = BLADE.r / RADIUS > 0.2
    expected = np.interp(np.asarray(BLADE.r) / RADIUS, np.asarray(R_TABLE), np.asarray(C_TABLE)) * RADIUS
    np.testing.assert_allclose(BLADE.chord[inside], expected[np.asarray(inside)], rtol=1e-12)
    slope = (TWIST_TABLE[1] - TWIST_TABLE[0]) / 0.1
    start = ro.blade_elements(RADIUS, 0.1 * RADIUS, R_TABLE, C_TABLE, TWIST_TABLE, polar=POLAR, n=9)
    np.testing.assert_allclose(start.twist[0], TWIST_TABLE[0] - 0.05 * slope, rtol=1e-12)


def test_element_points_turn_from_starboard_to_up():
    points = ro.element_points(jnp.array([2.0]), 4)
    np.testing.assert_allclose(points[0], [[0, 2, 0], [0, 0, 2], [0, -2, 0], [0, 0, -2]], atol=1e-12)


def test_sense():
    assert [ro.sense_sign("inboard-up", s) for s in (4.1, -4.1)] == [-1.0, 1.0]
    assert [ro.sense_sign("outboard-up", s) for s in (4.1, -4.1)] == [1.0, -1.0]
    with pytest.raises(ValueError, match="clockwise"):
        ro.sense_sign("clockwise", 1.0)


def test_too_few_azimuths():
    with pytest.raises(ValueError, match="2 azimuths"):
        ro.solve_rotor(BLADE, stream([10.0, 0.0, 0.0], NR, 2), **CRUISE)
