"""What goes into and comes out of the wing box, and its stations along the span."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from hera_om.physics.box_contour import BoxShape
from hera_om.physics.box_section import BoxMembers, Section
from hera_om.physics.laminate import Laminate, Ply, make_laminate, moduli, strength

ScalarLike = Float[Array, ""] | float | int

PANELS = ("upper skin", "lower skin", "front web", "rear web")
CRITERIA = ("von Mises", "buckling", "crushing", "minimum gauge")


class Material(NamedTuple):
    """Material of all parts: moduli and strengths in Pa, density in kg/m3; isotropic without a laminate.

    Axis x of a laminate runs along the span in covers, webs and members, upright in ribs.
    """

    E: ScalarLike
    G: ScalarLike
    nu: ScalarLike
    rho: ScalarLike
    F_ty: ScalarLike
    F_cy: ScalarLike
    F_tu: ScalarLike
    F_su: ScalarLike
    laminate: Laminate | None = None


class BoxConcept(NamedTuple):
    """Concept of the box: spars as chord fractions, pitches and sheet limits in m, reserve factor."""

    front_spar: ScalarLike
    rear_spar: ScalarLike
    rib_pitch: ScalarLike
    stringer_pitch: ScalarLike
    t_min: ScalarLike
    t_max: ScalarLike = 0.050
    reserve: ScalarLike = 1.5


class BoxGeometry(NamedTuple):
    """Wing at n stations from the fuselage joint to the tip.

    ``axis_fraction`` is the chord fraction of the axis about which the torque is given, on the chord line; 0.35 is
    near the shear centre of a box between 0.15 and 0.62. ``tables`` are the contours, `core.contours.contour_table`
    of each station; absent: the symmetric NACA form. ``incidence``, rad, turns the sections nose-up about that axis.
    """

    leading_edge: Float[Array, "n 3"]
    chord: Float[Array, "n"]
    thickness_ratio: Float[Array, "n"]
    axis_fraction: ScalarLike = 0.35
    tables: Float[Array, "n 4 p"] | None = None
    incidence: Float[Array, "n"] | ScalarLike = 0.0


class BoxLoads(NamedTuple):
    """LIMIT section loads by case: shear up, bending tip-up, torque nose-up about the axis; force aft, bending
    tip-forward; N and N m.
    """

    V: Float[Array, "case n"]
    M: Float[Array, "case n"]
    T: Float[Array, "case n"]
    H: Float[Array, "case n"]
    Mz: Float[Array, "case n"]


class CriticalStress(NamedTuple):
    """Elastic critical stress at unit thickness, Pa/m2: it grows with the square of the thickness."""

    cover_compression: Float[Array, ""]
    cover_shear: Float[Array, ""]
    web_bending: Float[Array, "2 1 n"]
    web_shear: Float[Array, "2 1 n"]
    rib: Float[Array, "n"]


class BoxModel(NamedTuple):
    """Everything fixed while the thicknesses are sought."""

    shape: BoxShape
    members: BoxMembers
    material: Material
    concept: BoxConcept
    loads: BoxLoads
    critical: CriticalStress
    x_axis: Float[Array, "n"]
    """Axis of the torque aft of the leading edge, m."""


class BoxMass(NamedTuple):
    """Mass in kg of both half wings by part; the centre section has the first station's sheets."""

    skins: Float[Array, ""]
    webs: Float[Array, ""]
    caps: Float[Array, ""]
    stringers: Float[Array, ""]
    ribs: Float[Array, ""]
    centre_section: Float[Array, ""]


class Reserves(NamedTuple):
    """Reserve factors of caps and stringers, allowable over LIMIT stress: over the span and smooth minima."""

    RFT_span: Float[Array, "n"]
    RFC_span: Float[Array, "n"]
    RFT: Float[Array, ""]
    RFC: Float[Array, ""]
    RF_yield: Float[Array, ""]
    """Yield at limit load, tension and compression: required 1.0."""


class BoxResult(NamedTuple):
    """A sized box. Thickness in m and stress in Pa at n stations, mass in kg of both half wings."""

    t_skin_upper: Float[Array, "n"]
    t_skin_lower: Float[Array, "n"]
    t_web_front: Float[Array, "n"]
    t_web_rear: Float[Array, "n"]
    t_rib: Float[Array, "n"]
    stress: Float[Array, "4 point case n"]
    """Direct stress of the panels, front to rear and bottom to top, tension positive."""
    use: Float[Array, "4 4 n"]
    """Utilisation by panel and criterion, required reserve over reserve; 1 where it sizes."""
    active: Int[Array, "4 n"]
    """Which of ``CRITERIA`` sizes each of ``PANELS``; not differentiated."""
    sizing_case: Int[Array, "4 n"]
    """Which load case asks most of each panel, minimum gauge apart; not differentiated."""
    worst_excess: Float[Array, "n"]
    """Largest utilisation less one: above 1e-6 no allowed thickness carries the load."""
    RFT_span: Float[Array, "n"]
    RFC_span: Float[Array, "n"]
    RFT: Float[Array, ""]
    RFC: Float[Array, ""]
    RF_yield: Float[Array, ""]
    section: Section
    x_shear_centre: Float[Array, "n"]
    """Aft of the leading edge, m."""
    mass: BoxMass
    m_primary: Float[Array, ""]
    cg: Float[Array, "3"]
    """Centre of the primary structure of one half wing, geometry axes, m."""
    inertia: Float[Array, "3"]
    """Moments of inertia of both half wings about x, y, z through their common centre, kg m2."""


def elastic_axis(geometry: BoxGeometry) -> Float[Array, "n 3"]:
    """Points of the axis about which the section loads are wanted, m; twist does not move them."""
    return _at_fraction(geometry, geometry.axis_fraction)


def box_centre(geometry: BoxGeometry, concept: BoxConcept) -> Float[Array, "n 3"]:
    """Points midway between the spars, m."""
    return _at_fraction(geometry, 0.5 * (concept.front_spar + concept.rear_spar))


def _at_fraction(geometry: BoxGeometry, fraction: ScalarLike) -> Float[Array, "n 3"]:
    """Leading edge moved aft by a fraction of the chord."""
    return geometry.leading_edge.at[:, 0].add(fraction * geometry.chord)


def on_sections(loads: BoxLoads, incidence: Float[Array, "n"] | ScalarLike) -> BoxLoads:
    """Loads on the axes of sections turned nose-up, from those on geometry axes: forces and moments turn back alike."""
    c, s = jnp.cos(incidence), jnp.sin(incidence)
    up, aft = loads.V * c + loads.H * s, loads.H * c - loads.V * s
    return BoxLoads(up, loads.M * c - loads.Mz * s, loads.T, aft, loads.Mz * c + loads.M * s)


def stack_cases(*cases) -> BoxLoads:
    """Loads of several cases (anything with V, M, T of shape [n]) as one structure."""
    return BoxLoads(*(jnp.stack([getattr(case, name) for case in cases]) for name in BoxLoads._fields))


def laminated(ply: Ply, angles: np.ndarray, density: ScalarLike) -> Material:
    """Material of equivalent stiffness of a laminate; its strengths are those at which the first ply fails.

    Args:
        ply: elastic constants and strengths.
        angles: of the plies from a face to the middle plane, rad [k].
        density: kg/m3.
    """
    made = make_laminate(ply, angles)
    along, _, shear, poisson = moduli(made)
    tension, compression = (strength(made, sign * np.array([1.0, 0.0, 0.0])) for sign in (1.0, -1.0))
    sheared = jnp.minimum(*(strength(made, sign * np.array([0.0, 0.0, 1.0])) for sign in (1.0, -1.0)))
    return Material(along, shear, poisson, density, tension, compression, tension, sheared, made)


def strength_across(material: Material) -> ScalarLike:
    """Strength in bending across the stringers, Pa: F_cy, or the weaker sign along y of a laminate."""
    if material.laminate is None:
        return material.F_cy
    return jnp.minimum(*(strength(material.laminate, sign * np.array([0.0, 1.0, 0.0])) for sign in (1.0, -1.0)))
