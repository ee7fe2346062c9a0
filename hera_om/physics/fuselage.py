"""Fuselage by slender-body theory: volume, wetted area, Munk's moment, friction drag.

The shape assumed is a nose that is a paraboloid of revolution, a cylinder, and a conical tail, all with
elliptic sections of the given width and height.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.profile_drag import turbulent_skin_friction

ScalarLike = Float[Array, ""] | float | int

NOSE_VOLUME_RATIO = 1.0 / 2.0  # paraboloid over its cylinder, closed form
TAIL_VOLUME_RATIO = 1.0 / 3.0  # cone over its cylinder, closed form
# Form factor of a body, 1 + 60 / f^3 + f / 400: Raymer, Aircraft Design (4th edition), Eq. 12.31.
FORM_FACTOR_CUBIC = 60.0
FORM_FACTOR_LINEAR = 1.0 / 400.0


class Fuselage(NamedTuple):
    """Outer dimensions in m: overall length, largest width and height, lengths of nose and tail cone."""

    length: ScalarLike
    width: ScalarLike
    height: ScalarLike
    nose_length: ScalarLike
    tail_length: ScalarLike


def fineness_ratio(body: Fuselage) -> Float[Array, ""]:
    """Length over the diameter of the circle that has the area of the largest section."""
    return body.length / jnp.sqrt(body.width * body.height)


def fuselage_volume(body: Fuselage) -> Float[Array, ""]:
    """Volume of the body.

    ``Vol = pi/4 w h (l_n / 2 + l_cylinder + l_t / 3)``.

    Source: closed forms of paraboloid, cylinder and cone.

    Args:
        body: dimensions, m.

    Returns:
        Volume, m3.

    Valid for nose and tail that together are not longer than the body.
    """
    cylinder = body.length - body.nose_length - body.tail_length
    effective = NOSE_VOLUME_RATIO * body.nose_length + cylinder + TAIL_VOLUME_RATIO * body.tail_length
    return jnp.asarray(jnp.pi / 4.0 * body.width * body.height * effective)


def fuselage_wetted_area(body: Fuselage) -> Float[Array, ""]:
    """Wetted area of the body.

    With the radius ``r`` of the circle that has the perimeter of the section (Ramanujan's
    ``r = (3 (a + b) - sqrt((3a + b)(a + 3b))) / 2`` for the half axes a, b):
    ``S = pi r / (6 l_n^2) ((r^2 + 4 l_n^2)^(3/2) - r^3) + 2 pi r l_cylinder + pi r sqrt(r^2 + l_t^2)``.

    Source: closed forms of the lateral areas; Ramanujan, Quart. J. Math. 45 (1914), for the perimeter.

    Args:
        body: dimensions, m.

    Returns:
        Wetted area, m2. The equivalent circle is exact on the cylinder and an approximation on nose and tail.

    Valid as :func:`fuselage_volume`; nothing is taken off for wing and tail roots.
    """
    a, b = body.width / 2.0, body.height / 2.0
    r = (3.0 * (a + b) - jnp.sqrt((3.0 * a + b) * (a + 3.0 * b))) / 2.0
    nose, tail = body.nose_length, body.tail_length
    paraboloid = jnp.pi * r / (6.0 * nose**2) * ((r**2 + 4.0 * nose**2) ** 1.5 - r**3)
    cylinder = 2.0 * jnp.pi * r * (body.length - nose - tail)
    return paraboloid + cylinder + jnp.pi * r * jnp.sqrt(r**2 + tail**2)


def apparent_mass_factors(fineness: ScalarLike) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Munk's k1 (along the axis) and k2 (across) of a prolate spheroid.

    With the eccentricity ``e = sqrt(1 - 1 / f^2)``:
    ``alpha0 = 2 (1 - e^2) / e^3 (atanh(e) - e)``, ``beta0 = 1 / e^2 - (1 - e^2) / e^3 atanh(e)``,
    ``k1 = alpha0 / (2 - alpha0)``, ``k2 = beta0 / (2 - beta0)``.

    Source: Lamb, Hydrodynamics (6th edition), article 114; tabulated in Lamb, ARC R&M 623 (1918), and used by
    Munk, NACA Report 184 (1924).

    Args:
        fineness: length over diameter.

    Returns:
        ``k1, k2``.

    Valid for a fineness ratio above about 1.05; a sphere (exactly 1) is the removable singularity 0.5, 0.5.
    """
    flat = 1.0 / jnp.square(fineness)
    e = jnp.sqrt(1.0 - flat)
    alpha0 = 2.0 * flat / e**3 * (jnp.arctanh(e) - e)
    beta0 = 1.0 / e**2 - flat / e**3 * jnp.arctanh(e)
    return alpha0 / (2.0 - alpha0), beta0 / (2.0 - beta0)


def fuselage_moment_slope(
    body: Fuselage, *, S: ScalarLike, length_ref: ScalarLike, munk_factor: ScalarLike
) -> Float[Array, ""]:
    """Slope of the pitching moment of the body with angle of attack (destabilising, positive).

    ``Cm_alpha = K 2 (k2 - k1) Vol / (S c)``; the force is zero (d'Alembert). The yawing moment of the same
    body is ``Cn_beta = -K 2 (k2 - k1) Vol / (S b)``: call with ``length_ref = b`` and change the sign.

    Source: Munk, NACA Report 184 (1924), section II, M = Vol q (k2 - k1) sin(2 alpha).

    Args:
        body: dimensions, m.
        S: reference area, m2.
        length_ref: reference length, m (mean chord in pitch, span in yaw).
        munk_factor: K, for the flow that wing and tail impose on the body and for separation; 1 is the bare
            body.

    Returns:
        Moment slope, 1/rad, about any point.

    Valid for small angles and a fineness ratio above about 4.
    """
    k1, k2 = apparent_mass_factors(fineness_ratio(body))
    return munk_factor * 2.0 * (k2 - k1) * fuselage_volume(body) / (S * length_ref)


def body_form_factor(fineness: ScalarLike) -> Float[Array, ""]:
    """Pressure drag of a body on top of friction: ``1 + 60 / f^3 + f / 400`` (Raymer, Eq. 12.31)."""
    return 1.0 + FORM_FACTOR_CUBIC / jnp.asarray(fineness) ** 3 + FORM_FACTOR_LINEAR * fineness


def fuselage_drag(
    body: Fuselage, *, reynolds_per_length: ScalarLike, mach: ScalarLike, S: ScalarLike
) -> Float[Array, ""]:
    """Zero-lift drag coefficient of the body: ``CD = Cf FF S_wet / S``.

    Source: component build-up, Raymer, Aircraft Design, Eqs. 12.24, 12.27 and 12.31: turbulent flat plate of
    the body's length with a form factor.

    Args:
        body: dimensions, m.
        reynolds_per_length: rho V / mu, 1/m.
        mach: Mach number.
        S: reference area, m2.

    Returns:
        Drag coefficient on ``S``.

    Valid for a smooth, wholly turbulent, subsonic body; upsweep, windshield and excrescences are drag areas.
    """
    friction = turbulent_skin_friction(reynolds_per_length * body.length, mach)
    return friction * body_form_factor(fineness_ratio(body)) * fuselage_wetted_area(body) / S
