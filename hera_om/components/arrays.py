"""From a definition to the arrays that the physics takes; traced numbers pass through."""

import jax
import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.reference import reference_c, reference_S, wing_quarter_mac, wing_sections
from hera_om.aircraft.rotors import hub_ys
from hera_om.aircraft.surfaces import HTail
from hera_om.physics.aero_cases import Body, Drag, Flow, RotorPlan, Rotors, StripPolar, Surface
from hera_om.physics.atmosphere import isa
from hera_om.physics.fuselage import Fuselage, fuselage_drag, fuselage_moment_slope
from hera_om.physics.geometry import Grid, Sections, hinge_share, make_grid
from hera_om.physics.profile_drag import section_profile_drag
from hera_om.physics.rotor import sense_sign
from hera_om.physics.section_polar import SectionPolar

RAD = np.pi / 180
NO_POLAR = StripPolar(0.0, 0.0, 0.0, 1e6, 10.0)


def grids(aircraft: Aircraft) -> list[Grid]:
    """Panel layouts of wing and tail, cut at the baseline; they keep their shares when sections move."""
    lat, out = aircraft.lattice, []
    if aircraft.wing is not None:
        y = [s.y_m for s in aircraft.wing.section]
        names = [s.airfoil for s in aircraft.wing.section]
        out.append(_grid(y, names, lat.wing_chordwise, lat.wing_spanwise, aircraft))
    if aircraft.htail is not None:
        out.append(_grid([0.0, 1.0], [aircraft.htail.airfoil] * 2, lat.tail_chordwise, lat.tail_spanwise, aircraft))
    return out


def _grid(y, names, nc: int, ns: int, aircraft: Aircraft) -> Grid:
    """Grid of one surface by the definition's spacing laws."""
    return make_grid(y, names, nc=nc, ns=ns, span=aircraft.lattice.spacing, chord=aircraft.lattice.chordwise_spacing)


def surfaces(aircraft: Aircraft, layout: list[Grid]) -> list[Surface]:
    """Wing first, then the tail."""
    out, rest = [], list(layout)
    if aircraft.wing is not None:
        out.append(Surface(wing_arrays(aircraft), rest.pop(0), _polar(aircraft.wing.polar)))
    if aircraft.htail is not None:
        tail, grid = tail_sections(aircraft.htail), rest.pop(0)
        elevator = aircraft.htail.control.elevator
        if elevator is not None:
            share = hinge_share(grid, tail.y, ends=(0.0, tail.y[-1]), hinge=elevator.hinge, gain=elevator.gain)
            grid = grid._replace(hinge_share=share)
        out.append(Surface(tail, grid, _polar(aircraft.htail.polar)))
    return out


def _polar(polar) -> StripPolar:
    """Polar of a surface; without one there is no profile drag."""
    if polar is None:
        return NO_POLAR
    return StripPolar(polar.cd_min, polar.cl_at_cd_min, polar.k, polar.re, polar.cl_max)


def wing_arrays(aircraft: Aircraft) -> Sections:
    """Sections of the wing with incidence and twist together."""
    wing = aircraft.wing
    assert wing is not None
    places = wing_sections(wing, jnp.tan)
    twist = [(wing.incidence_deg + s.twist_deg) * RAD for s in wing.section]
    x, y, z = (jnp.stack([jnp.asarray(v, float) for v in axis]) for axis in zip(*places, strict=True))
    return Sections(x, y, z, _row(s.chord_m for s in wing.section), _row(twist))


def tail_sections(tail: HTail) -> Sections:
    """Root and tip of a trapezoid whose quarter of the mean aerodynamic chord stays where it is."""
    area = tail.S_m2 * tail.scale**2
    span = jnp.sqrt(tail.aspect_ratio * area)
    root = 2 * area / (span * (1 + tail.taper))
    y_mac = span / 6 * (1 + 2 * tail.taper) / (1 + tail.taper)
    slope, rise = jnp.tan(tail.sweep_quarter_deg * RAD), jnp.tan(tail.dihedral_deg * RAD)
    y = _row([0.0, span / 2])
    chord = _row([root, root * tail.taper])
    quarter = tail.x_quarter_mac_m + (y - y_mac) * slope
    return Sections(quarter - chord / 4, y, tail.z_m + y * rise, chord, _row([tail.incidence_deg * RAD] * 2))


def plan(aircraft: Aircraft) -> RotorPlan | None:
    """Static facts of the rotors; one setting of the loss factors for all blades."""
    if not aircraft.rotor:
        return None
    groups = tuple(i for i, rotor in enumerate(aircraft.rotor) for _ in range(rotor.count_per_side))
    blade = [aircraft.blade_of(r) for r in aircraft.rotor]
    return RotorPlan(
        groups=groups,
        sides=1 if all(r.y_m == 0.0 for r in aircraft.rotor) else 2,
        radial=aircraft.lattice.rotor_radial,
        azimuthal=aircraft.lattice.rotor_azimuthal,
        tip_loss=all(b.tip_loss for b in blade),
        hub_loss=all(b.hub_loss for b in blade),
    )


def rotors(aircraft: Aircraft) -> Rotors | None:
    """All rotors of the starboard half."""
    if not aircraft.rotor:
        return None
    singles = [_rotor(aircraft, group, y) for group in aircraft.rotor for y in hub_ys(group)]
    return jax.tree.map(lambda *parts: jnp.stack([jnp.asarray(p, float) for p in parts]), *singles)


def _rotor(aircraft: Aircraft, group, y) -> Rotors:
    """One rotor of a group, without the leading axis."""
    blade, radius = aircraft.blade_of(group), group.diameter_m / 2
    p = blade.polar
    return Rotors(
        hub=_hub(aircraft, group, y),
        incidence=group.axis_incidence_deg * RAD,
        radius=radius,
        hub_radius=blade.hub * radius,
        r=_row(blade.r),
        chord=_row(blade.c),
        twist=_row(blade.twist_deg) * RAD,
        polar=SectionPolar(
            p.cl_alpha_per_rad,
            p.alpha_zero_lift_deg * RAD,
            p.cd_min,
            p.cl_at_cd_min,
            p.k,
            p.cl_max,
            float(p.compressible),
        ),
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


def moment_point(aircraft: Aircraft):
    """Moment point of the definition, or the quarter of the wing's mean chord, or the origin."""
    at = wing_quarter_mac(aircraft.wing, jnp.tan) if aircraft.wing is not None else (0.0, 0.0, 0.0)
    given = (aircraft.reference.x_m, aircraft.reference.y_m, aircraft.reference.z_m)
    return _row([a if g is None else g for a, g in zip(at, given, strict=True)])


def body(aircraft: Aircraft, stream: Flow) -> Body:
    """Reference quantities, fuselage and drag areas; a rotor alone refers to its disk and diameter."""
    S, c = reference(aircraft)
    areas, slope = [], jnp.zeros(())
    count = sum(r.count_per_side for r in aircraft.rotor)
    free = jnp.zeros(max(count, 1))
    unit = stream.density * stream.speed / stream.viscosity
    if aircraft.fuselage is not None:
        f = aircraft.fuselage
        shape = Fuselage(f.length_m, f.width_m, f.height_m, f.nose_length_m, f.tail_length_m)
        slope = fuselage_moment_slope(shape, S=S, length_ref=c, munk_factor=f.munk_factor)
        areas.append((fuselage_drag(shape, reynolds_per_length=unit, mach=stream.mach, S=S) * S, 0.0, free))
    if aircraft.vtail is not None and aircraft.vtail.polar is not None:
        areas.append((*_fin(aircraft.vtail, unit), free))
    areas += [_area(aircraft, item, free) for item in aircraft.drag_area]
    if not areas:
        areas.append((0.0, 0.0, free))
    area, z, share = zip(*areas, strict=True)
    return Body(S, c, slope, Drag(_row(area), _row(z), jnp.stack(share)))


def reference(aircraft: Aircraft):
    """Reference area and chord."""
    if aircraft.wing is None and aircraft.reference.S_m2 is None:
        diameter = aircraft.rotor[0].diameter_m if aircraft.rotor else 1.0
        return np.pi / 4 * diameter**2, diameter
    return reference_S(aircraft), reference_c(aircraft)


def _fin(fin, unit):
    """Drag area of the unloaded fin and the height where it acts."""
    area = fin.S_m2 * fin.scale**2
    height = jnp.sqrt(fin.aspect_ratio * area)
    p = fin.polar
    cd = section_profile_drag(
        0.0, unit * area / height, cd_min=p.cd_min, cl_at_cd_min=p.cl_at_cd_min, k=p.k, re_ref=p.re
    )
    return cd * area, fin.z_root_m + 0.5 * height


def _area(aircraft: Aircraft, item, free):
    """A drag area at the fuselage axis, or shared among the rotors of its group, at their hubs."""
    if item.rotor is None:
        return item.value_m2, 0.0, free
    start = 0
    for group in aircraft.rotor:
        if group.name == item.rotor:
            share = free.at[start : start + group.count_per_side].set(1.0 / group.count_per_side)
            return item.value_m2, _hub(aircraft, group, group.y_m)[2], share
        start += group.count_per_side
    raise KeyError(item.rotor)


def _row(values):
    """One array of numbers, traced or not."""
    return jnp.stack([jnp.asarray(v, float) for v in values])
