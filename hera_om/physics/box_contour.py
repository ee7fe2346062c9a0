"""The closed box that two spars cut out of an airfoil: a polygon whose corners lie on the contour.

Section axes: x aft of the leading edge, z up from the chord line, both along the chord. Incidence turns the loads
instead, `wingbox_types.on_sections`.
The loop runs up the front web, aft along the upper cover, down the rear web, forward along the lower cover.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.core.contours import contour_table

ScalarLike = Float[Array, ""] | float | int

# Chords of a cover: heights of NACA sections between 0.15 and 0.62 are 0.1 % low, second moments 0.2 %.
COVER_SEGMENTS = 12
_C = COVER_SEGMENTS
# Panel of each segment of the loop, in the order of `wingbox_types.PANELS`.
SEGMENT_PANEL = np.array([2] + [0] * _C + [3] + [1] * _C)
UPPER, LOWER = slice(1, _C + 1), slice(_C + 2, 2 * _C + 2)  # segments of the covers
# First nodes of the segments at the corners: front bottom, front top, rear top, rear bottom.
CORNERS = np.array([0, 1, _C + 1, _C + 2])
# Four points of each panel in the order of `wingbox_types.PANELS`: nodes of the covers, the segments of the webs.
_STEP = _C // 3
COVER_POINTS = np.array([np.arange(4) * _STEP + 1, (np.arange(4) * _STEP + _C + 2) % (2 * _C + 2)])
WEBS = np.array([0, _C + 1])
# Towards the inside of the box along z, by segment; webs have no inside here.
INWARD = np.array([0.0] + [-1.0] * _C + [0.0] + [1.0] * _C)


class BoxShape(NamedTuple):
    """Dimensions of the box at n stations, m: everything that does not depend on the sheet thickness."""

    x: Float[Array, "k n"]
    """Nodes of the loop; segment i runs from node i to the next."""
    z: Float[Array, "k n"]
    length: Float[Array, "k n"]
    arc: Float[Array, "2 n"]
    """Length of the upper and of the lower cover."""
    width: Float[Array, "n"]
    h_front: Float[Array, "n"]
    h_rear: Float[Array, "n"]
    h_mean: Float[Array, "n"]
    enclosed: Float[Array, "n"]


def naca_tables(n: int) -> Float[Array, "n 4 p"]:
    """Tables of the symmetric NACA thickness form at n stations."""
    return jnp.broadcast_to(jnp.asarray(contour_table("flat")), (n, *contour_table("flat").shape))


def contour_at(tables: Float[Array, "n 4 p"], x: Float[Array, "m"]) -> tuple[Float[Array, "m n"], Float[Array, "m n"]]:
    """Mean line over chord and half thickness per unit thickness ratio at chord fractions, by cubic Hermite.

    Args:
        tables: one `core.contours.contour_table` a station [n, 4, p].
        x: chord fractions inside (0, 1) [m].
    """
    steps = tables.shape[-1] - 1
    place = jnp.arccos(1.0 - 2.0 * x) / jnp.pi * steps
    cell = jnp.clip(jnp.floor(place).astype(int), 0, steps - 1)
    s, h = place - cell, jnp.pi / steps
    weights = jnp.stack([(1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2, s**2 * (3 - 2 * s), h * s**2 * (s - 1)])

    def line(value: int) -> Float[Array, "m n"]:
        ends = jnp.stack([tables[:, value + rate, cell + end] for end in (0, 1) for rate in (0, 1)])
        return jnp.einsum("wm,wnm->mn", weights, ends)

    return line(0), line(2)


def box_shape(
    chord: Float[Array, "n"],
    thickness_ratio: Float[Array, "n"],
    *,
    front_spar: ScalarLike,
    rear_spar: ScalarLike,
    tables: Float[Array, "n 4 p"] | None = None,
) -> BoxShape:
    """Box cut out of a contour by two upright spars.

    z = c (mean(x) +- (t/c) half(x)), thickness laid along z. Enclosed area by the trapezoidal rule on the polygon.

    Args:
        chord: chord, m [n].
        thickness_ratio: thickness over chord [n].
        front_spar: chord fraction of the front web, 0.03 to rear_spar.
        rear_spar: chord fraction of the rear web, below 0.95.
        tables: contours of the stations [n, 4, p]; absent: the symmetric NACA form.

    Returns:
        The shape at n stations. Errors: the polygon is inscribed, its height 0.1 % low (NACA forms).
    """
    tables = naca_tables(chord.shape[0]) if tables is None else tables
    fraction = front_spar + (rear_spar - front_spar) * jnp.linspace(0.0, 1.0, COVER_SEGMENTS + 1)
    mean, half = contour_at(tables, fraction)
    upper, lower = chord * (mean + thickness_ratio * half), chord * (mean - thickness_ratio * half)
    along = fraction[:, None] * chord
    x = jnp.concatenate([along[:1], along, along[:0:-1]])
    z = jnp.concatenate([lower[:1], upper, lower[:0:-1]])
    length = jnp.hypot(jnp.roll(x, -1, axis=0) - x, jnp.roll(z, -1, axis=0) - z)
    height = upper - lower
    width = chord * (rear_spar - front_spar)
    h_mean = jnp.mean(0.5 * (height[1:] + height[:-1]), axis=0)
    arc = jnp.stack([jnp.sum(length[UPPER], axis=0), jnp.sum(length[LOWER], axis=0)])
    return BoxShape(x, z, length, arc, width, height[0], height[-1], h_mean, width * h_mean)
