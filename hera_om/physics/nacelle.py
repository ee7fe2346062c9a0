"""Flow of a nacelle at its own disk: it needs room, so the air meets the blades more slowly, and it pays by drag.

A slender body of revolution is a line of sources on its axis, V dA / dx by length (Ashley & Landahl, Aerodynamics of
Wings and Bodies, section 6.3). From the hub at the disk on, the nacelle grows to its full section within a length L,
as x squared: ``A(x) = A_hub + (A_nacelle - A_hub) (x / L)^2``. In the plane of the disk, with s = sqrt(L^2 + r^2),

    u / V = -(A_nacelle - A_hub) / (2 pi L^2) (ln((L + s) / r) - L / s),

of which the integral over the whole plane is half of what the nacelle displaces. Compressibility after Goethert.

The thrust gained is paid for: the pressure that the disk raises pushes on the growing nacelle. To first order that
drag is the thrust of every annulus times the share of its air that the nacelle holds up: the same integral.

Valid for slender bodies and light loading, outside the nacelle's radius; its afterbody and a spinner ahead are left
out, and so is what it does to surfaces and to other disks.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike

NACELLE = 1.0
"""Share of the flow that the nacelle holds up; 0 switches it off."""
LENGTH = 1.0
"""Length of the growing part over the nacelle's diameter (choice)."""


def held_up(
    r: Float[Array, " nr"], *, hub_radius: ScalarLike, nacelle_radius: ScalarLike, beta: ScalarLike = 1.0
) -> Float[Array, " nr"]:
    """Share of the axial stream that the nacelle takes away at radii of the disk.

    Args:
        r: radii, m, at least those of the hub.
        hub_radius: m.
        nacelle_radius: m; a nacelle no wider than the hub does nothing.
        beta: sqrt(1 - M^2).
    """
    wider = jnp.asarray(nacelle_radius) > hub_radius
    length = jnp.where(wider, LENGTH * 2.0 * nacelle_radius, 1.0)
    area = jnp.where(wider, jnp.pi * (nacelle_radius**2 - hub_radius**2), 0.0)
    across = beta * r
    s = jnp.sqrt(length**2 + across**2)
    shape = jnp.log((length + s) / across) - length / s
    return NACELLE * area / (2.0 * jnp.pi * length**2) * shape
