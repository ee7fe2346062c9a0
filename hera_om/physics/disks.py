"""Rotors of an aircraft as a set: their disks in the flow, their loads, their slipstreams at any point."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Flow, RotorPlan, Rotors
from hera_om.physics.lattice import MIRROR
from hera_om.physics.rotor import Blade, RotorSolution, blade_elements, element_points, solve_rotor
from hera_om.physics.slipstream import slipstream_velocity

EDGE_WIDTH = 0.1
"""Width of the slipstream's edge over the rotor radius: the shear layer of a propeller jet half a diameter
to a diameter behind its disk (choice; see the limits of `slipstream`)."""


GAUSS_POINTS = (-0.5 * 0.6**0.5, 0.0, 0.5 * 0.6**0.5)
GAUSS_WEIGHTS = (5 / 18, 8 / 18, 5 / 18)


class Wake(NamedTuple):
    """What a slipstream is made of: mean induced velocities at the disk over the flight speed."""

    axial: Float[Array, "m nr"]
    swirl: Float[Array, "m nr"]


def shaft_axes(incidence: Float[Array, " m"]) -> Float[Array, "m 3 3"]:
    """Unit vectors of the shaft axes (x aft along the shaft, y, z) as rows, in geometry axes."""
    c, s, zero = jnp.cos(incidence), jnp.sin(incidence), jnp.zeros_like(incidence)
    rows = [[c, zero, -s], [zero, zero + 1.0, zero], [s, zero, c]]
    return jnp.stack([jnp.stack(row, axis=-1) for row in rows], axis=-2)


def blades(rotors: Rotors, plan: RotorPlan) -> Blade:
    """Blade elements of every rotor, leading axis m."""

    def one(radius, hub_radius, r, chord, twist, polar):
        return blade_elements(radius, hub_radius, r, chord, twist, polar=polar, n=plan.radial)

    return jax.vmap(one)(rotors.radius, rotors.hub_radius, rotors.r, rotors.chord, rotors.twist, rotors.polar)


def disk_points(rotors: Rotors, plan: RotorPlan) -> Float[Array, "m nr npsi 3"]:
    """Points of all blade elements in geometry axes, m."""
    local = jax.vmap(lambda b: element_points(b.r, plan.azimuthal))(blades(rotors, plan))
    return rotors.hub[:, None, None, :] + jnp.einsum("mrpi,mij->mrpj", local, shaft_axes(rotors.incidence))


def rotor_loads(
    rotors: Rotors,
    plan: RotorPlan,
    velocity: Float[Array, "m nr npsi 3"],
    *,
    pitch: Float[Array, " g"],
    flow: Flow,
    phi=None,
) -> RotorSolution:
    """Every rotor in the given stream (geometry axes, m/s); forces and moments in geometry axes too.

    ``phi``, the inflow angles if they are known already, saves the search for them.
    """
    axes = shaft_axes(rotors.incidence)
    local = jnp.einsum("mij,mrpj->mrpi", axes, velocity)

    def one(blade, stream, angle, rotor, known):
        return solve_rotor(
            blade,
            stream,
            pitch=angle,
            omega=rotor.omega,
            radius=rotor.radius,
            hub_radius=rotor.hub_radius,
            n_blades=rotor.blades,
            density=flow.density,
            sound_speed=flow.sound_speed,
            sense=rotor.sense,
            tip_loss=plan.tip_loss,
            hub_loss=plan.hub_loss,
            phi=known,
        )

    out = jax.vmap(one)(blades(rotors, plan), local, pitch[jnp.asarray(plan.groups)], rotors, phi)
    force, moment = (jnp.einsum("mi,mij->mj", v, axes) for v in (out.force, out.moment))
    return out._replace(force=force, moment=moment)


def mean_slipstreams(
    rotors: Rotors, plan: RotorPlan, wake: Wake, middles: Float[Array, "p 3"], spans: Float[Array, "p 3"]
) -> Float[Array, "p 3"]:
    """`slipstreams` averaged along segments given by middles and vectors, by Gauss's rule with three points.

    A strip is as wide as a good part of a disk. Sampled at one point, what a slipstream does to it would
    jump as edges of disks pass that point: noise of two drag counts on 32 strips, which an optimiser exploits.
    """
    at = jnp.concatenate([middles + t * spans for t in GAUSS_POINTS])
    each = slipstreams(rotors, plan, wake, at).reshape(len(GAUSS_POINTS), *middles.shape)
    return jnp.tensordot(jnp.asarray(GAUSS_WEIGHTS), each, axes=1)


def slipstreams(rotors: Rotors, plan: RotorPlan, wake: Wake, points: Float[Array, "p 3"]) -> Float[Array, "p 3"]:
    """Velocity over the flight speed that all slipstreams, mirrored ones included, add at ``points``."""
    r = blades(rotors, plan).r
    axes = shaft_axes(rotors.incidence)[:, 0]

    def one(at, hub, axis, radius, r, axial, swirl, sense):
        return slipstream_velocity(
            at,
            hub=hub,
            axis=axis,
            radius=radius,
            r=r,
            v_axial=axial,
            v_swirl=swirl,
            sense=sense,
            speed=1.0,
            edge_width=EDGE_WIDTH * radius,
        )

    mirror = jnp.asarray(MIRROR)
    both = points if plan.sides == 1 else jnp.concatenate([points, points * mirror])
    each = jax.vmap(one, in_axes=(None, 0, 0, 0, 0, 0, 0, 0))
    field = jnp.sum(each(both, rotors.hub, axes, rotors.radius, r, wake.axial, wake.swirl, rotors.sense), axis=0)
    n = points.shape[0]
    return field if plan.sides == 1 else field[:n] + field[n:] * mirror
