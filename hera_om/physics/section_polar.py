"""Lift and drag of a blade section at any incidence, from seven numbers a station."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

ScalarLike = Float[Array, ""] | float | int
StationLike = Float[Array, " nr"] | ScalarLike

FLAT_PLATE_CN = 1.98
"""Normal-force coefficient of a plate square to the flow (Hoerner, Fluid-Dynamic Drag, 1965, ch. III)."""
LINEAR_LIFT_FRACTION = 0.8
"""The lift law is exactly linear below this fraction of cl_max (choice)."""
STALL_START, STALL_END = 1.0, 2.0
"""The flow changes from attached to flat plate while the linear law runs over this range of cl / cl_max
(choice: with cl_max 1.4 and slope 6 it is 13 to 27 degrees above zero lift)."""
MACH_CAP = 0.85
"""Ceiling of the Mach number in Prandtl-Glauert's factor (choice: the rule fails near Mach 1)."""
MACH_LINEAR_FRACTION = 0.8
"""The factor is exact below this fraction of the ceiling, Mach 0.68."""


class SectionPolar(NamedTuple):
    """Polar of each blade station; every field is a number or an array over the stations."""

    cl_alpha: StationLike
    """Incompressible lift-curve slope, 1/rad."""
    alpha0: StationLike
    """Zero-lift incidence, rad."""
    cd_min: StationLike
    """Least drag coefficient."""
    cl_cd_min: StationLike
    """Lift coefficient of least drag."""
    k: StationLike
    """Curvature of the drag polar: cd = cd_min + k (cl - cl_cd_min)^2."""
    cl_max: StationLike
    """Lift coefficient at which the lift saturates, of both signs; a very large one gives a linear
    section."""
    compressible: StationLike = 1.0
    """1.0: Prandtl-Glauert by the local Mach number; 0.0: none."""


def smoothstep(t: Float[Array, "..."]) -> Float[Array, "..."]:
    """Quintic step from 0 at t <= 0 to 1 at t >= 1, twice continuously differentiable."""
    t = jnp.clip(t, 0.0, 1.0)
    return t * t * t * (10.0 + t * (6.0 * t - 15.0))


def soft_clip(x: Float[Array, "..."], linear: ScalarLike) -> Float[Array, "..."]:
    """Odd, three times differentiable limiter to +-1 that equals ``x`` exactly for ``|x| <= linear``.

    Its slope is 1 minus the quintic step over ``linear <= |x| <= 2 - linear``.
    """
    width = 2.0 * (1.0 - linear)
    t = jnp.clip((jnp.abs(x) - linear) / width, 0.0, 1.0)
    knee = linear + width * (t - t**4 * (2.5 + t * (t - 3.0)))
    return jnp.where(jnp.abs(x) <= linear, x, jnp.sign(x) * knee)


def prandtl_glauert(mach: Float[Array, "..."]) -> Float[Array, "..."]:
    """Slope factor 1 / sqrt(1 - M^2), M saturating smoothly at ``MACH_CAP``."""
    limited = MACH_CAP * soft_clip(mach / MACH_CAP, MACH_LINEAR_FRACTION)
    return 1.0 / jnp.sqrt(1.0 - limited**2)


def section_coefficients(
    polar: SectionPolar, alpha: Float[Array, "..."], mach: Float[Array, "..."]
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    """Lift and drag coefficients of blade sections at any incidence.

    Attached: ``cl = cl_alpha (alpha - alpha0) / sqrt(1 - M^2)``, rounded off towards ``+-cl_max`` above 0.8
        of it, and
    ``cd = cd_min + k (cl - cl_cd_min)^2``. Separated: the flat plate, ``cl = C_N sin(alpha) cos(alpha)`` and
    ``cd = cd_min + C_N sin^2(alpha)``, with C_N of a plate square to the flow. A quintic step joins them
    while the linear law runs from ``cl_max`` to twice that.

    Source: Prandtl-Glauert and the parabolic polar as in any text; the join to the flat plate follows the
        idea of
    Viterna and Corrigan, NASA CP-2230 (1982), without their aspect-ratio term.

    Arguments:
        polar: the polar, numbers or arrays that broadcast with ``alpha``.
        alpha: incidence of the chord, rad, in (-2 pi, 2 pi).
        mach: Mach number of the section, same shape or broadcast.

    Returns:
        cl, cd, of the common shape.

    Validity: linear exactly while ``|cl| <= 0.8 cl_max``; Mach up to 0.68 (beyond it Prandtl-Glauert is
        held back and
    ends at 1.90). There is no drag rise with Mach number, no Reynolds number and no stall delay by rotation.
    """
    factor = 1.0 + polar.compressible * (prandtl_glauert(mach) - 1.0)
    loading = polar.cl_alpha * factor * (alpha - polar.alpha0) / polar.cl_max
    cl_attached = polar.cl_max * soft_clip(loading, LINEAR_LIFT_FRACTION)
    cd_attached = polar.cd_min + polar.k * (cl_attached - polar.cl_cd_min) ** 2
    sine, cosine = jnp.sin(alpha), jnp.cos(alpha)
    separated = smoothstep((jnp.abs(loading) - STALL_START) / (STALL_END - STALL_START))
    cl = cl_attached + separated * (FLAT_PLATE_CN * sine * cosine - cl_attached)
    cd = cd_attached + separated * (polar.cd_min + FLAT_PLATE_CN * sine**2 - cd_attached)
    return cl, cd
