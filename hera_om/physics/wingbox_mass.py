"""Mass, centre and inertia of the primary structure."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.wing_build_up import BoxShares
from hera_om.physics.wingbox_types import BoxMass, BoxModel


def _per_length(model: BoxModel, t: Float[Array, "4 n"], t_rib: Float[Array, "n"]) -> Float[Array, "5 n"]:
    """Mass per length of one half wing, kg/m: skins, webs, caps, stringers, ribs."""
    shape, members = model.shape, model.members
    areas = [
        shape.arc[0] * t[0] + shape.arc[1] * t[1],
        shape.h_front * t[2] + shape.h_rear * t[3],
        4.0 * members.A_cap,
        2.0 * members.n_stringer * members.A_stringer,
        shape.enclosed * t_rib / model.concept.rib_pitch,
    ]
    return model.material.rho * jnp.stack(areas)


def _lengths(points: Float[Array, "n 3"]) -> Float[Array, "n"]:
    """Length of the box that each station stands for, m: the trapezoidal rule."""
    step = jnp.sqrt(jnp.sum(jnp.square(jnp.diff(points, axis=0)), axis=1))
    return 0.5 * (jnp.pad(step, (1, 0)) + jnp.pad(step, (0, 1)))


def box_shares(model: BoxModel, points: Float[Array, "n 3"], t: Float[Array, "4 n"]) -> BoxShares:
    """Surface, webs and lower panels of both half wings with the centre section; arguments as `box_mass`."""
    shape, members = model.shape, model.members
    arc, heights = shape.arc[0] + shape.arc[1], shape.h_front + shape.h_rear
    webs = model.material.rho * (shape.h_front * t[2] + shape.h_rear * t[3])
    lower = model.material.rho * (shape.arc[1] * t[1] + members.n_stringer * members.A_stringer)
    per_length = jnp.stack([arc + heights, webs, lower])
    return BoxShares(*(2.0 * (per_length @ _lengths(points) + per_length[:, 0] * points[0, 1])))


def box_mass(
    model: BoxModel, points: Float[Array, "n 3"], t: Float[Array, "4 n"], t_rib: Float[Array, "n"]
) -> tuple[BoxMass, Float[Array, "3"], Float[Array, "3"]]:
    """Mass of both half wings by part, the centre of one half, the inertia of both.

    m = 2 int rho A ds by the trapezoidal rule along the box; ribs are smeared over their pitch. The centre
    section goes on from the first station to the plane of symmetry, with the section of the first station.

    Args:
        model: the box.
        points: centre of the box at the stations, m [n, 3].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].
        t_rib: thickness of the ribs, m [n].

    Returns:
        Mass parts, kg, the centre of one half including its share of the centre section, m, and the moments of
        inertia of both about x, y, z through their common centre, kg m2, of masses that stand at the points.
    """
    per_length = _per_length(model, t, t_rib)
    lengths = _lengths(points)
    half = per_length @ lengths
    inboard = points[0, 1]
    centre = jnp.sum(per_length[:, 0]) * inboard
    masses = jnp.append(jnp.sum(per_length, axis=0) * lengths, centre)
    places = jnp.concatenate([points, points[:1] * jnp.array([1.0, 0.5, 1.0])])
    cg = masses @ places / jnp.sum(masses)
    square = masses @ jnp.square(places - cg * jnp.array([1.0, 0.0, 1.0])) + centre * jnp.array([0, inboard**2 / 12, 0])
    inertia = 2.0 * (jnp.sum(square) - square)
    skins, webs, caps, stringers, ribs = 2.0 * half
    return BoxMass(skins, webs, caps, stringers, ribs, 2.0 * centre), cg, inertia
