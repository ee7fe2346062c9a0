"""Forces of a solved lattice: Kutta-Joukowski on every loaded filament, strips, Trefftz plane."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.geometry import Panels, between
from hera_om.physics.lattice import MIRROR, Lattice, filament_strengths


class StripLoads(NamedTuple):
    """Loads of the strips of one starboard half over dynamic pressure, forces in m^2, moments in m^3."""

    point: Float[Array, "ns 3"]  # middle of the strip on the quarter-chord line
    force: Float[Array, "ns 3"]
    moment: Float[Array, "ns 3"]  # about ``point``


def filament_forces(lattice: Lattice, surfaces: list[Panels], gamma, onset: Float[Array, "e 3"]) -> Float[Array, "e 3"]:
    """Force over dynamic pressure (m^2) on every loaded filament: dF = 2 Gamma V x l, V over the flight speed.

    Kutta-Joukowski with the full local velocity (Katz & Plotkin, eq. 12.25); ``onset`` is everything but the
    lattice's own induction: free stream, rotation, slipstream.
    """
    local = onset + lattice.velocity @ gamma
    return 2.0 * filament_strengths(surfaces, gamma)[:, None] * jnp.cross(local, lattice.bound_arms)


def filament_force_change(lattice: Lattice, surfaces: list[Panels], gamma, onset, change) -> Float[Array, "e 3"]:
    """Derivative of `filament_forces` by the circulations along ``change`` [n]."""
    local = onset + lattice.velocity @ gamma
    old, new = filament_strengths(surfaces, gamma)[:, None], filament_strengths(surfaces, change)[:, None]
    return 2.0 * jnp.cross(new * local + old * (lattice.velocity @ change), lattice.bound_arms)


def strip_loads(surfaces: list[Panels], lattice: Lattice, forces: Float[Array, "e 3"]) -> list[StripLoads]:
    """Forces collected by strip; a chordwise filament is shared by its two neighbours."""
    out, start = [], 0
    for s in surfaces:
        nc, ns = s.collocation.shape[:2]
        middle = between(s.strip_edges[:-1], s.strip_edges[1:], s.middle)
        f, m = 0.0, 0.0
        for width in (ns, ns + 1):
            block = slice(start, start + nc * width)
            start += nc * width
            p, load = lattice.bound_points[block].reshape(nc, width, 3), forces[block].reshape(nc, width, 3)
            for points, part in _shares(p, load, ns):
                f = f + jnp.sum(part, axis=0)
                m = m + jnp.sum(jnp.cross(points - middle, part), axis=0)
        out.append(StripLoads(middle, f, m))
    return out


def _shares(points, load, ns):
    """Pairs (points, loads) of shape [nc, ns, 3] that hand every filament to its strips."""
    if load.shape[1] == ns:
        return [(points, load)]
    half = jnp.full((ns + 1, 1), 0.5)
    left, right = half.at[0].set(1.0), half.at[-1].set(1.0)
    return [(points[:, :-1], (load * left)[:, :-1]), (points[:, 1:], (load * right)[:, 1:])]


def half_resultant(strips: list[StripLoads], reference: Float[Array, " 3"]) -> tuple[Array, Array]:
    """Force and moment about ``reference`` of both halves: y force and x, z moments cancel."""
    force = sum(jnp.sum(s.force, axis=0) for s in strips)
    moment = sum(jnp.sum(s.moment + jnp.cross(s.point - reference, s.force), axis=0) for s in strips)
    keep = jnp.asarray([2.0, 0.0, 2.0])
    return force * keep, moment * (2.0 - keep)


def trefftz(surfaces: list[Panels], gamma) -> tuple[Array, Array]:
    """Lift and induced drag over dynamic pressure (m^2, both halves) from the wake far downstream.

    D = -rho / 2 * sum of Gamma w_n ds over the wake trace (Katz & Plotkin, eq. 8.146), w from the two-dimensional
    trailing vortices of all surfaces and their images.
    """
    nodes, circulation, start = [], [], 0
    for s in surfaces:
        nc, ns = s.collocation.shape[:2]
        circulation.append(gamma[start : start + nc * ns].reshape(nc, ns)[-1])
        nodes.append(s.rings[-1, :, 1:])
        start += nc * ns
    middles = jnp.concatenate([between(n[:-1], n[1:], s.middle) for n, s in zip(nodes, surfaces, strict=True)])
    steps = jnp.concatenate([n[1:] - n[:-1] for n in nodes])
    normals = jnp.stack([-steps[:, 1], steps[:, 0]], axis=-1)  # times the width of the strip
    wash = sum(_trace_velocity(middles, n, g) for n, g in zip(nodes, circulation, strict=True))
    strength = jnp.concatenate(circulation)
    drag = -2.0 * jnp.sum(strength * jnp.sum(wash * normals, axis=-1))
    return 4.0 * jnp.sum(strength * steps[:, 0]), drag


def _trace_velocity(points, nodes, circulation):
    """Velocity [p, 2] in the y-z plane of one wake trace and its image."""
    trailing = -jnp.diff(circulation, prepend=0.0, append=0.0)  # along +x, at every node
    total = 0.0
    for flip in (1.0, MIRROR[1]):
        mirror = jnp.asarray([flip, 1.0])
        r = (points * mirror)[:, None, :] - nodes[None]
        swirl = jnp.stack([-r[..., 1], r[..., 0]], axis=-1) / jnp.sum(r**2, axis=-1, keepdims=True)
        total = total + jnp.einsum("j,pjk->pk", trailing, swirl) / (2 * jnp.pi) * mirror
    return total
