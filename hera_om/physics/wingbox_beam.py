"""The sized wing as a beam: stiffness from its sections, mass from the loads of its weight."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.beam import BeamProperties
from hera_om.physics.beam_loads import STANDARD_GRAVITY, Loads
from hera_om.physics.box_section import Section
from hera_om.physics.wingbox_types import BoxGeometry, Material, elastic_axis

# Radius of gyration of a section's mass about its own centre over the chord: spread evenly over the chord.
GYRATION = 12.0**-0.5
LEAST_MASS = 0.1  # kg/m: a wing whose weight is left out still has frequencies


def wing_beam(geometry: BoxGeometry, material: Material, section: Section, weight: Loads) -> BeamProperties:
    """Beam along the elastic axis, clamped at the fuselage joint.

    EI = E (I_xx - I_xz^2 / I_zz), bending up with the tip free to move aft (Megson, eq. 16.18), of the turned section:
    the numerator over I_zz, I_xx I_zz - I_xz^2, stays, and I_zz turns as a tensor does; GJ = G J. Mass and
    its offset per length follow from the section loads of the weight at 1 g: -dV/ds = m g, -dT/ds = -m g e.

    Args:
        geometry: wing at n stations.
        material: moduli.
        section: properties of the box [n].
        weight: section loads of everything that the wing carries, at load factor 1.

    Returns:
        The beam; its mass is averaged over the neighbouring bays of a station, so concentrated masses are spread.
    """
    axis = elastic_axis(geometry)
    step = jnp.linalg.norm(jnp.diff(axis, axis=0), axis=1)
    per_bay = jnp.diff(weight.V) / (STANDARD_GRAVITY * step)
    turning = jnp.diff(weight.T) / (STANDARD_GRAVITY * step)

    def at_stations(bays: Float[Array, "e"]) -> Float[Array, "n"]:
        share = step / (jnp.pad(step, (1, 0)) + jnp.pad(step, (0, 1)))[:-1]
        inner = share[1:] * bays[1:] + (1.0 - share[1:]) * bays[:-1]
        return jnp.concatenate([bays[:1], inner, bays[-1:]])

    mass = jnp.maximum(at_stations(per_bay), LEAST_MASS)
    moment = -at_stations(turning)
    inertia = jnp.square(moment) / mass + mass * jnp.square(GYRATION * geometry.chord)
    c, turn = jnp.cos(geometry.incidence), jnp.sin(geometry.incidence)
    I_zz = section.I_zz * c**2 + 2.0 * section.I_xz * turn * c + section.I_xx * turn**2
    return BeamProperties(
        s=jnp.concatenate([jnp.zeros(1), jnp.cumsum(step)]),
        EI=material.E * (section.I_xx * section.I_zz - jnp.square(section.I_xz)) / I_zz,
        GJ=material.G * section.torsion_constant,
        mass=mass,
        static_moment=moment,
        inertia=inertia,
    )
