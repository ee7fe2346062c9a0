"""From a definition to the arrays that the physics takes; traced numbers pass through."""

import math
from functools import lru_cache

import jax
import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.lifting_surfaces import LiftingSurface, commands, lifting_surfaces
from hera_om.aircraft.polar_data import blade_arrays, mach_numbers, polar_arrays
from hera_om.aircraft.reference import reference_b, reference_c, reference_S, wing_quarter_mac
from hera_om.aircraft.rotors import hub_ys
from hera_om.aircraft.rules_rotors import slipstreams_meet_disks
from hera_om.aircraft.spacing import segment_points
from hera_om.core.errors import InputError, Problem
from hera_om.physics.aero_cases import Body, Drag, Flow, Model, RotorPlan, Rotors, Slender, Surface
from hera_om.physics.atmosphere import isa
from hera_om.physics.blade_polar import BladeTable, Polar, make_blade_table, resampled
from hera_om.physics.controls import Control
from hera_om.physics.fuselage import Fuselage, fuselage_drag, fuselage_moment_slope
from hera_om.physics.geometry import FLAT, Grid, Sections, cut, segment_weights, span_weights
from hera_om.physics.layout import FREE, PLANE, ROOTED, SINGLE
from hera_om.physics.polar_extension import full_incidence, with_mach_numbers
from hera_om.physics.profile_drag import section_profile_drag
from hera_om.physics.rotor import sense_sign
from hera_om.physics.section_polar import SectionPolar
from hera_om.physics.strip_polar import StripPolar, StripTable, make_table

RAD = np.pi / 180
OWN_COMPONENT = 1000  # numbers from here on are of surfaces that give none
SAME_INCIDENCE = 1e-6  # rad: closer ones of two tables count as one
NO_POLAR = StripPolar(0.0, 0.0, 0.0, 1e6, 10.0)


def parts(aircraft: Aircraft, lateral: bool, tan=math.tan) -> list[LiftingSurface]:
    """Lifting surfaces of a model, the wing first. Mirrored flow has no fin: nothing loads it there."""
    return [s for s in lifting_surfaces(aircraft, tan) if lateral or not s.in_plane]


def model_commands(aircraft: Aircraft, lateral: bool) -> tuple[str, ...]:
    """Commands of a model: all that some control answers to, or the elevator's alone."""
    return tuple(c for c in commands(aircraft) if lateral or c == "delta_e")


def model(aircraft: Aircraft, lateral: bool) -> Model:
    """Static facts of the lattice.

    Raises:
        ValueError: a surface without an image needs lateral flow.
    """
    found = parts(aircraft, lateral)
    alone = [s.name for s in found if not (s.symmetric or s.in_plane)]
    if alone and not lateral:
        raise ValueError(f"surface {alone[0]!r} has no mirror image: its flow is never symmetric")
    kinds = tuple(_kind(s) for s in found)
    how = {"commands": len(model_commands(aircraft, lateral)), "lateral": lateral}
    how["stream_wake"] = aircraft.lattice.wake == "stream"
    if aircraft.lattice.convention == "avl":
        numbers = (s.component for s in found)
        own = (OWN_COMPONENT + i if n is None else n for i, n in enumerate(numbers))
        return Model(kinds, shape=FLAT, components=tuple(own), **how)
    return Model(kinds, **how)


def _kind(surface: LiftingSurface) -> str:
    """How a surface meets the plane of symmetry at the baseline."""
    if surface.in_plane:
        return PLANE
    if not surface.symmetric:
        return SINGLE
    return ROOTED if float(surface.y[0]) == 0.0 else FREE


def grids(aircraft: Aircraft, lateral: bool = False) -> list[Grid]:
    """Panel layouts of the surfaces, cut at the baseline; they keep their shares when sections move."""
    return [_grid(s) for s in parts(aircraft, lateral)]


def _grid(s: LiftingSurface) -> Grid:
    """Panel layout of one surface."""
    if s.segments is None:
        span = span_weights([float(v) for v in s.station], s.spanwise, s.spanwise_law)
    else:
        span = segment_weights([segment_points(segment) for segment in s.segments])
    return cut(span, s.airfoils, s.chordwise, s.chordwise_law)


def surfaces(aircraft: Aircraft, layout: list[Grid], lateral: bool = False) -> list[Surface]:
    """The surfaces of a model, the wing first. The fin's profile drag is among the drag areas."""
    order = model_commands(aircraft, lateral)
    pairs = zip(parts(aircraft, lateral, jnp.tan), layout, strict=True)
    return [
        Surface(sections_of(s), grid, _polar(s), _row(s.station), _controls(s, order), _row(s.thickness))
        for s, grid in pairs
    ]


def sections_of(s: LiftingSurface) -> Sections:
    """Sections of a surface with incidence and twist together."""
    twist = _row((s.incidence_deg + t) * RAD for t in s.twist_deg)
    return Sections(_row(s.x_le), _row(s.y), _row(s.z), _row(s.chord), twist)


def _controls(s: LiftingSurface, order: tuple[str, ...]) -> tuple[Control, ...]:
    """Controls of a surface that answer to the commands of the model."""
    return tuple(
        Control(
            command=np.array([float(c.command == name) for name in order]),
            ends=_row(c.ends),
            hinge=_row(c.hinge),
            gain=_row(c.gain),
            mirror=c.mirror,
            axis=None if c.axis is None else _row(c.axis),
        )
        for c in s.controls
        if c.command in order
    )


def _polar(s: LiftingSurface) -> StripPolar | StripTable:
    """Polar of a surface; without one there is no profile drag."""
    if s.polar_table is not None and s.polar_table.csv is not None and s.name != "vtail":
        return _table(s.polar_table.csv)
    p = s.polar
    return NO_POLAR if p is None or s.name == "vtail" else StripPolar(p.cd_min, p.cl_at_cd_min, p.k, p.re, p.cl_max)


@lru_cache(maxsize=16)
def _table(csv: str) -> StripTable:
    """Spline coefficients of a polar table, made once."""
    a = polar_arrays(csv)
    return make_table(np.deg2rad(a.alpha_deg), a.reynolds, a.mach, cl=a.cl, cd=a.cd, cm=a.cm)


def wing_arrays(aircraft: Aircraft) -> Sections:
    """Sections of the wing."""
    return sections_of(lifting_surfaces(aircraft, jnp.tan)[0])


def plan(aircraft: Aircraft, lateral: bool) -> RotorPlan | None:
    """Static facts of the rotors; one setting of losses and stall delay for all blades.

    Raises:
        InputError: the flow is symmetric and a rotor has failed on one side, or a whole group, which a trim moves.
    """
    if not aircraft.rotor:
        return None
    if not lateral:
        _refuse_failures(aircraft)
    groups = tuple(i for i, rotor in enumerate(aircraft.rotor) for _ in range(rotor.count_per_side))
    blade = [aircraft.blade_of(r) for r in aircraft.rotor]
    first = {r.name: groups.index(i) for i, r in enumerate(aircraft.rotor)}
    failed = [(h, first[f.rotor] + f.number - 1, f.state) for f in aircraft.flight.failed for h in f.halves]
    return RotorPlan(
        groups=groups,
        sides=1 if all(r.y_m == 0.0 for r in aircraft.rotor) else 2,
        radial=aircraft.lattice.rotor_radial,
        azimuthal=aircraft.lattice.rotor_azimuthal,
        tip_loss=all(b.tip_loss for b in blade),
        hub_loss=all(b.hub_loss for b in blade),
        stall_delay=all(b.stall_delay for b in blade),
        neighbours=slipstreams_meet_disks(aircraft) and (bool(lifting_surfaces(aircraft)) or aircraft.flight.mach > 0),
        failed=tuple(sorted(failed)),
    )


def _refuse_failures(aircraft: Aircraft) -> None:
    """Failures that one half of an aircraft cannot hold."""
    problems = []
    for i, failed in enumerate(aircraft.flight.failed):
        if failed.side != "both":
            expected = "'both': this model holds half of the aircraft, the other is its image; analyze holds both"
            problems.append(Problem(aircraft.name, f"flight.failed[{i}].side", failed.side, expected))
    for group in aircraft.rotor:
        gone = {f.number for f in aircraft.flight.failed if f.rotor == group.name and f.side == "both"}
        if len(gone) == group.count_per_side:
            expected = f"a rotor of {group.name} that runs: a trim moves the pitch of each group; analyze needs none"
            problems.append(Problem(aircraft.name, "flight.failed", f"all of {group.name}", expected))
    if problems:
        raise InputError(problems)


def rotors(aircraft: Aircraft) -> Rotors | None:
    """All rotors of the starboard half."""
    if not aircraft.rotor:
        return None
    polars = _blade_polars(aircraft)
    singles = [_rotor(aircraft, group, y, polars[group.blade]) for group in aircraft.rotor for y in hub_ys(group)]
    return jax.tree.map(lambda *parts: jnp.stack([jnp.asarray(p, float) for p in parts]), *singles)


def _blade_polars(aircraft: Aircraft) -> dict[str, Polar]:
    """Polars of the blades in use: all seven numbers, or all tables, on common axes."""
    used = [aircraft.blade_of(group) for group in aircraft.rotor]
    tables = {b.name: b.polar_table for b in used if b.polar_table is not None}
    if tables:
        absent = [name for name, t in tables.items() if t.csv is None]
        if absent:
            raise InputError([Problem(aircraft.name, f"blade.{absent[0]}.polar_table.csv", None, "a table")])
        made = _blade_tables(tuple((t.csv, t.compressible, t.aspect_ratio) for t in tables.values()))
        return dict(zip(tables, made, strict=True))
    return {b.name: _formula(b.polar) for b in used}


def _formula(p) -> SectionPolar:
    """Seven numbers of a blade."""
    angle = p.alpha_zero_lift_deg * RAD
    return SectionPolar(p.cl_alpha_per_rad, angle, p.cd_min, p.cl_at_cd_min, p.k, p.cl_max, float(p.compressible))


@lru_cache(maxsize=16)
def _blade_tables(tables: tuple[tuple[str, bool, float | None], ...]) -> list[BladeTable]:
    """Tables over full incidence, made once: on all incidences of any, on the longest axes, so that they stack."""
    full = [_full_table(*table) for table in tables]
    alpha = np.unique(np.concatenate([t[0] for t in full]))
    alpha = alpha[np.append(np.diff(alpha) > SAME_INCIDENCE, True)]
    reynolds, mach = (max((t[i] for t in full), key=len) for i in (1, 2))
    shape = len(alpha), len(reynolds), len(mach)
    stacked = [[np.broadcast_to(resampled(t[0], v, alpha), shape) for v in t[3:]] for t in full]
    return [make_blade_table(alpha, reynolds, mach, cl=cl, cd=cd) for cl, cd in stacked]


def _full_table(csv: str, compressible: bool, aspect_ratio: float | None):
    """Incidences (rad), Reynolds and Mach numbers, lift and drag coefficients of a table over full incidence."""
    a = blade_arrays(csv)
    alpha, mach = np.deg2rad(a.alpha_deg), np.asarray(mach_numbers(csv, compressible))
    cl, cd = a.cl, a.cd
    if len(mach) > len(a.mach):
        alpha, cl, cd = with_mach_numbers(alpha, cl[:, :, 0], cd[:, :, 0], mach)
    alpha, cl, cd = full_incidence(alpha, cl, cd, aspect_ratio=aspect_ratio)
    return alpha, a.reynolds, mach, cl, cd


def _rotor(aircraft: Aircraft, group, y, polar: Polar) -> Rotors:
    """One rotor of a group, without the leading axis."""
    blade, radius = aircraft.blade_of(group), group.diameter_m / 2
    return Rotors(
        hub=_hub(aircraft, group, y),
        incidence=group.axis_incidence_deg * RAD,
        radius=radius,
        hub_radius=blade.hub * radius,
        nacelle_radius=jnp.asarray(group.nacelle_diameter_m / 2),
        r=_row(blade.r),
        chord=_row(blade.c),
        twist=_row(blade.twist_deg) * RAD,
        polar=polar,
        blades=jnp.asarray(float(group.blades)),
        omega=group.rpm * 2 * np.pi / 60,
        sense=jnp.asarray(sense_sign(group.sense, 1.0)),
    )


def _hub(aircraft: Aircraft, group, y):
    """Hub of a rotor: by the wing's leading edge at its y, or as given."""
    if group.x_m is not None:
        return _row([group.x_m, y, group.z_m])
    s = wing_arrays(aircraft)
    x, z = jnp.interp(y, s.y, s.x_le), jnp.interp(y, s.y, s.z)
    return _row([x - group.x_ahead_of_leading_edge_m, y, z + group.z_offset_m])


def flow(aircraft: Aircraft, mach, altitude, point) -> Flow:
    """The stream: standard atmosphere, unless the definition gives speed or density."""
    air, given = isa(altitude), aircraft.flight
    speed = mach * air.sound_speed if given.speed_m_s is None else given.speed_m_s
    density = air.density if given.density_kg_m3 is None else given.density_kg_m3
    return Flow(speed, density, air.sound_speed, air.viscosity, mach, point)


def moment_point(aircraft: Aircraft) -> tuple[float, ...]:
    """Moment point of the definition, or the quarter of the wing's mean chord, or the origin."""
    at = _quarter(aircraft, math.tan)
    given = (aircraft.reference.x_m, aircraft.reference.y_m, aircraft.reference.z_m)
    return tuple(a if g is None else g for a, g in zip(at, given, strict=True))


def _quarter(aircraft: Aircraft, tan):
    """Quarter of the wing's mean chord, or the origin."""
    return wing_quarter_mac(aircraft.wing, tan) if aircraft.wing is not None else (0.0, 0.0, 0.0)


def _shell(f) -> Fuselage:
    """Outer dimensions of a fuselage."""
    return Fuselage(f.length_m, f.width_m, f.height_m, f.nose_length_m, f.tail_length_m)


def slender(aircraft: Aircraft) -> Slender | None:
    """The fuselage whose flow the lattice feels, if it is modelled so."""
    f = aircraft.fuselage
    if f is None or f.model != "slender" or aircraft.wing is None:
        return None
    found = {s.name: s for s in lifting_surfaces(aircraft, jnp.tan)}
    wing, tail = found["wing"], found.get("htail")
    x_le = jnp.asarray(wing.x_le[0], float)
    x_tail = f.length_m if tail is None else tail.x_le[0] + 0.25 * tail.chord[0]
    return Slender(_shell(f), (x_le, x_le + wing.chord[0]), jnp.asarray(x_tail, float))


def body(aircraft: Aircraft, stream: Flow) -> Body:
    """Reference quantities, fuselage and drag areas; a rotor alone refers to its disk and diameter."""
    S, c, b = reference(aircraft)
    areas, slope = [], jnp.zeros(())
    count = sum(r.count_per_side for r in aircraft.rotor)
    free = jnp.zeros(max(count, 1))
    unit = stream.density * stream.speed / stream.viscosity
    if aircraft.fuselage is not None:
        f = aircraft.fuselage
        shape = _shell(f)
        if f.model == "munk":
            slope = fuselage_moment_slope(shape, S=S, length_ref=c, munk_factor=f.munk_factor)
        friction = fuselage_drag(shape, reynolds_per_length=unit, mach=stream.mach, S=S) * S
        areas.append((friction, f.length_m / 2, 0.0, free))
    if aircraft.vtail is not None and aircraft.vtail.polar is not None:
        areas.append((*_fin(aircraft.vtail, unit), free))
    areas += [_area(aircraft, item, free) for item in aircraft.drag_area]
    if not areas:
        areas.append((0.0, 0.0, 0.0, free))
    area, x, z, share = zip(*areas, strict=True)
    return Body(S, c, b, slope, Drag(_row(area), _row(x), _row(z), jnp.stack(share)))


def reference(aircraft: Aircraft):
    """Reference area, chord and span."""
    if aircraft.wing is None and aircraft.reference.S_m2 is None:
        diameter = aircraft.rotor[0].diameter_m if aircraft.rotor else 1.0
        return np.pi / 4 * diameter**2, diameter, diameter
    c = reference_c(aircraft)
    b = c if aircraft.wing is None and aircraft.reference.b_m is None else reference_b(aircraft)
    return reference_S(aircraft), c, b


def _fin(fin, unit):
    """Drag area of the unloaded fin and where it acts: half way up, at a quarter of the chord."""
    area = fin.S_m2 * fin.scale**2
    height = jnp.sqrt(fin.aspect_ratio * area)
    p = fin.polar
    cd = section_profile_drag(
        0.0, unit * area / height, cd_min=p.cd_min, cl_at_cd_min=p.cl_at_cd_min, k=p.k, re_ref=p.re
    )
    root = 2 * area / (height * (1 + fin.taper))
    quarter = fin.x_le_root_m + root / 4 + height / 2 * jnp.tan(fin.sweep_quarter_deg * RAD)
    return cd * area, quarter, fin.z_root_m + height / 2


def _area(aircraft: Aircraft, item, free):
    """A drag area at the wing's mean quarter chord and the fuselage axis, or at the hubs of its rotors."""
    if item.rotor is None:
        return item.value_m2, _quarter(aircraft, jnp.tan)[0], 0.0, free
    start = 0
    for group in aircraft.rotor:
        if group.name == item.rotor:
            share = free.at[start : start + group.count_per_side].set(1.0 / group.count_per_side)
            x, _, z = _hub(aircraft, group, group.y_m)
            return item.value_m2, x, z, share
        start += group.count_per_side
    raise KeyError(item.rotor)


def _row(values):
    """One array of numbers, traced or not."""
    return jnp.stack([jnp.asarray(v, float) for v in values])
