"""A single closed box between two spars: its shape in an airfoil, section properties and shear flow.

Idealisation: covers follow the symmetric thickness form of the airfoil (camber is left out), two straight
webs, four caps, stringers smeared over the covers. Circulating shear flow and torque are positive nose-up:
up the front web, aft along the upper cover, down the rear web, forward along the lower cover.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

ScalarLike = Float[Array, ""] | float | int

# NACA four-digit thickness form, used by the five-digit sections too: Abbott & von Doenhoff, Theory of Wing
# Sections, eq. 6.2, as coefficients of sqrt(x), x, x^2, x^3, x^4 for half thickness over chord at thickness
# ratio 1.
_NACA_THICKNESS = (1.4845, -0.6300, -1.7580, 1.4215, -0.5075)
_X_THICKEST = 0.30
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)

# Z stringer: both flanges 0.4 of the web height, sheet 1/16 of it. Design choice inside the usual ranges
# (flange 0.3 to 0.5, height over sheet 12 to 25; Niu, Airframe Structural Design, on stringer panels).
Z_FLANGE = 0.4
Z_SLENDERNESS = 16.0
# A cap is a flange lying on the contour, four times as wide as thick: design choice.
CAP_ASPECT = 4.0


class BoxShape(NamedTuple):
    """Dimensions of the box at n stations, m: everything that does not depend on the sheet thickness."""

    width: Float[Array, "n"]
    h_front: Float[Array, "n"]
    h_rear: Float[Array, "n"]
    h_mean: Float[Array, "n"]
    z_square: Float[Array, "n"]
    """Mean square of the covers' half height, m2."""
    z_max: Float[Array, "n"]
    """Largest half height between the spars: the extreme fibre."""
    enclosed: Float[Array, "n"]


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
    """Properties about the horizontal axis at n stations; first moments, m3, for the shear flow."""

    area: Float[Array, "n"]
    z_centroid: Float[Array, "n"]
    inertia: Float[Array, "n"]
    torsion_constant: Float[Array, "n"]
    upper_moments: Float[Array, "3 n"]
    """Front cap, sheet with stringers, rear cap of the upper cover about the centroid."""
    lower_moments: Float[Array, "3 n"]


class ShearFlow(NamedTuple):
    """Circulating flow for unit upward shear through the shear centre, 1/m, and that centre.

    ``covers[i, j]``: upper and lower cover at the front and rear end. ``web_peak[i]``, ``web_edge[i]``:
    front and rear web at the neutral axis and at the upper cap.
    """

    covers: Float[Array, "2 2 n"]
    web_peak: Float[Array, "2 n"]
    web_edge: Float[Array, "2 n"]
    x_shear_centre: Float[Array, "n"]
    """Aft of the front spar, m."""


def half_thickness(x: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """Half thickness over (chord times thickness ratio) of the NACA thickness form at chord fraction x."""
    c0, c1, c2, c3, c4 = _NACA_THICKNESS
    return c0 * jnp.sqrt(x) + x * (c1 + x * (c2 + x * (c3 + x * c4)))


def box_shape(
    chord: Float[Array, "n"],
    thickness_ratio: Float[Array, "n"],
    *,
    front_spar: ScalarLike,
    rear_spar: ScalarLike,
) -> BoxShape:
    """Box cut out of a NACA thickness form by two spars.

    z(x) = c (t/c) f(x), Abbott & von Doenhoff eq. 6.2; means over the width by 8-point Gauss quadrature
    (1e-6).

    Args:
        chord: chord, m [n].
        thickness_ratio: thickness over chord [n].
        front_spar: chord fraction of the front web, 0.05 to rear_spar.
        rear_spar: chord fraction of the rear web, below 0.9.

    Returns:
        The shape at n stations.
    """
    scale = chord * thickness_ratio
    spars = jnp.asarray([front_spar, rear_spar])
    nodes = spars[0] + (spars[1] - spars[0]) * 0.5 * (1.0 + jnp.asarray(_NODES))
    weights = 0.5 * jnp.asarray(_WEIGHTS)
    inside = half_thickness(nodes)
    ends = half_thickness(spars)
    width = chord * (spars[1] - spars[0])
    h_mean = 2.0 * scale * jnp.sum(weights * inside)
    return BoxShape(
        width=width,
        h_front=2.0 * scale * ends[0],
        h_rear=2.0 * scale * ends[1],
        h_mean=h_mean,
        z_square=jnp.square(scale) * jnp.sum(weights * jnp.square(inside)),
        z_max=scale * half_thickness(jnp.clip(_X_THICKEST, spars[0], spars[1])),
        enclosed=width * h_mean,
    )


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


def section_properties(shape: BoxShape, members: BoxMembers, t: Float[Array, "4 n"]) -> Section:
    """Area, centroid, second moment, torsion constant and first moments by thin-wall theory.

    I = sum(A z^2) - A z_c^2 with the webs' t h^3 / 12; Bredt's J = 4 A^2 / sum(ds / t). Megson, Aircraft
    Structures, ch. 16 to 18.

    Args:
        shape: the box [n].
        members: caps and stringers [n].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Section properties. Errors: covers are taken as wide as the box (arc 1 % longer), webs as straight.
    """
    t_upper, t_lower, t_front, t_rear = t
    stringers = members.n_stringer * members.A_stringer
    depth = z_stringer(members.A_stringer).centroid
    sink = cap_depth(members.A_cap)
    z_front, z_rear, z_mean = 0.5 * shape.h_front - sink, 0.5 * shape.h_rear - sink, 0.5 * shape.h_mean
    sheet_area = shape.width * jnp.stack([t_upper, t_lower])
    sheet_first = sheet_area * z_mean + stringers * (z_mean - depth)
    sheet_second = sheet_area * shape.z_square + stringers * (shape.z_square - 2.0 * z_mean * depth + jnp.square(depth))
    webs = t_front * shape.h_front + t_rear * shape.h_rear
    web_inertia = (t_front * shape.h_front**3 + t_rear * shape.h_rear**3) / 12.0
    area = jnp.sum(sheet_area, axis=0) + 2.0 * stringers + 4.0 * members.A_cap + webs
    z_c = (sheet_first[0] - sheet_first[1]) / area
    about_chord = jnp.sum(sheet_second, axis=0) + 2.0 * members.A_cap * (z_front**2 + z_rear**2) + web_inertia
    perimeter = shape.width * (1.0 / t_upper + 1.0 / t_lower) + shape.h_front / t_front + shape.h_rear / t_rear
    upper, lower = (
        jnp.stack(
            [
                members.A_cap * (z_front - shift),
                sheet_first[i] - (sheet_area[i] + stringers) * shift,
                members.A_cap * (z_rear - shift),
            ]
        )
        for i, shift in ((0, z_c), (1, -z_c))
    )
    return Section(
        area,
        z_c,
        about_chord - area * jnp.square(z_c),
        4.0 * jnp.square(shape.enclosed) / perimeter,
        upper,
        lower,
    )


def shear_flow(shape: BoxShape, section: Section, t: Float[Array, "4 n"]) -> ShearFlow:
    """Flow in the closed box for unit upward shear through its shear centre, and where that is.

    dq = -(V / I) dS along the wall, closed by zero twist, sum(q ds / t) = 0: Megson ch. 17.3. The covers'
    vertical component is left to the webs, so the flow is scaled until the two webs carry all of V; for a
    rectangular thin-walled box that scale is 1 / I.

    Args:
        shape: the box [n].
        section: its properties at t [n].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Flows per unit shear and the shear centre.
    """
    t_upper, t_lower, t_front, t_rear = t
    up, low = section.upper_moments, section.lower_moments
    h_f, h_r, w, z_c = shape.h_front, shape.h_rear, shape.width, section.z_centroid
    total = jnp.sum(up, axis=0)
    # Everything per unit V / I, with the upward flow at the top of the front web as the one unknown q.
    web_first = -z_c * h_f * t_front  # from top to bottom of the front web, about the centroid
    web_extra_f, web_extra_r = (tw * (h**3 / 12.0 - 0.5 * h**2 * z_c) for tw, h in ((t_front, h_f), (t_rear, h_r)))
    sag_upper, sag_lower = up[0] + 0.5 * up[1], low[0] + 0.5 * low[1]
    open_twist = (
        web_extra_f / t_front
        - (total * h_r + web_extra_r) / t_rear
        - w * sag_upper / t_upper
        + w * (web_first - sag_lower) / t_lower
    )
    q = -open_twist / (h_f / t_front + h_r / t_rear + w / t_upper + w / t_lower)
    force_f, force_r = q * h_f + web_extra_f, (total - q) * h_r + web_extra_r
    mean_upper, mean_lower = q - sag_upper, q + web_first - sag_lower
    scale = 1.0 / (force_f + force_r)
    nose_up = 0.5 * shape.enclosed * (mean_upper + mean_lower) - force_r * w
    lower_front = q + web_first
    covers = jnp.stack(
        [
            jnp.stack([q - up[0], q - up[0] - up[1]]),
            jnp.stack([lower_front - low[0], lower_front - low[0] - low[1]]),
        ]
    )
    edge = jnp.stack([q, q - total])
    rise = jnp.stack([0.5 * t_front * (0.5 * h_f - z_c) ** 2, -0.5 * t_rear * (0.5 * h_r - z_c) ** 2])
    return ShearFlow(covers * scale, (edge + rise) * scale, edge * scale, -nose_up * scale)
