"""From a definition to the mass of the wing: the build-up beside the box, and the rule that adds it up."""

from typing import Any, NamedTuple

import jax.numpy as jnp

from hera_om.aircraft.rotors import hub_ys
from hera_om.components import arrays
from hera_om.components.box_arrays import SIDES, pods
from hera_om.physics.atmosphere import isa
from hera_om.physics.load_cases import landing_factor
from hera_om.physics.wing_build_up import (
    Flaps,
    Penalties,
    Secondary,
    SecondaryAreas,
    WingFacts,
    box_penalties,
    chord_integral,
    secondary_structure,
    total,
)
from hera_om.physics.wingbox_mass import box_shares
from hera_om.physics.wingbox_types import BoxGeometry, BoxModel, BoxResult

READS = ("wing.control", "mission.V_D_EAS_m_s")
OUTER_SHARE = 0.7  # of the semispan: where a wing without ailerons is looked at for its stiffness


class WingMass(NamedTuple):
    """Mass of the wing without its remainder, kg, and the build-up, whether or not the rule takes it."""

    m_wing: Any
    m_penalties: Any
    m_secondary: Any
    penalties: Penalties
    secondary: Secondary


def wing_facts(aircraft, geometry: BoxGeometry, inputs) -> WingFacts:
    """What the build-up needs beside the box."""
    mission, s = aircraft.mission, arrays.wing_arrays(aircraft)
    place, chord = geometry.leading_edge, geometry.chord
    step = jnp.diff(place + jnp.array([0.35, 0.0, 0.0]) * chord[:, None], axis=0)
    length = 2.0 * (place[0, 1] + jnp.sum(jnp.sqrt(jnp.sum(jnp.square(step), axis=1))))
    reach = place[-1, 1] - place[0, 1]
    lead = (place[-1, 0] - place[0, 0]) / reach
    half = lead + 0.5 * (chord[-1] - chord[0]) / reach
    sea, air = isa(0.0), isa(aircraft.flight.altitude_m)
    aileron = aircraft.wing.control.aileron
    outer = OUTER_SHARE * s.y[-1] if aileron is None else aileron.y0_m
    ratio = jnp.interp(outer, place[:, 1], geometry.thickness_ratio)
    hung = pods(aircraft)
    landing = inputs["mass"] if mission.landing_mass_kg is None else mission.landing_mass_kg
    on_wing = aircraft.wing.structure.gear_on_wing
    return WingFacts(
        take_off=inputs["mass"],
        landing=landing,
        power_plants=jnp.asarray(sum(item.m_kg for item in hung), float),
        engines=float(SIDES * sum(len(hub_ys(g)) for g in aircraft.rotor)),
        span=length,
        area=SIDES * chord_integral(s.y, s.chord, s.y[0], s.y[-1]),
        ultimate_factor=mission.limit_load_factor * mission.reserve_factor,
        gear_factor=mission.reserve_factor * landing_factor(mission.gear_stroke_m) if on_wing else 0.0,
        q_D=0.5 * sea.density * mission.V_D_EAS_m_s**2,
        mach_D=mission.V_D_EAS_m_s * jnp.sqrt(sea.density / air.density) / air.sound_speed,
        thickness=ratio,
        cos_leading=1.0 / jnp.sqrt(1.0 + lead**2),
        sin_half=half / jnp.sqrt(1.0 + half**2),
    )


def secondary_areas(aircraft) -> SecondaryAreas:
    """Projected areas of the exposed wing ahead of and behind the box, both sides."""
    wing, s = aircraft.wing, arrays.wing_arrays(aircraft)
    box, flap, aileron = wing.structure, wing.control.flap, wing.control.aileron

    def strip(inner, outer):
        return SIDES * chord_integral(s.y, s.chord, inner, outer)

    exposed = strip(wing.fuselage_joint_y_m, s.y[-1])
    along = jnp.zeros(()) if flap is None else strip(flap.y0_m, flap.y1_m)
    flaps = 0.0 if flap is None else (1.0 - flap.hinge) * along
    ailerons = 0.0 if aileron is None else (1.0 - aileron.hinge) * strip(aileron.y0_m, aileron.y1_m)
    behind = 1.0 - box.rear_spar
    above = behind * along - flaps
    return SecondaryAreas(box.front_spar * exposed, behind * exposed - flaps - ailerons, above, flaps, ailerons)


def wing_mass(aircraft, model: BoxModel, points, box: BoxResult, facts: WingFacts) -> WingMass:
    """Mass of the wing by the definition's rule, without the remainder.

    Primary structure / primary_fraction where the definition gives that share, else the build-up.
    """
    structure, primary = aircraft.wing.structure, box.m_primary
    t = jnp.stack([box.t_skin_upper, box.t_skin_lower, box.t_web_front, box.t_web_rear])
    penalties = box_penalties(facts, box_shares(model, points, t), model.material.rho)
    flaps = Flaps(structure.flap_slots, structure.flap_support)
    secondary = secondary_structure(facts, secondary_areas(aircraft), flaps)
    if structure.primary_fraction is not None:
        whole = primary / structure.primary_fraction
        return WingMass(whole, jnp.zeros(()), whole - primary, penalties, secondary)
    more, beside = total(penalties), total(secondary)
    return WingMass(primary + more + beside, more, beside, penalties, secondary)
