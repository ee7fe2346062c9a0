"""Rotor against measured propellers and against CCBlade, with section polars from tables."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from hera_om.physics import blade_polar as bp
from hera_om.physics import polar_extension as pe
from hera_om.physics import rotor as ro
from hera_om.physics.nacelle import held_up, nacelle_drag
from hera_om.physics.section_polar import SectionPolar

REFERENCE = Path(__file__).parents[1] / "reference"
SEA_LEVEL = dict(density=1.225, sound_speed=340.3, viscosity=1.79e-5)
FOOT = 0.3048
NPSI = 3


def read(name):
    """Numbers of a reference file: comment lines, then one line of names, then rows."""
    text = (REFERENCE / name).read_text().splitlines()
    rows = [line.split("(")[0].split(",") for line in text if line and not line.startswith("#")]
    return np.array([[float(value) for value in row] for row in rows[1:]])


def before_nacelle(blade, speed, hub_radius, nacelle_radius):
    """Axial flow at the blade elements, and the share of it that the nacelle holds up."""
    slow = held_up(blade.r, hub_radius=hub_radius, nacelle_radius=nacelle_radius)
    return jnp.zeros((len(blade.r), NPSI, 3)).at[..., 0].set(speed * (1.0 - slow)[:, None]), slow


def solver(nacelle_radius=0.0, net=False, **fixed):
    """Jitted CT and CP of a rotor in axial flow; ``net`` of what the nacelle pays."""

    def run(blade, speed, omega, pitch):
        velocity, slow = before_nacelle(blade, speed, fixed["hub_radius"], nacelle_radius)
        found = ro.solve_rotor(blade, velocity, pitch=pitch, omega=omega, sense=-1.0, **fixed)
        annuli = fixed["n_blades"] * jnp.mean(found.blade_thrust, axis=1) * blade.dr
        drag = nacelle_drag(annuli, slow, speed=jnp.full_like(slow, speed), v_axial=found.v_axial)
        return jnp.stack([found.CT * (1.0 - net * drag / found.thrust), found.CP])

    return jax.jit(run)


def clark_y(mach, aspect_ratio):
    """Clark Y from NeuralFoil over incidence, Reynolds and Mach number, extended to the full circle."""
    data = read("clark_y_neuralfoil.csv")
    reynolds, alpha = np.unique(data[:, 0]), np.radians(np.unique(data[:, 1]))
    cl, cd = (data[:, i].reshape(len(reynolds), len(alpha)).T for i in (2, 3))
    alpha, cl, cd = pe.full_incidence(*pe.with_mach_numbers(alpha, cl, cd, mach), aspect_ratio=aspect_ratio)
    return bp.make_blade_table(alpha, reynolds, mach, cl=cl, cd=cd)


def test_ccblade_propeller_with_its_own_table():
    """CT and CP of CCBlade within 1 % with the very table that it used, stall and full incidence included."""
    geometry, polar = read("atr_like/prop6.csv"), read("atr_like/prop_polar.csv")
    radius = 0.5 * 3.93
    table = bp.make_blade_table(
        np.radians(polar[:, 0]), [1.0], [0.0], cl=polar[:, 1, None, None], cd=polar[:, 2, None, None]
    )
    blade = ro.blade_elements(
        radius, 0.2 * radius, jnp.array(geometry[:, 0]), jnp.array(geometry[:, 1]),
        jnp.radians(geometry[:, 3] - 38.0), polar=table, n=40,
    )  # fmt: skip
    run = solver(radius=radius, hub_radius=0.2 * radius, n_blades=6.0, density=1.225, sound_speed=340.0)
    for J, CT, CP, _ in read("atr_like/bemt_propeller.csv"):
        found = run(blade, J * 20.0 * 3.93, 40.0 * np.pi, np.radians(38.0))
        np.testing.assert_allclose(found, [CT, CP], rtol=0.01)


NACA_RADIUS, NACA_NACELLE = 5.0 * FOOT, 21.5 / 12.0 * FOOT


def naca_propeller(nacelle_radius):
    """Propeller 5868-9: its blade, and CT and CP by `solver`; NACA's thrust is net of drag added by the slipstream."""
    geometry = read("prop_naca5868_9_geometry.csv")
    hub = 0.2 * NACA_RADIUS
    blade = ro.blade_elements(
        NACA_RADIUS, hub, jnp.array(geometry[:, 0] / 5.0), jnp.array(geometry[:, 1] / 5.0), jnp.radians(geometry[:, 3]),
        polar=clark_y([0.0, 0.3, 0.5], NACA_RADIUS / (0.614 * FOOT)), n=40,
    )  # fmt: skip
    return blade, solver(nacelle_radius, net=True, radius=NACA_RADIUS, hub_radius=hub, n_blades=3.0, **SEA_LEVEL)


def naca_errors(angle, first, nacelle_radius):
    """Mean absolute errors of CT and CP of propeller 5868-9 from an advance ratio on."""
    blade, run = naca_propeller(nacelle_radius)
    rows = [row for row in read(f"prop_naca5868_9_beta{angle}.csv") if row[0] >= first]
    found = np.array([run(blade, FOOT * row[5], row[4] * np.pi / 30.0, np.radians(angle)) for row in rows])
    return np.mean(np.abs(found - np.array(rows)[:, 2:4]), axis=0)


@pytest.mark.parametrize(("angle", "first", "bound_CT", "bound_CP"), [(25, 0.7, 0.006, 0.006), (35, 1.2, 0.008, 0.009)])
def test_naca_propeller(angle, first, bound_CT, bound_CP):
    """NACA Report 658, propeller 5868-9 before its nacelle, from its rated load to zero thrust.

    Clark Y of 11.7 % at all radii; the blade angle is taken as that of the line from leading to trailing edge. The
    nacelle of a liquid-cooled engine is 43 inches in diameter (NACA Report 594, not re-read). Errors of CT and CP are
    0.0051 and 0.0047 at 25 degrees, 0.0067 and 0.0082 at 35; without the nacelle's flow 0.0089, 0.0095, 0.0077, 0.0104.
    Growing over half or twice its diameter it changes them by 0.0015 at most, no hub or a spinner ahead by 0.003 (then
    0.0112 is the largest). They hold in part by luck: before the nacelle's flow was known, with each radius its own
    thickness (camber in proportion) they were 0.012, 0.014, 0.009, 0.013, and with the angle as that of the flat face
    besides, as the drawings of the time have it, 0.008, 0.011, 0.015, 0.031.
    """
    errors = naca_errors(angle, first, NACA_NACELLE)
    assert errors[0] < bound_CT
    assert errors[1] < bound_CP


def friction_drag(reynolds, thickness):
    """Least drag of a section, all turbulent: Prandtl and Schlichting's plate times Hoerner's form factor.

    Source: Hoerner, Fluid-Dynamic Drag (1965), ch. II eq. 26 and ch. VI eq. 6.
    """
    plate = 0.455 / np.log10(reynolds) ** 2.58
    return 2.0 * plate * (1.0 + 2.0 * thickness + 60.0 * thickness**4)


def test_tud_propeller():
    """TU Delft's four blades before their nacelle: slope of CT within 5 %, CP within 0.008 in the mean, largest error
    0.015.

    The section is not given. Its lift slope is thin-aerofoil theory's, its drag that of a turbulent section of 12 %
    at the Reynolds number of 75 % radius, its zero-lift angle the one that gives no thrust at the measured J. Thrust is
    the blades'; net of what the nacelle pays, the slope is 4.2 % off and the mean of CP 0.0079.
    """
    geometry, measured = read("prop_tud_4blade_geometry.csv"), read("prop_tud_4blade_isolated_Re620k.csv")
    speed, J, coefficients = measured[:, 3], measured[:, 8], measured[:, 9:11]
    radius, pitch = 0.1185, np.radians(23.9)
    at_zero = J > 0.97
    J_zero = np.polyval(np.polyfit(coefficients[at_zero, 0], J[at_zero], 1), 0.0)
    drag = friction_drag(1.36e5, 0.12)

    def blade(alpha0):
        polar = SectionPolar(2.0 * np.pi, alpha0, drag, 0.3, 0.01, 1.3, 1.0)
        twist = jnp.radians(geometry[:, 1]) - pitch
        return ro.blade_elements(
            radius, 0.0175, jnp.array(geometry[:, 0]), jnp.array(geometry[:, 2]), twist, polar=polar, n=20
        )

    run = solver(0.035, radius=radius, hub_radius=0.0175, n_blades=4.0, density=1.206, sound_speed=344.0)

    def at(alpha0, J, speed):
        return run(blade(alpha0), speed, 2.0 * np.pi * speed / (J * 2.0 * radius), pitch)

    low, high = np.radians([-3.0, 1.0])
    thrust = [at(x, J_zero, 39.2)[0] for x in (low, high)]
    for _ in range(4):  # regula falsi on what is nearly a straight line
        alpha0 = low - thrust[0] * (high - low) / (thrust[1] - thrust[0])
        low, high, thrust = high, alpha0, [thrust[1], at(alpha0, J_zero, 39.2)[0]]
    np.testing.assert_allclose(thrust[1], 0.0, atol=1e-6)
    found = np.array([at(alpha0, *row) for row in zip(J, speed, strict=True)])
    slopes = [np.polyfit(J, values[:, 0], 1)[0] for values in (found, coefficients)]
    np.testing.assert_allclose(slopes[0], slopes[1], rtol=0.05)
    error = np.abs(found[:, 1] - coefficients[:, 1])
    assert np.mean(error) < 0.008
    assert np.max(error) < 0.015


def zero_lift_angles():
    """Radii of TU Delft's sections and their angles of zero lift from the chord, deg: thin aerofoils (Glauert)."""
    table = read("tud_4blade_sections.csv")
    theta = (np.arange(4000) + 0.5) / 4000 * np.pi
    x, lines = table[:, 0], table[:, 1:] - np.outer(table[:, 0], table[-1, 1:])
    slopes = CubicSpline(x, lines)((1.0 - np.cos(theta)) / 2.0, 1)
    return np.array([0.2824, 0.3721, 0.4618, 0.6412, 0.8206]), np.degrees(
        np.mean(slopes.T * (1 - np.cos(theta)), axis=1)
    )


def test_tud_propeller_total_pressure():
    """Total pressure behind the propeller by radius over the dynamic pressure of the stream: thrust of annuli over
    their areas, and swirl. Within 0.16 from 0.5 to 0.92 of the radius with the angle of zero lift of the published
    sections by radius, with one angle for all 0.17. Without the nacelle's flow these are 0.18 and 0.20. Further in
    stands its boundary layer. Of the torque's 2 rho omega r v friction takes a part, which does not arrive as pressure.

    Angles are thin-aerofoil theory's over that at 75 %, at which the measured thrust of nothing sets the level: the
    definitions of the wind-tunnel cases have their twist from the zero-lift lines.
    """
    geometry, measured = read("prop_tud_4blade_geometry.csv"), read("prop_tud_4blade_total_pressure.csv")
    at, angles = zero_lift_angles()
    level = np.interp(0.75, at, angles)
    # the innermost section is bluff: it is held from there to the hub; the outermost to the tip
    turned = np.interp(geometry[:, 0], at, angles - level)
    radius, speed, density = 0.1185, 40.0, 1.2

    def rise(J, alpha0, twist):
        omega = 2.0 * np.pi * speed / (2.0 * radius * J)
        polar = SectionPolar(2.0 * np.pi, np.radians(alpha0), friction_drag(1.36e5, 0.12), 0.3, 0.01, 1.3, 1.0)
        r, c = jnp.array(geometry[:, 0]), jnp.array(geometry[:, 2])
        blade = ro.blade_elements(radius, 0.0175, r, c, jnp.radians(twist), polar=polar, n=20)
        stream, _ = before_nacelle(blade, speed, 0.0175, 0.035)
        how = {"radius": radius, "hub_radius": 0.0175, "n_blades": 4.0, "density": density, "sound_speed": 344.0}
        found = ro.solve_rotor(blade, stream, pitch=np.radians(23.9), omega=omega, sense=-1.0, **how)
        by_thrust = 4.0 * jnp.mean(found.blade_thrust, axis=1) / (2.0 * np.pi * blade.r)
        return blade.r / radius, by_thrust / (0.5 * density * speed**2) + (2.0 * found.v_swirl / speed) ** 2

    worst = {}
    for name, alpha0, twist in (
        ("sections", -0.50, geometry[:, 1] - 23.9 - turned),
        ("one", -0.68, geometry[:, 1] - 23.9),
    ):
        errors = []
        for column, J in enumerate((0.9957, 0.8961, 0.7962, 0.6969)):
            r, ours = rise(J, alpha0, twist)
            contracted = measured[:, 0] / 0.985  # the tube 0.15 R behind the disk
            there = np.interp(r, contracted, measured[:, 1 + column] - 1.0)
            errors.append(np.abs(ours - there)[(r > 0.5) & (r < 0.92)])
        worst[name] = np.max(errors)
    assert worst["sections"] < 0.16 < 0.17 < worst["one"]


EPEMA_RESIDUALS = {25: (-0.0249, 0.0259), 30: (-0.0271, 0.0300)}


@pytest.mark.parametrize("angle", [25, 30])
def test_epema_propeller_residuals(angle):
    """Regression guard, no claim of accuracy: mean and root mean square of CT's residual with the pitch as printed.

    The pitch of this propeller is uncertain by about 3 degrees (see the file), and its section is not given: here
    it is Clark Y. With the pitch 3 degrees larger, as the source needed it, the residuals change sign.
    """
    geometry = read("prop_epema6_geometry.csv")
    text = (REFERENCE / f"prop_epema6_beta{angle}.csv").read_text().splitlines()
    measured = np.array([[float(v) for v in line.split(",")[1:]] for line in text if line.startswith("CT,")])
    radius = 0.203
    at_70, at_75 = np.interp([0.70, 0.75], geometry[:, 0], geometry[:, 2])
    blade = ro.blade_elements(
        radius, 0.042, jnp.array(geometry[:, 0]), jnp.array(geometry[:, 1]), jnp.radians(geometry[:, 2] - at_75),
        polar=clark_y([0.0], 1.0 / 0.1526), n=20,
    )  # fmt: skip
    run = solver(radius=radius, hub_radius=0.042, n_blades=6.0, **SEA_LEVEL)
    pitch = np.radians(angle + at_75 - at_70)
    found = [run(blade, 30.0, 2.0 * np.pi * 30.0 / (J * 0.406), pitch)[0] for J in measured[:, 0]]
    residual = np.array(found) - measured[:, 1]
    summary = [np.mean(residual), np.sqrt(np.mean(residual**2))]
    np.testing.assert_allclose(summary, EPEMA_RESIDUALS[angle], atol=5e-4)
