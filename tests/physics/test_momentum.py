"""Momentum balance: what rotor and wing do to the air far behind them is what the air does to them."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.rotor import azimuths, blade_elements, solve_rotor
from hera_om.physics.section_polar import SectionPolar
from hera_om.physics.slipstream import slipstream_velocity

RADIUS, HUB, SPEED, DENSITY, OMEGA = 1.5, 0.25, 90.0, 1.0, 130.0
RADIAL, HEIGHT = 40, 0.2 * RADIUS
POLAR = SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 0.0)
STATIONS = np.linspace(0.15, 1.0, 12)
ADVANCE = np.arctan(SPEED / (OMEGA * RADIUS * STATIONS))
AT_75 = np.interp(0.75, STATIONS, ADVANCE)
TABLE = (STATIONS, np.linspace(0.14, 0.08, 12), ADVANCE - AT_75)


def rotor(pitch):
    """A propeller along the stream, without losses at tip and hub: annuli of momentum theory."""
    blade = blade_elements(RADIUS, HUB, *map(jnp.asarray, TABLE), polar=POLAR, n=RADIAL)
    stream = jnp.zeros((RADIAL, len(azimuths(4)), 3)).at[..., 0].set(SPEED)
    how = {"omega": OMEGA, "radius": RADIUS, "hub_radius": HUB, "n_blades": 6.0, "density": DENSITY}
    how |= {"sound_speed": 340.0, "sense": 1.0, "tip_loss": False, "hub_loss": False}
    return blade, solve_rotor(blade, stream, pitch=pitch, **how)


def field(blade, found, points):
    """Velocity of the slipstream."""
    return slipstream_velocity(
        jnp.asarray(points),
        hub=jnp.zeros(3),
        axis=jnp.array([1.0, 0.0, 0.0]),
        radius=RADIUS,
        r=blade.r,
        v_axial=found.v_axial,
        v_swirl=found.v_swirl,
        sense=1.0,
        speed=SPEED,
        edge_width=0.01 * RADIUS,
    )


@pytest.fixture(scope="module", params=[1.0, 4.0])
def propeller(request):
    """Blades so many degrees steeper than the advance angle all along."""
    return rotor(AT_75 + np.radians(request.param))


def far_behind(blade, found, n=4000):
    """Radii, steps, axial and swirl velocity in a plane twenty radii behind the disk."""
    r = np.linspace(0, 1.2 * RADIUS, n + 1)
    r, dr = (r[1:] + r[:-1]) / 2, np.diff(r)
    points = np.stack([np.full(n, 20.0 * RADIUS), r, np.zeros(n)], axis=1)
    v = np.asarray(field(blade, found, points))
    return r, dr, v[:, 0], v[:, 2]


def test_thrust_and_torque_are_the_momentum_far_behind(propeller):
    """T = rho int (V + u) u dA - int p dA with dp/dr = rho w^2 / r, Q = rho int (V + u) w r dA (Glauert).

    Within 2 %: the tube contracts as a whole, by its mean velocity.
    """
    blade, found = propeller
    r, dr, u, w = far_behind(blade, found)
    ring = 2 * np.pi * r * dr
    pressure = -DENSITY * np.cumsum((w**2 / r * dr)[::-1])[::-1]
    thrust = np.sum((DENSITY * (SPEED + u) * u + pressure) * ring)
    torque = np.sum(DENSITY * (SPEED + u) * w * r * ring)
    # momentum theory of the annuli has no swirl in the thrust: the pressure of the swirl is what it leaves out
    assert thrust - np.sum(pressure * ring) == pytest.approx(float(found.thrust), rel=0.02)
    assert torque == pytest.approx(float(found.torque), rel=0.02)
    assert float(found.thrust) > 2000.0


def wing_wake(blade, found, x, strips=400):
    """Edges of the strips of a wing beside the propeller, elliptic circulation there, swirl at their middles."""
    eta = np.cos(np.linspace(np.pi, 0, strips + 1))
    edges = RADIUS * (2.0 + 3.0 * eta)  # from one radius on one side to five on the other
    middle = (edges[1:] + edges[:-1]) / 2
    gamma = np.sqrt(1.0 - ((middle / RADIUS - 2.0) / 3.0) ** 2)
    points = np.stack([np.full(strips, x), middle, np.full(strips, HEIGHT)], axis=1)
    return edges, gamma, np.asarray(field(blade, found, points))


def test_swirl_recovered_by_a_wing_is_the_energy_that_leaves_the_wake(propeller):
    """The wing gains rho int Gamma w dy of thrust from the upwash w of the swirl; the plane far behind loses as much.

    The kinetic energy of swirl and wing's wake together differs from the sum of both by rho int v_s . v_w dA: by
    Munk's theorem the power of that force over the speed. Within 2 %, the wing six radii behind the disk.
    """
    blade, found = propeller
    edges, gamma, near = wing_wake(blade, found, 6.0 * RADIUS)
    force = DENSITY * np.sum(gamma * near[:, 2] * np.diff(edges))
    n, reach = 300, 1.1 * RADIUS
    r, psi = ((np.arange(n) + 0.5) / n * size for size in (reach, 2 * np.pi))
    R, P = np.meshgrid(r, psi, indexing="ij")
    y, z = R * np.cos(P), R * np.sin(P)
    points = np.stack([np.full(y.size, 20.0 * RADIUS), y.ravel(), z.ravel()], axis=1)
    swirl = np.asarray(field(blade, found, points))[:, 1:].reshape(n, n, 2)
    wake = np.zeros_like(swirl)
    trailing = np.diff(gamma, prepend=0.0, append=0.0)  # along -x where the circulation grows outwards
    for place, strength in zip(edges, trailing, strict=True):
        dy, dz = y - place, z - HEIGHT
        turn = np.stack([dz, -dy], axis=-1) / (dy**2 + dz**2 + (0.005 * RADIUS) ** 2)[..., None]
        wake += strength / (2 * np.pi) * turn
    energy = DENSITY * np.sum(np.sum(swirl * wake, axis=-1) * R) * (reach / n) * (2 * np.pi / n)
    assert abs(force) > 0.2
    assert -energy == pytest.approx(force, rel=0.02)
