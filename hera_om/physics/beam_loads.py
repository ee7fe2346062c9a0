"""Shear, bending and torsion of a cantilevered half wing from strips, hub loads, and the weight that
relieves them.

Everything that loads the wing is a `SpanLoad`: forces and moments, each spread over a width of span. Its
outboard share at a station is a smooth ramp, so section loads are continuous and once differentiable
(bending: twice) when edges or hubs move across stations.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

ScalarLike = Float[Array, ""] | float | int

STANDARD_GRAVITY = 9.80665  # m/s2, ISO 80000-3
# A concentrated load enters over the length of its attachment (a nacelle between two ribs or so): design
# choice.
ATTACHMENT_WIDTH = 0.30
# Every spread load is averaged over this length, which rounds the corners of V: bending is too large by q
# w^2 / 24, 20 N m for 12 kN/m; the shear at an end of the span too small by q w / 8.
ROUNDING_WIDTH = 0.10


class SpanLoad(NamedTuple):
    """k loads spread over [inner, outer] in y, acting at points (m): forces N, moments N m about them."""

    inner: Float[Array, "k"]
    outer: Float[Array, "k"]
    points: Float[Array, "k 3"]
    forces: Float[Array, "k 3"]
    moments: Float[Array, "k 3"]


class SpanMass(NamedTuple):
    """k masses in kg, spread over [inner, outer] in y, with their centres, m."""

    inner: Float[Array, "k"]
    outer: Float[Array, "k"]
    points: Float[Array, "k 3"]
    mass: Float[Array, "k"]


class Loads(NamedTuple):
    """Section loads at n stations, of everything outboard, on the axes of the beam.

    V up positive; M positive bends the tip up, upper skin in compression; T nose-up positive about the
    elastic axis; H positive aft; Mz positive bends the tip forward.
    """

    V: Float[Array, "n"]
    M: Float[Array, "n"]
    T: Float[Array, "n"]
    H: Float[Array, "n"]
    Mz: Float[Array, "n"]


def strip_load(
    edges: Float[Array, "edge"],
    points: Float[Array, "k 3"],
    *,
    forces: Float[Array, "k 3"],
    moments: Float[Array, "k 3"],
) -> SpanLoad:
    """Loads of adjoining strips, each uniform over its width; edges are y in m, ascending."""
    return SpanLoad(edges[:-1], edges[1:], points, forces, moments)


def point_load(points: Float[Array, "k 3"], *, forces: Float[Array, "k 3"], moments: Float[Array, "k 3"]) -> SpanLoad:
    """Concentrated loads, spread over ``ATTACHMENT_WIDTH`` about the y of their points."""
    y = points[:, 1]
    return SpanLoad(y - 0.5 * ATTACHMENT_WIDTH, y + 0.5 * ATTACHMENT_WIDTH, points, forces, moments)


def point_mass(mass: Float[Array, "k"], points: Float[Array, "k 3"]) -> SpanMass:
    """Concentrated masses, spread over ``ATTACHMENT_WIDTH`` about the y of their points."""
    y = points[:, 1]
    return SpanMass(y - 0.5 * ATTACHMENT_WIDTH, y + 0.5 * ATTACHMENT_WIDTH, points, mass)


def spread_mass(
    total: ScalarLike,
    edges: Float[Array, "edge"],
    *,
    intensity: Float[Array, "k"],
    points: Float[Array, "k 3"],
) -> SpanMass:
    """A mass spread over strips in proportion to an intensity per unit span.

    Structure and fuel alike: intensity = chord times box height (wing structure scales with the box, fuel
    fills it).

    Args:
        total: mass, kg.
        edges: y of the strip edges, m, ascending [edge].
        intensity: relative mass per unit span of each strip [k].
        points: centres of the strips, m [k, 3].

    Returns:
        Masses that sum to ``total``.
    """
    share = intensity * jnp.diff(edges)
    return SpanMass(edges[:-1], edges[1:], points, total * share / jnp.sum(share))


def inertia_forces(mass: Float[Array, "k"], load_factor: ScalarLike) -> Float[Array, "k 3"]:
    """Weight and inertia -n m g along z, N, of masses at load factor n (CS-25.321): they relieve the lift."""
    return -load_factor * STANDARD_GRAVITY * mass[:, None] * jnp.array([0.0, 0.0, 1.0])


def inertia_load(masses: SpanMass, load_factor: ScalarLike) -> SpanLoad:
    """The load of masses at load factor n."""
    forces = inertia_forces(masses.mass, load_factor)
    return SpanLoad(masses.inner, masses.outer, masses.points, forces, jnp.zeros_like(forces))


def outboard_share(
    y: Float[Array, "n"], inner: Float[Array, "k"], outer: Float[Array, "k"]
) -> tuple[Float[Array, "n k"], Float[Array, "n k"]]:
    """Share of a uniform load on [inner, outer] that lies outboard of y, and that share times its arm from y.

    f = mean over a window of the linear ramp, g = int_y^inf f: a trapezoid density (box of the load's
    width, convolved with a box of ``ROUNDING_WIDTH``) integrated once and twice.

    Args:
        y: stations, m [n].
        inner: inboard ends, m [k].
        outer: outboard ends, m, beyond ``inner`` [k].

    Returns:
        f [n, k] in 0..1 and g [n, k] in m.
    """
    width, rounding = outer - inner, ROUNDING_WIDTH
    half = 0.5 * (width + rounding)
    notch = 0.5 * (width - rounding)
    u = 0.5 * (inner + outer) - y[:, None]
    inside = jnp.clip(u, -half, half)

    def ramp(power: int) -> Float[Array, "n k"]:
        a, b, c = (jnp.maximum(v, 0.0) ** power for v in (inside + half, inside + notch, inside - notch))
        return (a - b - c) / (width * rounding)

    return ramp(2) / 2.0, ramp(3) / 6.0 + jnp.maximum(u - half, 0.0)


def axis_frame(
    axis_points: Float[Array, "n 3"],
) -> tuple[Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, "n 3"]]:
    """Unit vectors of the beam: chordwise aft b, along the axis outboard e, up n = b x e."""
    slope = jnp.diff(axis_points, axis=0)
    along = jnp.concatenate([slope[:1], 0.5 * (slope[1:] + slope[:-1]), slope[-1:]])
    e = along / jnp.linalg.norm(along, axis=1, keepdims=True)
    b = jnp.cross(e, jnp.array([0.0, 0.0, 1.0]))
    b = b / jnp.linalg.norm(b, axis=1, keepdims=True)
    return b, e, jnp.cross(b, e)


def section_loads(y_stations: Float[Array, "n"], axis_points: Float[Array, "n 3"], *loads: SpanLoad) -> Loads:
    """Section loads of a cantilever at its stations.

    Force and moment of everything outboard, F = sum f_k F_k and M = sum (p_k - a) x F_k f_k + f_k M_k with
    the spanwise arm of the outboard part g_k (Megson, Aircraft Structures, ch. 16), resolved on the axes of
    the beam at the station.

    Args:
        y_stations: y of the stations, m, from the fuselage joint to the tip [n].
        axis_points: elastic axis at the stations, m [n, 3].
        *loads: any number of loads: strips, hubs, inertia.

    Returns:
        Shear, bending, torsion, and the in-plane pair.
    """
    inner, outer, points, forces, moments = (jnp.concatenate(parts) for parts in zip(*loads, strict=True))
    share, arm_y = outboard_share(y_stations, inner, outer)
    arm_x = share * (points[:, 0] - axis_points[:, 0, None])
    arm_z = share * (points[:, 2] - axis_points[:, 2, None])
    total = share @ forces
    fx, fy, fz = forces.T
    moment = share @ moments + jnp.stack(
        [arm_y @ fz - arm_z @ fy, arm_z @ fx - arm_x @ fz, arm_x @ fy - arm_y @ fx], axis=1
    )
    b, e, n = axis_frame(axis_points)

    def along(vector: Float[Array, "n 3"], axis: Float[Array, "n 3"]) -> Float[Array, "n"]:
        return jnp.sum(vector * axis, axis=1)

    return Loads(along(total, n), along(moment, b), along(moment, e), along(total, b), along(moment, n))
