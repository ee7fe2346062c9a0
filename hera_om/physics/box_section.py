"""A single closed box between two spars: members, section properties and shear flow in two axes.

Idealisation (Megson, Aircraft Structures for Engineering Students, ch. 16 to 20): sheets carry direct stress along
their polygon, four caps are points at the corners, stringers are smeared over the covers, both sunk below the
contour. Flow and torque are positive nose-up: up the front web, aft along the upper cover.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.box_contour import CORNERS, INWARD, LOWER, SEGMENT_PANEL, UPPER, BoxShape

ScalarLike = Float[Array, ""] | float | int

# Z stringer: both flanges 0.4 of the web height, sheet 1/16 of it. Design choice inside the usual ranges
# (flange 0.3 to 0.5, height over sheet 12 to 25; Niu, Airframe Structural Design, on stringer panels).
Z_FLANGE = 0.4
Z_SLENDERNESS = 16.0
# A cap is a flange lying on the contour, four times as wide as thick: design choice.
CAP_ASPECT = 4.0
_CAP_INWARD = np.array([1.0, -1.0, -1.0, 1.0])[:, None]  # along z, at `CORNERS`


class BoxMembers(NamedTuple):
    """Given members at n stations: area of one cap and of one stringer, m2, and stringers per cover."""

    A_cap: Float[Array, "n"]
    A_stringer: Float[Array, "n"]
    n_stringer: Float[Array, "n"]


class StringerSection(NamedTuple):
    """A Z stringer by its area: web height and centroid above the skin, m; r^2, m2; A / t^2."""

    height: Float[Array, "n"]
    centroid: Float[Array, "n"]
    gyration_square: Float[Array, "n"]
    area_over_t2: float


class Section(NamedTuple):
    """Properties at n stations; second moments about the centroid."""

    area: Float[Array, "n"]
    x_centroid: Float[Array, "n"]
    z_centroid: Float[Array, "n"]
    I_xx: Float[Array, "n"]
    """Integral of z^2: bending of the tip upwards."""
    I_zz: Float[Array, "n"]
    """Integral of x^2: bending of the tip forwards."""
    I_xz: Float[Array, "n"]
    """Integral of x z."""
    torsion_constant: Float[Array, "n"]
    sheet_moments: Float[Array, "2 k n"]
    """First moments, x and z, of each segment with its stringers, m3."""
    cap_moments: Float[Array, "2 k n"]
    """First moments of the cap at the first node of each segment, zero elsewhere, m3."""
    stringer_moments: Float[Array, "2 k n"]
    """Half the first moment of the sinking of the stringers of each segment, m3; x has none."""
    segment_area: Float[Array, "k n"]
    """Sheet and stringers of each segment."""


class ShearFlow(NamedTuple):
    """Flow along the loop for a unit force aft and a unit force up through the shear centre, and that centre.

    ``start[j]``, ``end[j]``: at the ends of each segment, 1/m; j = 0 aft, 1 up.
    """

    start: Float[Array, "2 k n"]
    middle: Float[Array, "2 k n"]
    end: Float[Array, "2 k n"]
    x_shear_centre: Float[Array, "n"]
    """Aft of the leading edge, m."""
    z_shear_centre: Float[Array, "n"]
    """Above the chord line, m."""


def box_members(
    shape: BoxShape,
    chord: Float[Array, "n"],
    *,
    A_cap_root: ScalarLike,
    A_stringer_root: ScalarLike,
    pitch: ScalarLike,
) -> BoxMembers:
    """Caps and stringers: areas scale with box height times chord, one at the first station.

    Stringers per cover are width / pitch - 1 (the caps close the outer panels), a continuous number.

    Args:
        shape: the box [n].
        chord: chord, m [n].
        A_cap_root: area of one cap at the first station, m2.
        A_stringer_root: area of one stringer there, m2.
        pitch: stringer pitch, m; below the width of the box.

    Returns:
        The members at n stations.
    """
    size = shape.h_mean * chord
    law = size / size[0]
    return BoxMembers(A_cap_root * law, A_stringer_root * law, jnp.maximum(shape.width / pitch - 1.0, 0.0))


def z_stringer(area: Float[Array, "n"]) -> StringerSection:
    """Z stringer of given area, thin-walled: A = (1 + 2 f) h t, t = h / s, I = h^3 t (1/12 + f/2)."""
    f, s = Z_FLANGE, Z_SLENDERNESS
    height = jnp.sqrt(area * s / (1.0 + 2.0 * f))
    gyration_square = jnp.square(height) * (1.0 / 12.0 + 0.5 * f) / (1.0 + 2.0 * f)
    return StringerSection(height, 0.5 * height, gyration_square, s * (1.0 + 2.0 * f))


def cap_depth(area: Float[Array, "n"]) -> Float[Array, "n"]:
    """Depth of a cap's centroid below the contour, half its thickness, m."""
    return 0.5 * jnp.sqrt(area / CAP_ASPECT)


def _next(values: Float[Array, "k n"]) -> Float[Array, "k n"]:
    """Values at the second nodes of the segments."""
    return jnp.roll(values, -1, axis=0)


def _smeared(shape: BoxShape, members: BoxMembers) -> Float[Array, "k n"]:
    """Area of the stringers of each segment."""
    density = members.n_stringer * members.A_stringer / shape.arc
    return shape.length * jnp.zeros_like(shape.length).at[UPPER].set(density[0]).at[LOWER].set(density[1])


def section_properties(shape: BoxShape, members: BoxMembers, t: Float[Array, "4 n"]) -> Section:
    """Area, centroid, second moments in two axes, torsion constant and first moments by thin-wall theory.

    Sheet of area A between two nodes: int z^2 dA = A (z1^2 + z1 z2 + z2^2) / 3 and alike; Bredt's
    J = 4 A^2 / sum(ds / t). Megson, ch. 16.4 and 18.1.

    Args:
        shape: the box [n].
        members: caps and stringers [n].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Section properties.
    """
    sheets = t[SEGMENT_PANEL] * shape.length
    stringers, sink = _smeared(shape, members), INWARD[:, None] * z_stringer(members.A_stringer).centroid
    caps = members.A_cap
    cap_x, cap_z = shape.x[CORNERS], shape.z[CORNERS] + _CAP_INWARD * cap_depth(caps)
    total = sheets + stringers
    area = jnp.sum(total, axis=0) + 4.0 * caps
    middle_x, middle_z = 0.5 * (shape.x + _next(shape.x)), 0.5 * (shape.z + _next(shape.z))
    x_c = (jnp.sum(total * middle_x, axis=0) + caps * jnp.sum(cap_x, axis=0)) / area
    z_c = (jnp.sum(total * middle_z + stringers * sink, axis=0) + caps * jnp.sum(cap_z, axis=0)) / area
    x1, z1 = shape.x - x_c, shape.z - z_c
    x2, z2 = _next(x1), _next(z1)
    cap_x, cap_z = cap_x - x_c, cap_z - z_c

    def second(a1, a2, b1, b2, cap, sunk):
        sheet = total * (2.0 * (a1 * b1 + a2 * b2) + a1 * b2 + a2 * b1) / 6.0
        return jnp.sum(sheet + stringers * sunk, axis=0) + caps * jnp.sum(cap, axis=0)

    corner = jnp.zeros((2, *shape.x.shape)).at[:, CORNERS].set(caps * jnp.stack([cap_x, cap_z]))
    sinking = 0.5 * jnp.stack([jnp.zeros_like(sink), stringers * sink])
    return Section(
        area=area,
        x_centroid=x_c,
        z_centroid=z_c,
        I_xx=second(z1, z2, z1, z2, cap_z**2, sink * (z1 + z2) + sink**2),
        I_zz=second(x1, x2, x1, x2, cap_x**2, jnp.zeros_like(sink)),
        I_xz=second(x1, x2, z1, z2, cap_x * cap_z, 0.5 * sink * (x1 + x2)),
        torsion_constant=4.0 * jnp.square(shape.enclosed) / jnp.sum(shape.length / t[SEGMENT_PANEL], axis=0),
        sheet_moments=total * 0.5 * jnp.stack([x1 + x2, z1 + z2]) + 2.0 * sinking,
        cap_moments=corner,
        stringer_moments=sinking,
        segment_area=total,
    )


def shear_flow(shape: BoxShape, section: Section, t: Float[Array, "4 n"]) -> ShearFlow:
    """Flow in the closed box for unit forces through its shear centre, and where that is.

    dq = -(b x + c z) dA along the wall, closed by zero twist, sum(q ds / t) = 0: Megson, ch. 17.3, b and c from the
    second moments. Caps and stringers are sunk below the wall, and shed their flow over their depth: the flow
    of the webs between them is as here, over the whole wall it sums to somewhat more than the force. The
    shear centre is the line of action of its resultant.

    Args:
        shape: the box [n].
        section: its properties at t [n].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Flows per unit force and the shear centre.
    """
    moments, caps = section.sheet_moments, section.cap_moments
    start = -(jnp.cumsum(moments + caps, axis=1) - moments)
    end = start - moments
    node = jnp.stack([shape.x - section.x_centroid, shape.z - section.z_centroid])
    ahead = jnp.roll(node, -1, axis=1)
    area = section.segment_area
    # Flow lost on the way to half the segment, and on average over it.
    middle = start - area * (3.0 * node + ahead) / 8.0 - section.stringer_moments
    mean = start - area * (2.0 * node + ahead) / 6.0 - section.stringer_moments
    give = shape.length / t[SEGMENT_PANEL]
    closing = -jnp.sum(mean * give, axis=1, keepdims=True) / jnp.sum(give, axis=0)
    step_x, step_z = _next(shape.x) - shape.x, _next(shape.z) - shape.z
    xx, xz, zz = section.I_zz, section.I_xz, section.I_xx
    mix = jnp.stack([jnp.stack([zz, -xz]), jnp.stack([-xz, xx])]) / (xx * zz - xz * xz)  # [force, gradient, n]

    def combined(flow: Float[Array, "2 k n"]) -> Float[Array, "2 k n"]:
        return jnp.einsum("fgn,gkn->fkn", mix, flow + closing)

    whole = combined(mean)
    nose_up = jnp.sum(whole * (shape.z * step_x - shape.x * step_z), axis=1)
    aft, up = jnp.sum(whole[0] * step_x, axis=0), jnp.sum(whole[1] * step_z, axis=0)
    return ShearFlow(combined(start), combined(middle), combined(end), -nose_up[1] / up, nose_up[0] / aft)
