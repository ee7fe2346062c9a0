"""Velocity of semi-infinite doublet strips whose strength is constant, or grows linearly, behind a line.

A strip runs from the segment a b along +x to infinity. With constant strength 1 it is a horseshoe vortex
(`step`). With the strength x - x_ab of a wake that is late by its time of flight it is a sheet of vortices
parallel to a b, closed by two half-lines of growing strength (`ramp`): the integral of the horseshoe over the
place where it starts. With t = b - a, its part w e across x, n = e_x x e, r_a = p - a, h its part across x,

    V = {n [t_x (L_b - L_a) + |t| L_ab] + S (w e_x - t_x e)} / (4 pi w) + G_b - G_a,
    L_a = ln[(|r_a| + r_ax) / h_a^2],  L_ab = ln[(|r_a| + |r_b| + |t|) / (|r_a| + |r_b| - |t|)],
    G_a = (|r_a| + r_ax) / (4 pi h^2) e_x x h,

where S is the solid angle of the strip, a triangle with one corner at infinity (van Oosterom & Strackee, IEEE
Trans. Biomed. Eng. BME-30, 1983). The first line follows from J = integral of (p - q) / |p - q|^3 over the
strip: its part along n is S, and its part in the strip is, by Gauss's theorem, the integral of m / |p - q|
along the edges, m their outward normals. V falls off as 1 / |r| upstream, so wakes of growing strength converge.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.vortex_kernel import FOUR_PI, WAKE_CORE

# A point whose solid angle has a sine below this stands on the strip, where the mean of both sides is zero.
ON_STRIP = 1e-12


def step(points: Float[Array, "p 3"], left: Float[Array, "s 3"], right: Float[Array, "s 3"]) -> Float[Array, "p s 3"]:
    """Velocity of strips of unit strength that begin at the segments from ``left`` to ``right``, 1/m.

    Katz & Plotkin, Low-Speed Aerodynamics 2e, eq. 10.115 for the segment and its limit for the half-lines.
    """
    (a, ra), (b, rb) = _ray(points, left), _ray(points, right)
    strength = (1 / ra + 1 / rb) / (ra * rb + _dot(a, b))
    one, other = _growth(a, ra) / ra, _growth(b, rb) / rb
    x, y, z = (strength * v for v in _cross(a, b))
    return jnp.stack([x, y - other * b[2] + one * a[2], z + other * b[1] - one * a[1]], axis=-1) / FOUR_PI


def ramp(points: Float[Array, "p 3"], left: Float[Array, "s 3"], right: Float[Array, "s 3"]) -> Float[Array, "p s 3"]:
    """Velocity of strips whose strength is the distance along x behind the segments from ``left`` to ``right``."""
    (a, ra), (b, rb) = _ray(points, left), _ray(points, right)
    t = right - left
    length, width = jnp.linalg.norm(t, axis=-1), jnp.linalg.norm(t[:, 1:], axis=-1)
    tx, ey, ez = t[:, 0] / width, t[:, 1] / width, t[:, 2] / width
    one, other = _growth(a, ra), _growth(b, rb)
    up = tx * jnp.log(other / one) + length / width * jnp.log((ra + rb + length) / (ra + rb - length))
    angle = _solid_angle(a, b, ra, rb)
    y = -up * ez - angle * tx * ey - other * b[2] + one * a[2]
    z = up * ey - angle * tx * ez + other * b[1] - one * a[1]
    return jnp.stack([angle, y, z], axis=-1) / FOUR_PI


def _ray(points, nodes):
    """Components of the vectors from the nodes to the points, and their lengths."""
    d = [points[:, None, i] - nodes[:, i] for i in range(3)]
    return d, jnp.sqrt(_dot(d, d))


def _dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a, b):
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _growth(d, r):
    """(r + x) / h^2, upstream as 1 / (r - x); the core as in `vortex_kernel`."""
    behind = d[0] > 0
    h2 = d[1] ** 2 + d[2] ** 2 + WAKE_CORE**2
    return jnp.where(behind, (r + d[0]) / h2, 1.0 / jnp.where(behind, 1.0, r - d[0]))


def _solid_angle(a, b, ra, rb):
    """Solid angle of the strips, positive on the side of n; +-2 pi on them, so zero there."""
    sine = a[1] * b[2] - a[2] * b[1]
    cosine = ra * rb + _dot(a, b) - a[0] * rb - b[0] * ra
    on_strip = (cosine <= 0) & (jnp.abs(sine) <= ON_STRIP * ra * rb)
    return 2 * jnp.arctan2(jnp.where(on_strip, 0.0, sine), jnp.where(on_strip, 1.0, cosine))
