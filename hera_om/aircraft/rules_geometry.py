"""Rules on wing, tails, fuselage, blades, mission and conditions, between keys of one definition."""

from collections.abc import Iterator
from itertools import pairwise

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.rotors import Blade
from hera_om.aircraft.rules import Finding
from hera_om.aircraft.surfaces import Section, Wing


def geometry_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Every inconsistency of the fixed parts."""
    if aircraft.wing:
        yield from _sections(aircraft.wing)
        yield from _span_parts(aircraft.wing)
        yield from _box(aircraft.wing)
    yield from _polars(aircraft)
    for blade in aircraft.blade:
        yield from _blade(blade)
    yield from _fuselage(aircraft)
    yield from _conditions(aircraft)


def _sections(wing: Wing) -> Iterator[Finding]:
    """Sections run outward from y = 0; each but the first places itself in one of the two ways."""
    first, last = wing.section[0], wing.section[-1]
    if first.y_m != 0.0:
        yield Finding(f"wing.section.{first.name}.y_m", first.y_m, "0 for the first section [m]", "root")
    for key in ("sweep_quarter_deg", "dihedral_deg", "x_le_m", "z_m"):
        if getattr(first, key) is not None:
            expected = "absent from the first section, which wing.x_le_root_m and wing.z_root_m place"
            yield Finding(f"wing.section.{first.name}.{key}", getattr(first, key), expected, "placing")
    for inner, outer in pairwise(wing.section):
        key, low = f"wing.section.{outer.name}.y_m", inner.y_m
        if outer is last and not outer.y_m > 0.0:
            yield Finding(key, outer.y_m, "a semispan > 0 [m]", "order")
        elif outer is not last and not low < outer.y_m < last.y_m:
            expected = f"between {low:g} ({inner.name}) and {last.y_m:g} ({last.name}) [m], inside the span"
            yield Finding(key, outer.y_m, expected, "order")
        yield from _placing(outer)


def _placing(section: Section) -> Iterator[Finding]:
    """Exactly one of (sweep_quarter_deg, dihedral_deg) and (x_le_m, z_m)."""
    given = tuple(
        value is not None for value in (section.sweep_quarter_deg, section.dihedral_deg, section.x_le_m, section.z_m)
    )
    if given not in ((True, True, False, False), (False, False, True, True)):
        names = ("sweep_quarter_deg", "dihedral_deg", "x_le_m", "z_m")
        value = ", ".join(n for n, is_given in zip(names, given, strict=True) if is_given) or None
        expected = "either sweep_quarter_deg and dihedral_deg, or x_le_m and z_m"
        yield Finding(f"wing.section.{section.name}", value, expected, "placing")


def _span_parts(wing: Wing) -> Iterator[Finding]:
    """Controls, tank and joint lie on the wing."""
    semispan = wing.section[-1].y_m
    parts = {
        "wing.control.aileron": wing.control.aileron,
        "wing.control.flap": wing.control.flap,
        "wing.fuel_tank": wing.fuel_tank,
    }
    for path, part in parts.items():
        if part is None:
            continue
        if part.y0_m >= part.y1_m:
            yield Finding(f"{path}.y0_m", part.y0_m, f"less than y1_m = {part.y1_m:g} [m]", "ends reversed")
        if part.y1_m > semispan:
            yield Finding(f"{path}.y1_m", part.y1_m, f"at most the semispan {semispan:g} [m]", "beyond the tip")
    if wing.fuselage_joint_y_m >= semispan:
        expected = f"less than the semispan {semispan:g} [m]"
        yield Finding("wing.fuselage_joint_y_m", wing.fuselage_joint_y_m, expected, "beyond the tip")
    aileron, flap = wing.control.aileron, wing.control.flap
    if aileron and flap and aileron.y0_m < flap.y1_m and flap.y0_m < aileron.y1_m:
        expected = f"clear of the flap, which covers {flap.y0_m:g} to {flap.y1_m:g} [m]"
        yield Finding("wing.control.aileron.y0_m", aileron.y0_m, expected, "overlap")


def _box(wing: Wing) -> Iterator[Finding]:
    """The wing box lies between its spars, ahead of the controls."""
    box = wing.structure
    if box is None:
        return
    if box.front_spar >= box.rear_spar:
        expected = f"less than rear_spar = {box.rear_spar:g}"
        yield Finding("wing.structure.front_spar", box.front_spar, expected, "spars reversed")
    for name, control in (("aileron", wing.control.aileron), ("flap", wing.control.flap)):
        if control and control.hinge <= box.rear_spar:
            expected = f"behind the rear spar at {box.rear_spar:g} of the chord"
            yield Finding(f"wing.control.{name}.hinge", control.hinge, expected, "hinge in the box")


def _polars(aircraft: Aircraft) -> Iterator[Finding]:
    """The polar reaches past its least drag."""
    polars = {
        **{s: part.polar for s in ("wing", "htail", "vtail") if (part := getattr(aircraft, s))},
        **{f"surface.{s.name}": s.polar for s in aircraft.surface},
        **{f"blade.{b.name}": b.polar for b in aircraft.blade},
    }
    for path, polar in polars.items():
        if polar and polar.cl_max <= polar.cl_at_cd_min:
            expected = f"more than cl_at_cd_min = {polar.cl_at_cd_min:g}"
            yield Finding(f"{path}.polar.cl_max", polar.cl_max, expected, "polar")


def _blade(blade: Blade) -> Iterator[Finding]:
    """Stations of equal number, outward from the hub."""
    path, count = f"blade.{blade.name}", len(blade.r)
    if blade.polar is None and blade.polar_table is None:
        yield Finding(path, None, "one of polar and polar_table", "polar")
    if blade.polar and blade.polar_table and blade.polar_table.csv is not None:  # a faulty table has been emptied
        yield Finding(path, "polar, polar_table", "one of polar and polar_table", "polar")
    for key in ("c", "twist_deg", "thickness"):
        if len(getattr(blade, key)) != count:
            got = f"{len(getattr(blade, key))} entries"
            yield Finding(f"{path}.{key}", got, f"as many entries as r, which has {count}", "length")
    for i, (inner, outer) in enumerate(pairwise(blade.r), start=1):
        if outer <= inner:
            yield Finding(f"{path}.r.{i}", outer, f"more than the station before it, {inner:g}", "order")
    if blade.hub > blade.r[0]:
        yield Finding(f"{path}.hub", blade.hub, f"at most the first station r = {blade.r[0]:g}", "hub")


def _fuselage(aircraft: Aircraft) -> Iterator[Finding]:
    """Nose and tail fit into the length."""
    body = aircraft.fuselage
    if body and body.nose_length_m + body.tail_length_m > body.length_m:
        expected = f"nose and tail together within length_m = {body.length_m:g} [m]"
        yield Finding("fuselage.nose_length_m", body.nose_length_m, expected, "length")


def _conditions(aircraft: Aircraft) -> Iterator[Finding]:
    """Flight and mission make sense together with the rest."""
    flight, mission, reference = aircraft.flight, aircraft.mission, aircraft.reference
    if aircraft.rotor and flight.mach == 0.0 and flight.speed_m_s is None:
        yield Finding("flight.mach", flight.mach, "mach > 0, or flight.speed_m_s, since there are rotors", "speed")
    if mission and mission.V_C_EAS_m_s >= mission.V_D_EAS_m_s:
        expected = f"less than V_D_EAS_m_s = {mission.V_D_EAS_m_s:g} [m/s]"
        yield Finding("mission.V_C_EAS_m_s", mission.V_C_EAS_m_s, expected, "speeds reversed")
    if mission and aircraft.mass:
        burnt = mission.climb_fuel_kg + mission.cruise_fuel_kg
        fuel = sum(m.m_kg for m in aircraft.mass if m.tracks == "fuel")
        if burnt > fuel:
            expected = f"with climb_fuel_kg within the items that track fuel, {fuel:g} [kg]"
            yield Finding("mission.cruise_fuel_kg", mission.cruise_fuel_kg, expected, "fuel")
    if aircraft.wing is None and (aircraft.htail or aircraft.vtail or aircraft.surface):
        for key in ("S_m2", "c_m", "b_m"):
            if getattr(reference, key) is None:
                yield Finding(f"reference.{key}", None, "a value, since no wing gives one", "reference")
    given = [getattr(reference, key) is not None for key in ("x_m", "y_m", "z_m")]
    if any(given) and not all(given):
        missing = ("x_m", "y_m", "z_m")[given.index(False)]
        yield Finding(f"reference.{missing}", None, "all three of x_m, y_m, z_m, or none", "moment point")
