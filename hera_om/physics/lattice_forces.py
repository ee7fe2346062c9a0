"""Forces of a solved lattice: Kutta-Joukowski on every loaded filament, strips, panels, Trefftz plane."""

from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
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


def axis_moments(
    loads: StripLoads, through: Float[Array, "*s 3"], direction: Float[Array, "*s 3"]
) -> Float[Array, " s"]:
    """Moments of the strips about given axes: ``[M + (r - r0) x F] . e``, such as elastic axis or hinge line.

    Args:
        loads: forces, and moments about the quarter-chord points r.
        through: a point r0 of each strip's axis, or one for all, m.
        direction: of each axis, or of all, of any length; the moment is positive about it.

    Returns:
        Moments over dynamic pressure, m^3.
    """
    unit = direction / jnp.linalg.norm(direction, axis=-1, keepdims=True)
    return jnp.sum((loads.moment + jnp.cross(loads.point - through, loads.force)) * unit, axis=-1)


def panel_pressure(
    plan: Layout, forces: Float[Array, "e 3"], cells: Sequence[Float[Array, "_ _ 3"]]
) -> Float[Array, " n"]:
    """Pressure below less above on the bound line of each panel over dynamic pressure, for pictures.

    ``dCp = F . n / A``: to a panel belong its bound filament and half of the chordwise filaments on either side that
    begin on it, so that the panels of a strip carry its load; no profile drag. The load of a bound filament is that
    between the conditions ahead of it and behind it (a ring's circulation is that of the sheet down to its
    condition), the first one's that from the leading edge on: A is that area, not the panel's.

    Source: force over area as Katz & Plotkin, Low-Speed Aerodynamics 2e, section 12.3; the area: Lan, A
    Quasi-Vortex-Lattice Method in Thin Wing Theory, J. Aircraft 11, 1974, where strengths are exact halfway between
    conditions in the law's parameter.

    Args:
        plan: layout.
        forces: on the filaments, see `filament_forces`.
        cells: corner points of these areas on each surface, m, see `pressure_cells`.

    Returns:
        Pressure differences of all panels, in the order of the unknowns.
    """
    inner, outer = _panels_of(plan)
    part = plan.share[:, None] * forces
    force = jnp.zeros((sum(plan.counts), 3)).at[inner].add(part).at[outer].add(forces - part)
    areas = [jnp.cross(m[1:, 1:] - m[:-1, :-1], m[:-1, 1:] - m[1:, :-1]).reshape(-1, 3) / 2 for m in cells]
    area = jnp.concatenate(areas)
    return jnp.sum(force * area, axis=-1) / jnp.sum(area**2, axis=-1)


def pressure_cells(mesh: Float[Array, "nc1 ns1 3"], rear: Float[Array, " nc"] | np.ndarray) -> Array:
    """Leading edge and lines through the conditions of a surface, m [nc + 1, ns + 1, 3].

    Args:
        mesh: corner points of the panels, m, see `geometry.surface_mesh`.
        rear: where in its panel the condition stands, see `geometry.Grid`.

    Returns:
        Corner points of the areas whose load `panel_pressure` spreads.
    """
    return jnp.concatenate([mesh[:1], mesh[:-1] + jnp.asarray(rear)[:, None, None] * (mesh[1:] - mesh[:-1])])


def _panels_of(plan: Layout) -> tuple[np.ndarray, np.ndarray]:
    """Panels that each get a part of a filament's load, in the way of ``Layout.inner`` and ``Layout.outer``."""
    parts, start = [], 0
    for count, ns in zip(plan.counts, plan.strips, strict=True):
        ring = start + np.arange(count).reshape(-1, ns)
        ends = np.hstack([ring[:, :1], ring]), np.hstack([ring, ring[:, -1:]])
        parts.append([np.concatenate([ring.ravel(), edge.ravel()]) for edge in ends])
        start += count
    inner, outer = (np.concatenate(side) for side in zip(*parts, strict=True))
    return inner, outer


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
