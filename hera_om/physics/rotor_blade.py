"""Blades as elements, the points of a disk, and the sense of rotation."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.blade_polar import Polar, at_elements
from hera_om.physics.section_polar import ScalarLike

SENSES = {"inboard-up": -1.0, "outboard-up": 1.0}


class Blade(NamedTuple):
    """One blade as elements; station values and integration weights."""

    r: Float[Array, " nr"]
    """Radius of each element, m."""
    dr: Float[Array, " nr"]
    """Integration weight of each element, m."""
    chord: Float[Array, " nr"]
    """Chord, m."""
    twist: Float[Array, " nr"]
    """Blade angle relative to that at 75 % radius, rad."""
    polar: Polar


def sense_sign(name: str, side: float) -> float:
    """Sign of a rotor's angular velocity about the x axis, aft; +1 is anticlockwise seen from behind.

    Inboard-up, the blade on the fuselage side moves up: -1 on the starboard wing, +1 on the port wing.

    Arguments:
        name: "inboard-up" or "outboard-up".
        side: y of the hub or its sign, positive to starboard; a rotor on the centre line counts as starboard.

    Raises:
        ValueError: for another name.
    """
    if name not in SENSES:
        raise ValueError(f"rotor sense {name!r}: expected one of {sorted(SENSES)}")
    return SENSES[name] if side >= 0.0 else -SENSES[name]


def azimuths(npsi: int) -> Float[Array, " npsi"]:
    """Azimuth angles psi_j = 2 pi j / npsi, rad, from +y (starboard) towards +z (up)."""
    return 2.0 * jnp.pi * jnp.arange(npsi) / npsi


def element_points(r: Float[Array, " nr"], npsi: int) -> Float[Array, "nr npsi 3"]:
    """Positions of the elements relative to the hub in shaft axes, m: where ``velocity`` is wanted."""
    psi = azimuths(npsi)
    radial = jnp.stack([jnp.zeros_like(psi), jnp.cos(psi), jnp.sin(psi)], axis=-1)
    return r[:, None, None] * radial[None]


def blade_elements(
    radius: ScalarLike,
    hub_radius: ScalarLike,
    r_table: Float[Array, " nt"],
    c_table: Float[Array, " nt"],
    twist_table: Float[Array, " nt"],
    *,
    polar: Polar,
    n: int,
) -> Blade:
    """Blade of ``n`` equal elements at their mid-points from a table of geometry.

    Piecewise linear in the table and continued linearly beyond its ends, so linear in the table's values.

    Arguments:
        radius: tip radius, m.
        hub_radius: m.
        r_table: radii over ``radius``, ascending.
        c_table: chord over ``radius``.
        twist_table: blade angle relative to that at 75 % radius, rad.
        polar: seven numbers, each a number or an array over the ``n`` elements, or a table.
        n: number of elements.
    """
    hub = hub_radius / radius
    x = hub + (1.0 - hub) * (jnp.arange(n) + 0.5) / n
    i = jnp.clip(jnp.searchsorted(r_table, x) - 1, 0, r_table.shape[0] - 2)
    t = (x - r_table[i]) / (r_table[i + 1] - r_table[i])
    chord = radius * (c_table[i] + t * (c_table[i + 1] - c_table[i]))
    twist = twist_table[i] + t * (twist_table[i + 1] - twist_table[i])
    return Blade(radius * x, jnp.full(n, (radius - hub_radius) / n), chord, twist, at_elements(polar, x))
