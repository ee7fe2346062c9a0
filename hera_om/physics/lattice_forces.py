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


def filament_strengths(plan: Layout, gamma: Float[Array, " n"], odd: Array | None = None) -> Float[Array, " e"]:
    """Net circulation of every filament of a half that carries force, over the flight speed, m.

    On the plane of symmetry the other half's filament lies on the same line: it cancels the mirrored part of
    the circulations and doubles the reversed part ``odd``, of which each half takes its own.
    """
    padded = jnp.append(gamma, 0.0)
    strength = padded[plan.plus] - padded[plan.minus]
    strength = strength if odd is None else strength.at[plan.root].add(-odd[plan.root_ring])
    return strength * jnp.asarray(plan.loaded)


def filament_forces(lattice: Lattice, strength: Float[Array, " e"], velocity: Float[Array, "e 3"]):
    """Force over dynamic pressure (m^2) on every loaded filament: dF = 2 Gamma V x l, V over flight speed.

    Kutta-Joukowski with the full local velocity (Katz & Plotkin, eq. 12.25).
    """
    return 2.0 * strength[:, None] * jnp.cross(velocity, lattice.arms)


def strip_loads(lattice: Lattice, plan: Layout, forces: Float[Array, "e 3"]) -> StripLoads:
    """Forces collected by strip; a chordwise filament is shared by its two neighbours."""

    def collect(load):
        inner = plan.share[:, None] * load
        total = jnp.zeros((lattice.strip_point.shape[0], 3))
        return total.at[plan.inner].add(inner).at[plan.outer].add(load - inner)

    force = collect(forces)
    about_origin = collect(jnp.cross(lattice.points, forces))
    return StripLoads(lattice.strip_point, force, about_origin - jnp.cross(lattice.strip_point, force))


def resultant(halves: list[StripLoads], plan: Layout, reference: Float[Array, " 3"]) -> tuple[Array, Array]:
    """Force (m^2) and moment (m^3) about ``reference`` of both halves over dynamic pressure.

    One half alone stands for flow that the plane of symmetry mirrors: y force and x, z moments cancel. With two,
    the second one is the port half as the plane mirrors it.
    """
    centre = reference * jnp.asarray([1.0, 0.0, 1.0])
    weights = (plan.weight[:, None], (plan.weight * plan.image)[:, None])[: len(halves)]
    pairs = list(zip(weights, halves, strict=True))
    force = both_halves([jnp.sum(w * h.force, axis=0) for w, h in pairs])
    arms = [h.moment + jnp.cross(h.point - centre, h.force) for h in halves]
    moment = both_halves([jnp.sum(w * m, axis=0) for w, m in zip(weights, arms, strict=True)], axial=True)
    return force, moment - jnp.cross(reference - centre, force)


def both_halves(parts: list[Array], axial: bool = False) -> Array:
    """Sum of a vector over both halves, the second part being mirrored; ``axial``: a moment."""
    mirror = jnp.asarray([-1.0, 1.0, -1.0]) if axial else jnp.asarray(MIRROR)
    return parts[0] + parts[-1] * mirror


def trefftz(lattice: Lattice, plan: Layout, gamma: Float[Array, " n"], odd: bool = False) -> tuple[Array, Array]:
    """Lift and induced drag over dynamic pressure (m^2, both halves) from the wake far downstream.

    D = -rho / 2 * sum of Gamma w_n ds over the wake trace (Katz & Plotkin, eq. 8.146), w from the
    two-dimensional trailing vortices of all surfaces and their images. In a sum of mirrored and reversed flow
    the drags of both add up, since their products cancel between the halves.

    Args:
        lattice: geometry.
        plan: layout.
        gamma: circulations of the mirrored flow, or of the reversed one.
        odd: whether it is the reversed flow; its lift is that of the starboard half, doubled.
    """
    strength = gamma[plan.last]
    padded = jnp.append(strength * plan.weight if odd else strength, 0.0)
    trailing = padded[plan.trail_plus] - padded[plan.trail_minus]  # along +x
    step = lattice.trail[plan.node + 1] - lattice.trail[plan.node]
    wash = jnp.zeros_like(lattice.trail_middle)
    for flip, sign in ((1.0, 1.0), (MIRROR[1], -1.0 if odd else 1.0)):
        mirror = jnp.asarray([flip, 1.0])
        r = (lattice.trail_middle * mirror)[:, None, :] - lattice.trail[None]
        swirl = jnp.stack([-r[..., 1], r[..., 0]], axis=-1) / jnp.sum(r**2, axis=-1, keepdims=True)
        wash = wash + sign * jnp.einsum("j,pjk->pk", trailing, swirl) / (2 * jnp.pi) * mirror
    drag = -2.0 * jnp.sum(plan.weight * strength * (wash[:, 1] * step[:, 0] - wash[:, 0] * step[:, 1]))
    return 4.0 * jnp.sum(plan.weight * strength * step[:, 0]), drag
