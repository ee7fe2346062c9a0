"""From a definition to the arrays of the wing box; traced numbers pass through."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.lifting_surfaces import lifting_surfaces
from hera_om.aircraft.rotors import hub_ys
from hera_om.aircraft.structure import Laminate
from hera_om.components import arrays
from hera_om.components.mass import ROTOR
from hera_om.core.contours import contour_table
from hera_om.physics.beam_loads import SpanMass, point_mass, spread_mass
from hera_om.physics.geometry import span_weights
from hera_om.physics.laminate import Ply
from hera_om.physics.wingbox_types import BoxConcept, BoxGeometry, Material, laminated

TANK_STRIPS = 12
SIDES = 2
SECTION_KEYS = ("y_m", "chord_m", "thickness", "twist_deg", "sweep_quarter_deg", "dihedral_deg", "x_le_m", "z_m")
WING_KEYS = ("x_le_root_m", "z_root_m", "incidence_deg", "fuselage_joint_y_m", "fuel_tank", "structure")
MISSION_KEYS = (
    "limit_load_factor",
    "reserve_factor",
    "V_C_EAS_m_s",
    "landing_mass_kg",
    "ceiling_m",
    "gear_stroke_m",
)
ROTOR_KEYS = ("polar_inertia_kgm2", "rpm")


def box_reads(aircraft) -> tuple[str, ...]:
    """Paths that the box depends on."""
    wing = aircraft.wing
    paths = [f"wing.{key}" for key in WING_KEYS] + [f"mission.{key}" for key in MISSION_KEYS]
    paths += [f"wing.section.{s.name}.{key}" for s in wing.section for key in SECTION_KEYS]
    paths += [f"rotor.{r.name}.{key}" for r in aircraft.rotor for key in ROTOR_KEYS]
    paths += [f"{kind}.{wing.structure.material}" for kind in ("material", "laminate")] + ["flight.altitude_m"]
    paths += [f"mass.{i.name}.m_kg" for i in _fuel(aircraft)]
    for item in pods(aircraft):
        paths += [f"mass.{item.name}.{key}" for key in ("m_kg", "x_m", "z_m")]
        paths += [f"rotor.{item.tracks.removeprefix(ROTOR)}.{key}" for key in ("y_m", "spacing_m")]
    return tuple(paths)


def box_weights(aircraft) -> np.ndarray:
    """Weights [n, k] of the stations by the joint and the sections outboard of it, cut at the baseline.

    Stations keep their shares when sections move, and the sections are always among them: what depends on a
    kink is then smooth in its position.
    """
    joint = aircraft.wing.fuselage_joint_y_m
    breaks = [joint, *(s.y_m for s in aircraft.wing.section if s.y_m > joint)]
    return span_weights(breaks, aircraft.lattice.box_stations - 1, 0.0)[0]


def box_tables(aircraft, weights: np.ndarray) -> np.ndarray:
    """Contours of the stations [n, 4, p], blended between the sections as their chords are."""
    wing = lifting_surfaces(aircraft)[0]
    tables = np.stack([contour_table(a) for a in wing.airfoils])
    y, joint = np.asarray(wing.y, float), aircraft.wing.fuselage_joint_y_m
    at_joint = np.stack([np.interp(joint, y, row) for row in tables.reshape(len(y), -1).T]).reshape(
        1, *tables.shape[1:]
    )
    outboard = tables[len(tables) - weights.shape[1] + 1 :]
    return np.tensordot(weights, np.concatenate([at_joint, outboard]), axes=1)


def box_geometry(aircraft, weights, tables) -> BoxGeometry:
    """Wing at the stations."""
    s, joint, outboard = arrays.wing_arrays(aircraft), aircraft.wing.fuselage_joint_y_m, weights.shape[1] - 1

    def stations(values):
        return weights @ jnp.append(jnp.interp(joint, s.y, values), values[-outboard:])

    place = jnp.stack([stations(s.x_le), stations(s.y), stations(s.z)], axis=1)
    ratio = stations(_thickness_ratio(aircraft))
    return BoxGeometry(place, stations(s.chord), ratio, tables=tables, incidence=stations(s.twist))


def box_material(aircraft) -> Material:
    """Material of the box."""
    m = aircraft.wing_material()
    if isinstance(m, Laminate):
        ply = Ply(m.E1_Pa, m.E2_Pa, m.G12_Pa, m.nu12, m.Xt_Pa, m.Xc_Pa, m.Yt_Pa, m.Yc_Pa, m.S_Pa)
        return laminated(ply, np.radians(m.angles_deg), m.rho_kg_m3)
    return Material(m.E_Pa, m.G_Pa, m.nu, m.rho_kg_m3, m.Fty_Pa, m.Fcy_Pa, m.Ftu_Pa, m.Fsu_Pa)


def box_concept(aircraft) -> BoxConcept:
    """Spars, pitches, least gauge and required reserve factor."""
    b = aircraft.wing.structure
    return BoxConcept(
        front_spar=b.front_spar,
        rear_spar=b.rear_spar,
        rib_pitch=b.rib_pitch_m,
        stringer_pitch=b.stringer_pitch_m,
        t_min=b.t_min_skin_m,
        reserve=aircraft.mission.reserve_factor,
    )


class Carried(NamedTuple):
    """What the starboard wing carries; without fuel in the wing there is none of it."""

    structure: SpanMass
    fuel: tuple[SpanMass, ...]
    motors: tuple[SpanMass, ...]


def carried_masses(aircraft, edges, wing_mass) -> Carried:
    """What the starboard wing carries: structure, its half of the fuel at take-off, motors at the rotors.

    Structure and fuel are spread in proportion to chord times thickness, between the spars. An item that
    tracks a rotor group stands in equal parts at the y of the group's hubs, at its own x and z.

    Args:
        aircraft: definition.
        edges: y of the edges of the strips that the structure is spread over, from root to tip, m [edge].
        wing_mass: mass of both half wings, kg.
    """
    tanks, motors = [], []
    tank, fuel = aircraft.wing.fuel_tank, _fuel(aircraft)
    if fuel:
        strips = tank.y0_m + (tank.y1_m - tank.y0_m) * jnp.linspace(0.0, 1.0, TANK_STRIPS + 1)
        tanks.append(_spread(aircraft, sum(i.m_kg for i in fuel), strips))
    for item in pods(aircraft):
        group = next(r for r in aircraft.rotor if r.name == item.tracks.removeprefix(ROTOR))
        places = [(item.x_m, y, item.z_m) for y in hub_ys(group)]
        points = jnp.stack([jnp.stack([jnp.asarray(v, float) for v in p]) for p in places])
        motors.append(point_mass(jnp.full(len(places), item.m_kg / (SIDES * len(places))), points))
    return Carried(_spread(aircraft, wing_mass, edges), tuple(tanks), tuple(motors))


def rotor_spins(aircraft):
    """Polar inertias [r], kg m2, and angular velocities [r, 3], rad/s, of the starboard rotors."""
    groups = [group for group in aircraft.rotor for _ in range(group.count_per_side)]
    inertia = jnp.stack([jnp.asarray(g.polar_inertia_kgm2, float) for g in groups])
    turns = [g.rpm * np.pi / 30.0 * (-1.0 if g.sense == "inboard-up" else 1.0) for g in groups]
    return inertia, jnp.stack([jnp.asarray(v, float) for v in turns])[:, None] * jnp.array([1.0, 0.0, 0.0])


def fuel_mass(aircraft):
    """Fuel in the wing at take-off, kg."""
    return jnp.asarray(sum(i.m_kg for i in _fuel(aircraft)), float)


def _spread(aircraft, both_sides, edges) -> SpanMass:
    """Half of a mass over strips of the starboard wing."""
    s, box = arrays.wing_arrays(aircraft), aircraft.wing.structure
    y = 0.5 * (edges[1:] + edges[:-1])
    chord, ratio = jnp.interp(y, s.y, s.chord), jnp.interp(y, s.y, _thickness_ratio(aircraft))
    x = jnp.interp(y, s.y, s.x_le) + 0.5 * (box.front_spar + box.rear_spar) * chord
    points = jnp.stack([x, y, jnp.interp(y, s.y, s.z)], axis=1)
    return spread_mass(both_sides / SIDES, edges, intensity=chord**2 * ratio, points=points)


def _thickness_ratio(aircraft):
    """Thickness over chord of the sections."""
    return jnp.stack([jnp.asarray(s.thickness, float) for s in aircraft.wing.section])


def _fuel(aircraft):
    """Items of fuel that stands in the wing."""
    return [i for i in aircraft.mass if i.tracks == "fuel"] if aircraft.wing.fuel_tank is not None else []


def pods(aircraft):
    """Items that hang on the wing at the hubs of a rotor group."""
    return [i for i in aircraft.mass if (i.tracks or "").startswith(ROTOR)]
