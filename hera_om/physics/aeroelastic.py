"""Static aeroelasticity of a wing: its loads turn its strips, and turned strips change its loads.

Both are linear, S = lift of strips by incidence of strips and G = incidence by lift, so a case needs one small solve,
(1 - S G) dL = S a, with a the incidence that its loads would give the wing if the lift did not answer.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.beam import BeamProperties, deflection
from hera_om.physics.beam_loads import Loads, axis_frame, section_loads, strip_load
from hera_om.physics.lattice import Lattice, solve
from hera_om.physics.lattice_forces import filament_forces, filament_strengths, strip_loads
from hera_om.physics.layout import Layout


class FlexibleWing(NamedTuple):
    """A wing that bends and twists: beam and axis at n stations, k strips."""

    beam: BeamProperties
    axis: Float[Array, "n 3"]
    edges: Float[Array, "edge"]
    """y of the edges of the strips, m."""
    points: Float[Array, "k 3"]
    """Where the lift that is due to incidence acts: quarter-chord points, m."""


def lift_by_twist(lattice: Lattice, lay: Layout, wind: Float[Array, "3"], count: int) -> Float[Array, "k k"]:
    """Lift of each strip of the first surface by the incidence of each, over dynamic pressure, m^2/rad.

    Twist turns the normals of a strip, the factorised system answers with circulations, and Kutta and Joukowski's
    force is that of the free stream: the linear part of the lattice, all other surfaces standing still in it.

    Args:
        lattice: assembled lattice.
        lay: index arrays of its panels.
        wind: direction of the free stream.
        count: strips of the first surface.

    Returns:
        [loaded strip, turned strip]. Left out: higher dynamic pressure in slipstreams, forces in the plane.
    """
    panels = lay.counts[0]
    up = -(jnp.cross(jnp.array([0.0, 1.0, 0.0]), lattice.normal[:panels]) @ wind)
    strip = jnp.arange(panels) % count

    def one(turned: Array) -> Float[Array, "k"]:
        needed = jnp.zeros(lattice.normal.shape[0]).at[:panels].set(jnp.where(strip == turned, up, 0.0))
        strength = filament_strengths(lay, solve(lattice.even, needed))
        velocity = jnp.broadcast_to(wind, lattice.arms.shape)
        return strip_loads(lattice, lay, filament_forces(lattice, strength, velocity)).force[:count, 2]

    return jax.vmap(one, out_axes=1)(jnp.arange(count))


def at_constant_lift(slope: Float[Array, "k k"]) -> Float[Array, "k k"]:
    """The same with the wing turned back as a whole, so that its lift stays: the aircraft is trimmed."""
    whole = jnp.sum(slope, axis=1)
    total = jnp.sum(whole)
    return slope - whole[:, None] * jnp.sum(slope, axis=0) / jnp.where(total == 0.0, 1.0, total)


def strip_incidence(wing: FlexibleWing, loads: Loads) -> Float[Array, "k"]:
    """Incidence of the strips in the stream under section loads, rad: theta cos(sweep) - w' sin(sweep).

    Bisplinghoff, Ashley & Halfman, Aeroelasticity, ch. 8: bending up takes incidence off a wing that is swept back.

    Args:
        wing: the beam and its strips.
        loads: section loads at the stations of the beam.

    Returns:
        Incidence at the middles of the strips, none inboard of the first station.
    """
    bent = deflection(wing.beam, shear=loads.V, bending=loads.M, torque=loads.T)
    along = axis_frame(wing.axis)[1]
    middle = 0.5 * (wing.edges[1:] + wing.edges[:-1])
    return jnp.interp(middle, wing.axis[:, 1], bent.twist * along[:, 1] - bent.slope * along[:, 0])


def unit_lifts(wing: FlexibleWing) -> Loads:
    """Section loads [strip, station] of 1 N upwards on each strip."""
    up = jnp.array([0.0, 0.0, 1.0])

    def one(force: Float[Array, "k"]) -> Loads:
        forces = force[:, None] * up
        load = strip_load(wing.edges, wing.points, forces=forces, moments=jnp.zeros_like(forces))
        return section_loads(wing.axis[:, 1], wing.axis, load)

    return jax.vmap(one)(jnp.eye(wing.points.shape[0]))


def flexibility(wing: FlexibleWing) -> Float[Array, "k k"]:
    """Incidence of each strip by the lift of each, rad/N."""
    return jax.vmap(lambda loads: strip_incidence(wing, loads), out_axes=1)(unit_lifts(wing))


def elastic_loads(wing: FlexibleWing, slope: Float[Array, "k k"], cases: Loads, reference: Loads) -> Loads:
    """What bending and twist add to the section loads of cases, over the shape that the wing has under others.

    Args:
        wing: the beam and its strips.
        slope: lift of each strip by the incidence of each, N/rad.
        cases: section loads [case, n] of the wing with its reference shape.
        reference: section loads [n] under which it has that shape.

    Returns:
        Section loads [case, n]; to be added. Valid below divergence, see `divergence_ratio`.
    """
    more = Loads(*(c - r for c, r in zip(cases, reference, strict=True)))
    rigid = jax.vmap(lambda loads: strip_incidence(wing, loads))(more)
    lift = jnp.linalg.solve(jnp.eye(len(slope)) - slope @ flexibility(wing), slope @ rigid.T)
    return Loads(*(lift.T @ unit for unit in unit_lifts(wing)))


def divergence_ratio(turning: np.ndarray) -> float:
    """Dynamic pressure of divergence over that of S: one over the largest real eigenvalue of S G; inf without any.

    Args:
        turning: S G of the wing that is clamped at its root, lift not held [k, k].
    """
    values = np.linalg.eigvals(turning)
    real = values.real[(np.abs(values.imag) < 1e-9 * np.abs(values)) & (values.real > 1e-12)]
    return 1.0 / float(np.max(real)) if real.size else float("inf")
