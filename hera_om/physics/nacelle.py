"""Flow of a nacelle at its own disk: it needs room, so the air meets the blades more slowly, and it pays by drag.

A slender body of revolution is a line of sources on its axis, V dA / dx by length (Ashley & Landahl, Aerodynamics of
Wings and Bodies, chapter 6). From the hub at the disk on, the nacelle grows to its full section within a length L,
as x squared: ``A(x) = A_hub + (A_nacelle - A_hub) (x / L)^2``. In the plane of the disk, with s = sqrt(L^2 + r^2),

    u / V = -(A_nacelle - A_hub) / (2 pi L^2) (ln((L + s) / r) - L / s),

of which the integral over the whole plane is half of what the nacelle displaces. Compressibility after Goethert (NACA
TM 1105): r becomes beta r, as area and velocity take 1 / beta^2 each way.

The thrust gained is paid for: the pressure that the disk raises pushes on the growing nacelle, see `nacelle_drag`.

Valid for slender bodies. The sources are those of the free stream, not of the slipstream, so that both gain and drag
are too small at heavy loading and vanish at rest. Afterbody and spinner are left out (air that a spinner ahead of the
disk pushes aside meets the blades faster), and so is what the nacelle does to surfaces and to other disks.
"""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike
from hera_om.physics.slipstream import loading

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


def nacelle_drag(
    thrust: Float[Array, " nr"],
    held: Float[Array, " nr"],
    *,
    speed: Float[Array, " nr"],
    v_axial: Float[Array, " nr"],
) -> Float[Array, ""]:
    """Drag that a nacelle has for the thrust that its slower air brings, N.

    Air that is held up by s passes a disk of thrust T at V (1 - s) + v; momentum theory has V + v for the net thrust
    T - D. The same power in both is ``D = s T V / (V + v)``, at light loading the pressure of the disk on the nacelle.

    Args:
        thrust: of the annuli, N.
        held: see `held_up`.
        speed: axial stream of the annuli without nacelle, m/s.
        v_axial: mean induced axial velocity of the annuli at the disk, m/s.
    """
    return jnp.sum(thrust * held * (1.0 - jax.vmap(loading)(v_axial, speed)))
