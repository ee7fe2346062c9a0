"""Velocity of vortex filaments, written so that only a scalar kernel is pairwise.

The velocity that a straight filament from a to b of unit circulation induces at p is (Katz & Plotkin,
Low-Speed Aerodynamics 2e, eq. 10.115)

    V = K (r1 x r2),   K = (1/r1 + 1/r2) / (4 pi (r1 r2 + r1 . r2)),   r1 = p - a,  r2 = p - b,

and r1 x r2 = p x (a - b) + a x b is linear in p: sums over filaments become matrix products. Keep the origin
near the points, the split cancels for large coordinates. A filament from a to infinity along +x has
K = 1 / (4 pi r (r - r_x)) with r1 x r2 replaced by p x (-e_x) + a x e_x.

Compressibility (Prandtl-Glauert) stretches x by 1/beta before the kernel and divides the x velocity by beta.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

FOUR_PI = 4 * jnp.pi
# A point closer to the line of a filament than this angle (squared, rad^2) is on it: no self velocity.
ON_FILAMENT = 1e-8
# A point closer to an end of a filament than this part of its length is on it too, whatever rounding says.
AT_END = 1e-10
# Core of the wake filaments (m): keeps a point that a filament passes through finite.
WAKE_CORE = 1e-4


class Filaments(NamedTuple):
    """The filaments of one surface's ring nodes: bound lines, chordwise lines, wake lines."""

    bound: Float[Array, "p nc ns"]
    chordwise: Float[Array, "p nc ns1"]
    wake: Float[Array, "p ns1"]


class Arms(NamedTuple):
    """``d`` and ``c`` of V = K (p x d + c) for each filament, last axis [d, c]."""

    bound: Float[Array, "nc ns 6"]
    chordwise: Float[Array, "nc ns1 6"]
    wake: Float[Array, "ns1 6"]


def kernels(
    points: Float[Array, "p 3"], rings: Float[Array, "nc1 ns1 3"], wake: Float[Array, " 3"] | None = None
) -> Filaments:
    """Scalar kernels of every filament at every point, 1/m^2 per unit arm; ``wake``: unit vector along it, else x."""
    nodes = rings.reshape(-1, 3)
    square = _squares(points, nodes)
    shape = (points.shape[0], *rings.shape[:2])
    r2 = square.reshape(shape)
    r = jnp.sqrt(r2)
    bound = segment(
        r[:, :-1, :-1],
        r[:, :-1, 1:],
        r2[:, :-1, :-1],
        r2[:, :-1, 1:],
        _lengths(rings[:-1, :-1], rings[:-1, 1:]),
    )
    chordwise = segment(r[:, :-1], r[:, 1:], r2[:, :-1], r2[:, 1:], _lengths(rings[:-1], rings[1:]))
    return Filaments(bound, chordwise, _half_lines(points, rings[-1], r[:, -1], wake))


def arms(rings: Float[Array, "nc1 ns1 3"], wake: Float[Array, " 3"] | None = None) -> Arms:
    """Arms of the three families of filaments; ``wake`` as in `kernels`."""
    a, b = rings[-1], jnp.asarray([1.0, 0.0, 0.0]) if wake is None else wake
    lines = jnp.concatenate([jnp.broadcast_to(-b, a.shape), jnp.cross(a, b)], axis=-1)
    return Arms(_arm(rings[:-1, :-1], rings[:-1, 1:]), _arm(rings[:-1], rings[1:]), lines)


def _squares(points, nodes):
    """Squared distances; by differences, since the expanded form loses what the kernel needs near a node."""
    d = points[:, None, :] - nodes[None, :, :]
    return d[..., 0] ** 2 + d[..., 1] ** 2 + d[..., 2] ** 2


def _lengths(a, b):
    """Squared lengths of the filaments."""
    return jnp.sum((b - a) ** 2, axis=-1)


def segment(r1: Array, r2: Array, s1: Array, s2: Array, length2: Array) -> Array:
    """Kernel K of a segment from the distances to its ends: r1 . r2 = (r1^2 + r2^2 - |b - a|^2) / 2.

    Args:
        r1: distances from the first end to the points, m; all arguments broadcast.
        r2: distances from the second end.
        s1: squares of ``r1``.
        s2: squares of ``r2``.
        length2: squared length of the segment.

    Returns:
        Kernel of Katz & Plotkin, eq. 10.115, 1/m^2; zero on the segment itself.
    """
    product = r1 * r2
    denominator = product + (s1 + s2 - length2) / 2
    on_line = (denominator <= ON_FILAMENT * product) | (product <= AT_END * length2)
    safe = jnp.where(on_line, 1.0, denominator * product)
    return jnp.where(on_line, 0.0, (r1 + r2) / (FOUR_PI * safe))


def half_line(x: Array, h2: Array, r: Array) -> Array:
    """Kernel of a wake line; downstream r - r_x is written as h^2 / (r + r_x) to keep its digits.

    Args:
        x: how far the points are behind the start of the line, m; all arguments broadcast.
        h2: squared distance from the line, m^2.
        r: distance from its start, m.

    Returns:
        K = 1 / (4 pi r (r - x)), 1/m^2.
    """
    behind = x > 0
    ahead = jnp.where(behind, 1.0, jnp.maximum(r * (r - x), WAKE_CORE**2))
    return jnp.where(behind, (r + x) / (r * (h2 + WAKE_CORE**2)), 1.0 / ahead) / FOUR_PI


def _half_lines(points, starts, r, wake):
    """Kernels of the wake lines."""
    d = points[:, None, :] - starts[None, :, :]
    if wake is None:
        return half_line(d[..., 0], d[..., 1] ** 2 + d[..., 2] ** 2, r)
    x = d @ wake
    return half_line(x, jnp.sum((d - x[..., None] * wake) ** 2, axis=-1), r)


def _arm(a, b):
    """[a - b, a x b]."""
    return jnp.concatenate([a - b, jnp.cross(a, b)], axis=-1)
