"""Steady vortex-ring lattice of any number of surfaces in symmetric flow (half model).

The wake runs along x, so that the matrix depends on geometry and Mach number alone: one factorisation serves
every incidence, rate, control angle and slipstream, all derivatives by them, and the adjoint. Equations: Katz
& Plotkin, Low-Speed Aerodynamics 2e, chapter 12; compressibility: Prandtl-Glauert as in AVL, the physical
boundary condition with the velocities of the stretched problem (see `vortex_kernel`).

Unknowns are ring circulations over the flight speed, in m. Valid for attached flow, small incidence and
subcritical Mach numbers (below about 0.7), away from the cores of other surfaces' wakes.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.scipy.linalg import lu_factor, lu_solve
from jaxtyping import Array, Float

from hera_om.physics.geometry import Panels, between
from hera_om.physics.vortex_kernel import Arms, Filaments, arms, kernels

MIRROR = (1.0, -1.0, 1.0)


class Lattice(NamedTuple):
    """Assembled lattice of n panels, e loaded filaments, s strips, t trailing nodes of all surfaces."""

    collocation: Float[Array, "n 3"]
    across: Float[Array, "2 n 3"]  # at each collocation point: middle of the strip, its width as a vector
    normal: Float[Array, "n 3"]
    normal_hinge: Float[Array, "n 3"]
    points: Float[Array, "e 3"]  # points of attack of the filaments, in the order of `layout.Layout`
    middles: Float[Array, "e 3"]  # their middles
    arms: Float[Array, "e 3"]  # vectors of the filaments, m
    strip_point: Float[Array, "s 3"]  # quarter-chord points of the strips
    strip_edge: Float[Array, "s 3"]  # vectors along their quarter-chord lines
    strip_chord: Float[Array, " s"]
    strip_width: Float[Array, " s"]
    trail: Float[Array, "t 2"]  # y and z of the trailing nodes
    trail_middle: Float[Array, "s 2"]
    matrix: Float[Array, "n n"]  # normal velocity at the collocation points
    lu: tuple  # factors and pivots; no derivatives
    velocity: Float[Array, "e 3 n"]  # velocity at ``points`` per unit unknown


def prandtl_glauert(mach):
    """beta = sqrt(1 - M^2)."""
    return jnp.sqrt(1.0 - mach**2)


def shapes(surfaces: list[Panels]) -> list[tuple[int, int]]:
    """Chordwise and spanwise panels of each surface."""
    return [(s.collocation.shape[0], s.collocation.shape[1]) for s in surfaces]


def assemble(surfaces: list[Panels], mach, elsewhere: Float[Array, "p 3"] | None = None) -> tuple[Lattice, Array]:
    """Influence matrices and factorisation of a lattice.

    Args:
        surfaces: starboard halves, each from the plane of symmetry outwards.
        mach: Mach number, below 1.
        elsewhere: further points whose velocities are wanted, m.

    Returns:
        Lattice, and the velocity at the further points per unit unknown [p, 3, n].
    """
    collocation, normal = _stack(surfaces, "collocation"), _stack(surfaces, "normal")
    points, middles, lines = (jnp.concatenate(v) for v in zip(*map(_filaments, surfaces), strict=True))
    extra = jnp.zeros((0, 3)) if elsewhere is None else elsewhere
    n, e = collocation.shape[0], points.shape[0]
    everywhere = velocity_influence(jnp.concatenate([collocation, points, extra]), surfaces, prandtl_glauert(mach))
    matrix = jnp.einsum("pi,pin->pn", normal, everywhere[:n])
    edges = [s.strip_edges for s in surfaces]
    trail = [s.rings[-1, :, 1:] for s in surfaces]
    lattice = Lattice(
        collocation,
        jnp.concatenate([s.across.reshape(2, -1, 3) for s in surfaces], axis=1),
        normal,
        _stack(surfaces, "normal_hinge"),
        points,
        middles,
        lines,
        jnp.concatenate([between(q[:-1], q[1:], s.middle) for q, s in zip(edges, surfaces, strict=True)]),
        jnp.concatenate([q[1:] - q[:-1] for q in edges]),
        jnp.concatenate([s.strip_chord for s in surfaces]),
        jnp.concatenate([s.strip_width for s in surfaces]),
        jnp.concatenate(trail),
        jnp.concatenate([between(q[:-1], q[1:], s.middle) for q, s in zip(trail, surfaces, strict=True)]),
        matrix,
        lu_factor(jax.lax.stop_gradient(matrix)),
        everywhere[n : n + e],
    )
    return lattice, everywhere[n + e :]


def solve(lattice: Lattice, rhs: Float[Array, "n *m"]) -> Float[Array, "n *m"]:
    """Circulations for right-hand sides; derivatives reuse the factorisation (implicit function theorem)."""

    def by_lu(transpose):
        return lambda _, b: lu_solve(lattice.lu, b, trans=transpose)

    return jax.lax.custom_linear_solve(lambda g: lattice.matrix @ g, rhs, by_lu(0), transpose_solve=by_lu(1))


def velocity_influence(points, surfaces: list[Panels], beta) -> Float[Array, "p 3 n"]:
    """Velocity vectors at ``points`` per unit ring circulation, both halves.

    The image of a half is the mirrored velocity at the mirrored point, so one call of the kernel gives both.
    """
    count, mirror = points.shape[0], jnp.asarray(MIRROR)
    p = jnp.concatenate([points, points * mirror]) * _stretch(beta)
    axes = jnp.broadcast_to((jnp.eye(3) * _stretch(beta))[:, None, :], (3, *p.shape))
    weights = jnp.concatenate([jnp.cross(axes, jnp.broadcast_to(p, axes.shape)), axes], axis=-1)
    both = jnp.concatenate([_rings(*_project(weights, p, s, beta)) for s in surfaces], axis=-1)
    return jnp.moveaxis(both[:, :count] + both[:, count:] * mirror[:, None, None], 0, 1)


def _stretch(beta):
    """Prandtl-Glauert: coordinates and the x velocity both take 1/beta along x."""
    return jnp.stack([1.0 / beta, jnp.ones_like(beta), jnp.ones_like(beta)])


def _stack(surfaces, name):
    """One array of all panels."""
    return jnp.concatenate([getattr(s, name).reshape(-1, 3) for s in surfaces])


def _project(weights, p, surface, beta) -> tuple[Array, ...]:
    """Kernel times arm for the three families of filaments of one surface, directions first."""
    rings = surface.rings * _stretch(beta)
    k: Filaments = kernels(p, rings)
    a: Arms = arms(rings)
    return tuple(ki * jnp.tensordot(weights, ai, axes=([-1], [-1])) for ki, ai in zip(k, a, strict=True))


def _rings(bound, chordwise, wake):
    """Filaments to rings: front minus rear bound line, right minus left chordwise line, wake last."""
    rear = jnp.pad(bound[..., 1:, :], ((0, 0), (0, 0), (0, 1), (0, 0)))
    ring = bound - rear + chordwise[..., 1:] - chordwise[..., :-1]
    ring = ring.at[..., -1, :].add(wake[..., 1:] - wake[..., :-1])
    return ring.reshape(*ring.shape[:2], -1)


def _filaments(surface: Panels):
    """Points of attack, middles and vectors of the bound filaments, then of the chordwise ones."""
    rings = surface.rings
    left, right, front, back = rings[:-1, :-1], rings[:-1, 1:], rings[:-1], rings[1:]
    along = (front + back) / 2
    points = [between(left, right, surface.middle), along]
    pairs = (points, [(left + right) / 2, along], [right - left, back - front])
    return tuple(jnp.concatenate([p.reshape(-1, 3) for p in pair]) for pair in pairs)
