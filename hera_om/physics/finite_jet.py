"""What a surface in a jet of finite height lifts, over what it would lift in an infinite stream as fast as the jet."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike

DOUBLINGS = 4
"""2**4 images on either side; the rest changes the factor by less than 3e-4 up to a velocity ratio of 2.5."""
SPREAD = (0.1160, -0.1022, 0.3325, -0.1057)
"""How the lift's spread over the chord widens the distance to the images, fitted to the flat plate in a plane jet
(`tests/physics/test_finite_jet.py`) to 0.0015 for half heights from 0.2 chords and velocity ratios 0.83 to 2.5."""
ROUND_JET = np.pi / 4.0
"""Half height of a plane jet over the radius of a round one with the same mean height."""


def reflection(velocity_ratio: Float[Array, "..."] | ScalarLike) -> Float[Array, "..."]:
    """Strength of a vortex's image in the edge of a jet, k = (mu^2 - 1) / (mu^2 + 1), mu = V_jet / V.

    Pressure and flow angle are the same on both sides of the edge; 0 without a jet, 1 for a jet in still air.

    Source: Glauert, The Lift and Drag of a Wing Spanning a Free Jet, ARC R&M 1603 (1934), for still air; Koning,
    in Durand, Aerodynamic Theory IV (1935), division M, for any ratio.
    """
    square = jnp.asarray(velocity_ratio) ** 2
    return (square - 1.0) / (square + 1.0)


def jet_factor(
    half_height: Float[Array, "..."] | ScalarLike, velocity_ratio: Float[Array, "..."] | ScalarLike
) -> Float[Array, "..."]:
    """Circulation of a section midway in a plane jet over that in an infinite stream of the jet's velocity.

    The edges of the jet act as images of the section at +-2 n h of strength k^n. With the lift at a quarter of the
    chord c and the flow met at three quarters,

        F = 1 / (1 + 2 sum_n k^n / (1 + (4 n H)^2)),    H^2 = (h / c)^2 + (a + a' k) (h / c) / (h / c + b + b' k),

    where the second term of H stands for the spread of lift and condition over the chord. F = 1 without a jet and
    for a high one; in a thin one F = 1 / mu^2: the section feels the outer stream alone. The normal velocity of
    stream, slipstream and swirl together, times F, is what the section answers to; the force is that of the jet's
    own velocity on its circulation.

    Source: the images as in `reflection`; the plate by the lattice of Pistolesi (quarter and three-quarter points).

    Arguments:
        half_height: h / c, above 0.2, broadcasts with the other; of a round jet of radius R, `ROUND_JET` R / c.
        velocity_ratio: mu = V_jet / V at the section, 0.83 to 2.5.

    Returns:
        F, between 1 and 1 / mu^2; analytic in both arguments.

    Validity: a section near the middle of the height, flat edges. Outside the ranges it keeps its limits.
    """
    k, h = jnp.broadcast_arrays(reflection(velocity_ratio), half_height)
    a, a_k, b, b_k = SPREAD
    square = h**2 + (a + a_k * k) * h / (h + b + b_k * k)
    n = np.arange(1, 2**DOUBLINGS + 1).reshape(-1, *[1] * k.ndim)
    total = jnp.sum(_powers(k) / (1.0 + 16.0 * n**2 * square), axis=0)
    return 1.0 / (1.0 + 2.0 * total)


def _powers(k: Float[Array, "..."]) -> Float[Array, "images ..."]:
    """k, k^2, k^3, ... by products: differentiated, `k**n` with an array n is not a number at k = 0, without a jet."""
    powers = k[None]
    for _ in range(DOUBLINGS):
        powers = jnp.concatenate([powers, powers * powers[-1]])
    return powers
