"""Total mass, centre of gravity and inertia tensor of a list of mass items."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

# Rotation from geometry axes (x aft, y starboard, z up) to body axes (x forward, y starboard, z down).
BODY_FROM_GEOMETRY = (-1.0, 1.0, -1.0)


class MassProperties(NamedTuple):
    """Mass in kg, centre of gravity in geometry axes in m, inertia about it in body axes in kg m2.

    ``I_xz`` is the PRODUCT of inertia, the sum of m x z in body axes; the tensor holds its negative off the
    diagonal. Mass high at the tail (both body coordinates negative) makes it positive.
    """

    mass: Float[Array, ""]
    cg: Float[Array, "3"]
    inertia: Float[Array, "3 3"]
    I_xx: Float[Array, ""]
    I_yy: Float[Array, ""]
    I_zz: Float[Array, ""]
    I_xz: Float[Array, ""]


def mass_properties(
    mass: Float[Array, " k"], position: Float[Array, "k 3"], gyration: Float[Array, "k 2"]
) -> MassProperties:
    """Assemble items into the mass properties of the whole.

    Each item is a distribution with radii of gyration ``kx`` along x and ``ky`` along y about its own centre
    and none along z, so that its own second moments are ``m kx^2``, ``m ky^2``, 0. With the second-moment
    matrix ``P = sum m (diag(kx^2, ky^2, 0) + d d^T)``, d from the common centre of gravity, the inertia is
    ``I = trace(P) 1 - P``: an item adds ``m ky^2`` to Ixx, ``m kx^2`` to Iyy, ``m (kx^2 + ky^2)`` to Izz.

    Source: parallel-axis theorem, e.g. Goldstein, Classical Mechanics, section 5.3.

    Args:
        mass: masses of the items, kg.
        position: their centres in geometry axes (x aft, y starboard, z up), m. A symmetric pair may be one
            item with y = 0 and its offset in ``ky``.
        gyration: radii of gyration along x and y, m.

    Returns:
        Totals; inertia in body axes x forward, y starboard, z down, about the centre of gravity.

    Valid for any item with positive mass; a total mass of zero gives NaN.
    """
    total = jnp.sum(mass)
    cg = mass @ position / total
    offset = (position - cg) * jnp.asarray(BODY_FROM_GEOMETRY)
    own = mass @ gyration**2
    second = jnp.einsum("k,ki,kj->ij", mass, offset, offset) + jnp.diag(jnp.append(own, 0.0))
    inertia = jnp.trace(second) * jnp.eye(3) - second
    return MassProperties(
        mass=total,
        cg=cg,
        inertia=inertia,
        I_xx=inertia[0, 0],
        I_yy=inertia[1, 1],
        I_zz=inertia[2, 2],
        I_xz=-inertia[0, 2],
    )


def pair_gyration(y: Float[Array, " n"]) -> Float[Array, ""]:
    """Radius of gyration along y of equal point masses at +-y: ``ky = sqrt(mean(y^2))``.

    Source: definition of the radius of gyration.

    Args:
        y: distance of each mass of one side from the plane of symmetry, m.

    Returns:
        ``ky`` of the item that stands for all the pairs, m.

    Valid for at least one y that is not zero (the derivative at all zero is not finite).
    """
    return jnp.sqrt(jnp.mean(y**2))
