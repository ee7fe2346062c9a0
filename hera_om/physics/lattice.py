"""Steady vortex-ring lattice of any number of surfaces in symmetric flow (half model).

The wake runs along x, so that the matrix depends on geometry and Mach number alone: one factorisation serves
every incidence, rate, control angle and slipstream, all derivatives by them, and the adjoint. Equations:
Katz & Plotkin, Low-Speed Aerodynamics 2e, chapter 12; compressibility: Prandtl-Glauert as in AVL, the physical
boundary condition with the velocities of the stretched problem (see `vortex_kernel`).

Unknowns are ring circulations over the flight speed, in m. Valid for attached flow, small incidence and subcritical
Mach numbers (below about 0.7), away from the cores of other surfaces' wakes.
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
    """Assembled lattice: points, filaments and the influence of the unknowns on them."""

    collocation: Float[Array, "n 3"]
    normal: Float[Array, "n 3"]
    normal_hinge: Float[Array, "n 3"]
    bound_points: Float[Array, "e 3"]  # middles of the bound and chordwise filaments of all surfaces
    bound_arms: Float[Array, "e 3"]  # their vectors, m
    matrix: Float[Array, "n n"]  # normal velocity at the collocation points
    lu: tuple  # factors and pivots; no derivatives
    velocity: Float[Array, "e 3 n"]  # velocity at bound_points per unit unknown


def prandtl_glauert(mach):
    """beta = sqrt(1 - M^2)."""
    return jnp.sqrt(1.0 - mach**2)


def assemble(surfaces: list[Panels], mach) -> Lattice:
    """Influence matrices and factorisation of a lattice, ``n`` panels and ``e`` loaded filaments in all.

    Args:
        surfaces: starboard halves, each from the plane of symmetry outwards.
        mach: Mach number, below 1.

    Returns:
        Lattice.
    """
    collocation = _stack(surfaces, "collocation")
    normal = _stack(surfaces, "normal")
    middles, vectors = zip(*(_filament_vectors(s) for s in surfaces), strict=True)
    points, lines = jnp.concatenate(middles), jnp.concatenate(vectors)
    beta = prandtl_glauert(mach)
    matrix = normal_influence(collocation, normal, surfaces, beta)
    lu = lu_factor(jax.lax.stop_gradient(matrix))
    velocity = velocity_influence(points, surfaces, beta)
    return Lattice(collocation, normal, _stack(surfaces, "normal_hinge"), points, lines, matrix, lu, velocity)


def solve(lattice: Lattice, rhs: Float[Array, "n *m"]) -> Float[Array, "n *m"]:
    """Circulations for right-hand sides; derivatives reuse the factorisation (implicit function theorem)."""

    def by_lu(transpose):
        return lambda _, b: lu_solve(lattice.lu, b, trans=transpose)

    return jax.lax.custom_linear_solve(lambda g: lattice.matrix @ g, rhs, by_lu(0), transpose_solve=by_lu(1))


def normal_influence(points, normals, surfaces: list[Panels], beta) -> Float[Array, "p n"]:
    """Velocity along ``normals`` at ``points`` per unit ring circulation, both halves."""
    return influence(points, normals[None], surfaces, beta)[0]


def velocity_influence(points, surfaces: list[Panels], beta) -> Float[Array, "p 3 n"]:
    """Velocity vectors at ``points`` per unit ring circulation, both halves."""
    axes = jnp.broadcast_to(jnp.eye(3)[:, None, :], (3, points.shape[0], 3))
    return jnp.moveaxis(influence(points, axes, surfaces, beta), 0, 1)


def influence(points, directions: Float[Array, "m p 3"], surfaces: list[Panels], beta) -> Float[Array, "m p n"]:
    """Velocity at ``points`` along m directions per unit ring circulation, both halves."""
    total = 0.0
    for flip in (jnp.ones(3), jnp.asarray(MIRROR)):
        p, d = points * flip * _stretch(beta), directions * flip * _stretch(beta)
        weights = jnp.concatenate([jnp.cross(d, jnp.broadcast_to(p, d.shape)), d], axis=-1)
        total = total + jnp.concatenate([_rings(*_project(weights, p, s, beta)) for s in surfaces], axis=-1)
    return total


def filament_strengths(surfaces: list[Panels], gamma: Float[Array, " n"]) -> Float[Array, " e"]:
    """Net circulation of the bound and chordwise filaments, in the order of ``Lattice.bound_points``."""
    out, start = [], 0
    for s in surfaces:
        nc, ns = s.collocation.shape[:2]
        ring = gamma[start : start + nc * ns].reshape(nc, ns)
        start += nc * ns
        bound = jnp.diff(ring, axis=0, prepend=0.0)
        chordwise = -jnp.diff(ring, axis=1, prepend=0.0, append=0.0)
        out += [bound.ravel(), chordwise.at[:, 0].set(0.0).ravel()]
    return jnp.concatenate(out)


def _stretch(beta):
    """Prandtl-Glauert: coordinates and the x velocity both take 1/beta along x."""
    return jnp.stack([1.0 / beta, jnp.ones_like(beta), jnp.ones_like(beta)])


def _stack(surfaces, name):
    """One array of all panels."""
    return jnp.concatenate([getattr(s, name).reshape(-1, 3) for s in surfaces])


def _project(weights, p, surface, beta) -> tuple[Array, Array, Array]:
    """Kernel times arm for the three families of filaments of one surface, directions first."""
    rings = surface.rings * _stretch(beta)
    k: Filaments = kernels(p, rings)
    a: Arms = arms(rings)
    return tuple(ki * jnp.tensordot(weights, ai, axes=([-1], [-1])) for ki, ai in zip(k, a, strict=True))


def _rings(bound, chordwise, wake):
    """Filaments to rings: front minus rear bound line, right minus left chordwise line, wake on the last row."""
    rear = jnp.pad(bound[..., 1:, :], ((0, 0), (0, 0), (0, 1), (0, 0)))
    ring = bound - rear + chordwise[..., 1:] - chordwise[..., :-1]
    ring = ring.at[..., -1, :].add(wake[..., 1:] - wake[..., :-1])
    return ring.reshape(*ring.shape[:2], -1)


def _filament_vectors(surface: Panels):
    """Points of attack and vectors of the bound filaments, then of the chordwise ones."""
    rings = surface.rings
    left, right, front, back = rings[:-1, :-1], rings[:-1, 1:], rings[:-1], rings[1:]
    points = [between(left, right, surface.middle), (front + back) / 2]
    return tuple(jnp.concatenate([p.reshape(-1, 3) for p in pair]) for pair in (points, [right - left, back - front]))
