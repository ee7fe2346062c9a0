"""Forces of a solved lattice: Kutta-Joukowski on every loaded filament, strips, Trefftz plane."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.lattice import MIRROR, Lattice
from hera_om.physics.layout import Layout


class StripLoads(NamedTuple):
    """Loads of the strips of the starboard half over dynamic pressure, forces in m^2, moments in m^3."""

    point: Float[Array, "s 3"]  # on the quarter-chord line
    force: Float[Array, "s 3"]
    moment: Float[Array, "s 3"]  # about ``point``


def filament_strengths(plan: Layout, gamma: Float[Array, " n"]) -> Float[Array, " e"]:
    """Net circulation of every filament over the flight speed, m."""
    padded = jnp.append(gamma, 0.0)
    return padded[plan.plus] - padded[plan.minus]


def filament_forces(lattice: Lattice, plan: Layout, gamma, onset: Float[Array, "e 3"]) -> Float[Array, "e 3"]:
    """Force over dynamic pressure (m^2) on every loaded filament: dF = 2 Gamma V x l, V over flight speed.

    Kutta-Joukowski with the full local velocity (Katz & Plotkin, eq. 12.25); ``onset`` is everything but the
    lattice's own induction: free stream, rotation, slipstream.
    """
    local = onset + lattice.velocity @ gamma
    return 2.0 * filament_strengths(plan, gamma)[:, None] * jnp.cross(local, lattice.arms)


def filament_force_change(lattice: Lattice, plan: Layout, gamma, onset, change) -> Float[Array, "e 3"]:
    """Derivative of `filament_forces` by the circulations along ``change`` [n]."""
    local = onset + lattice.velocity @ gamma
    old, new = filament_strengths(plan, gamma)[:, None], filament_strengths(plan, change)[:, None]
    return 2.0 * jnp.cross(new * local + old * (lattice.velocity @ change), lattice.arms)


def strip_loads(lattice: Lattice, plan: Layout, forces: Float[Array, "e 3"]) -> StripLoads:
    """Forces collected by strip; a chordwise filament is shared by its two neighbours."""

    def collect(load):
        inner = plan.share[:, None] * load
        total = jnp.zeros((lattice.strip_point.shape[0], 3))
        return total.at[plan.inner].add(inner).at[plan.outer].add(load - inner)

    force = collect(forces)
    about_origin = collect(jnp.cross(lattice.points, forces))
    return StripLoads(lattice.strip_point, force, about_origin - jnp.cross(lattice.strip_point, force))


def half_resultant(loads: StripLoads, reference: Float[Array, " 3"]) -> tuple[Array, Array]:
    """Force and moment about ``reference`` of both halves: y force and x, z moments cancel."""
    force = jnp.sum(loads.force, axis=0)
    moment = jnp.sum(loads.moment + jnp.cross(loads.point - reference, loads.force), axis=0)
    keep = jnp.asarray([2.0, 0.0, 2.0])
    return force * keep, moment * (2.0 - keep)


def trefftz(lattice: Lattice, plan: Layout, gamma) -> tuple[Array, Array]:
    """Lift and induced drag over dynamic pressure (m^2, both halves) from the wake far downstream.

    D = -rho / 2 * sum of Gamma w_n ds over the wake trace (Katz & Plotkin, eq. 8.146), w from the
    two-dimensional trailing vortices of all surfaces and their images.
    """
    strength = gamma[plan.last]
    padded = jnp.append(strength, 0.0)
    trailing = padded[plan.trail_plus] - padded[plan.trail_minus]  # along +x
    step = lattice.trail[plan.node + 1] - lattice.trail[plan.node]
    wash = jnp.zeros_like(lattice.trail_middle)
    for flip in (1.0, MIRROR[1]):
        mirror = jnp.asarray([flip, 1.0])
        r = (lattice.trail_middle * mirror)[:, None, :] - lattice.trail[None]
        swirl = jnp.stack([-r[..., 1], r[..., 0]], axis=-1) / jnp.sum(r**2, axis=-1, keepdims=True)
        wash = wash + jnp.einsum("j,pjk->pk", trailing, swirl) / (2 * jnp.pi) * mirror
    drag = -2.0 * jnp.sum(strength * (wash[:, 1] * step[:, 0] - wash[:, 0] * step[:, 1]))
    return 4.0 * jnp.sum(strength * step[:, 0]), drag
