"""Turbulent skin friction and the profile drag of wing and tail strips."""

import jax.numpy as jnp
from jaxtyping import Array, Float

ArrayLike = Float[Array, "..."] | float | int

# Prandtl-Schlichting law with a factor for compressibility: Raymer, Aircraft Design, Eq. 12.27.
FRICTION_COEFFICIENT = 0.455
FRICTION_EXPONENT = 2.58
FRICTION_MACH_COEFFICIENT = 0.144
FRICTION_MACH_EXPONENT = 0.65


def turbulent_skin_friction(reynolds: ArrayLike, mach: ArrayLike = 0.0) -> Float[Array, "..."]:
    """Mean friction coefficient of a smooth, wholly turbulent flat plate, on one wetted side.

    ``Cf = 0.455 / (log10(Re)^2.58 (1 + 0.144 M^2)^0.65)``.

    Source: Schlichting, Boundary-Layer Theory, Prandtl-Schlichting formula; with Mach, Raymer, Aircraft
    Design: A Conceptual Approach, Eq. 12.27.

    Args:
        reynolds: Reynolds number on the length of the plate, any shape.
        mach: Mach number, a shape that broadcasts with it.

    Returns:
        Friction coefficient of the common shape.

    Valid for Reynolds numbers of 5e5 to 1e9 and Mach numbers to about 3; below Re = 10 it has no meaning.
    """
    compressible = (1.0 + FRICTION_MACH_COEFFICIENT * jnp.square(mach)) ** FRICTION_MACH_EXPONENT
    return FRICTION_COEFFICIENT / (jnp.log10(reynolds) ** FRICTION_EXPONENT * compressible)


def reynolds_factor(reynolds: ArrayLike, re_ref: ArrayLike) -> Float[Array, "..."]:
    """Ratio by which minimum drag changes from one Reynolds number to another, as turbulent friction does."""
    return turbulent_skin_friction(reynolds) / turbulent_skin_friction(re_ref)


def section_profile_drag(
    cl: ArrayLike,
    reynolds: ArrayLike,
    *,
    cd_min: ArrayLike,
    cl_at_cd_min: ArrayLike,
    k: ArrayLike,
    re_ref: ArrayLike,
) -> Float[Array, "..."]:
    """Profile drag coefficient of a section from a parabolic polar.

    ``cd = cd_min Cf(Re) / Cf(Re_ref) + k (cl - cl_at_cd_min)^2``. Only the minimum drag, which is friction,
    follows the Reynolds number.

    Source: parabola as fitted to the polars of Abbott and von Doenhoff, Theory of Wing Sections, appendix IV;
    scaling by the Prandtl-Schlichting law of :func:`turbulent_skin_friction`.

    Args:
        cl: section lift coefficient, any shape.
        reynolds: Reynolds number on the chord; this and the polar's numbers broadcast with ``cl``.
        cd_min: minimum drag coefficient at ``re_ref``.
        cl_at_cd_min: lift coefficient at which the drag is least.
        k: curvature of the polar.
        re_ref: Reynolds number of the polar.

    Returns:
        Drag coefficient on the chord, of the common shape.

    Valid below stall (|cl| to about 0.8 cl_max) and for Reynolds numbers of 5e5 to 1e9: stall is not
    modelled.
    """
    return cd_min * reynolds_factor(reynolds, re_ref) + k * (cl - cl_at_cd_min) ** 2
