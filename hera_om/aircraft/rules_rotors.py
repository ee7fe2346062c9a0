"""Rules on where rotors stand: clear of each other, of their mirror images, of the wing and of the fuselage."""

import math
from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import NamedTuple

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.reference import SectionPlace, wing_sections
from hera_om.aircraft.rotors import Rotor, hub_ys
from hera_om.aircraft.rules import Finding

NEAR = 1.1
NACELLE = 0.6
"""Widest nacelle over the diameter: a third of the disk's area (choice)."""


class Disk(NamedTuple):
    """A rotor disk on the starboard side [m]."""

    rotor: Rotor
    index: int
    x: float
    y: float
    z: float
    radius: float


def rotor_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Every inconsistency of the rotor groups; clearances only where every group is placed properly."""
    placing = [f for rotor in aircraft.rotor for f in _placing(aircraft, rotor)]
    yield from placing
    for rotor in aircraft.rotor:
        yield from _pitch(rotor)
        yield from _solidity(aircraft, rotor)
        yield from _nacelle(rotor)
    yield from _alike(aircraft)
    yield from _failed(aircraft)
    if placing:
        return
    disks = [disk for rotor in aircraft.rotor for disk in _disks(aircraft, rotor)]
    yield from _overlaps(disks)
    yield from _mirror(disks)
    yield from _wing(aircraft, disks)
    yield from _fuselage(aircraft, disks)


def _placing(aircraft: Aircraft, rotor: Rotor) -> Iterator[Finding]:
    """Position given in exactly one way, spacing where it is needed, hubs on the span."""
    path = f"rotor.{rotor.name}"
    on_wing = (rotor.x_ahead_of_leading_edge_m is not None, rotor.z_offset_m is not None)
    absolute = (rotor.x_m is not None, rotor.z_m is not None)
    if (on_wing, absolute) not in (((True, True), (False, False)), ((False, False), (True, True))):
        names = ("x_ahead_of_leading_edge_m", "z_offset_m", "x_m", "z_m")
        value = ", ".join(n for n in names if getattr(rotor, n) is not None) or None
        expected = "either x_ahead_of_leading_edge_m and z_offset_m (with a wing), or x_m and z_m"
        yield Finding(path, value, expected, "placing")
    elif on_wing[0] and aircraft.wing is None:
        value = rotor.x_ahead_of_leading_edge_m
        yield Finding(f"{path}.x_ahead_of_leading_edge_m", value, "x_m and z_m, since there is no wing", "placing")
    if rotor.count_per_side > 1 and rotor.spacing_m is None:
        yield Finding(f"{path}.spacing_m", None, "a distance > 0 [m], since count_per_side > 1", "spacing")
        return
    if rotor.y_m == 0.0 and (rotor.count_per_side > 1 or aircraft.wing is not None):
        expected = "more than 0 [m]: one rotor in the symmetry plane stands alone and goes only without a wing"
        yield Finding(f"{path}.y_m", rotor.y_m, expected, "centred")
    if aircraft.wing is not None and hub_ys(rotor)[-1] > aircraft.wing.section[-1].y_m:
        tip = aircraft.wing.section[-1].y_m
        expected = f"an outermost hub (now at {hub_ys(rotor)[-1]:g}) within the semispan {tip:g} [m]"
        yield Finding(f"{path}.y_m", rotor.y_m, expected, "beyond the tip")


def _pitch(rotor: Rotor) -> Iterator[Finding]:
    """Blade pitch inside its limits."""
    low = -math.inf if rotor.beta75_min_deg is None else rotor.beta75_min_deg
    high = math.inf if rotor.beta75_max_deg is None else rotor.beta75_max_deg
    if low >= high:
        yield Finding(f"rotor.{rotor.name}.beta75_min_deg", low, f"less than beta75_max_deg = {high:g}", "reversed")
    elif not low <= rotor.beta75_deg <= high:
        expected = f"between beta75_min_deg and beta75_max_deg, {low:g} to {high:g} [deg]"
        yield Finding(f"rotor.{rotor.name}.beta75_deg", rotor.beta75_deg, expected, "pitch")


def _nacelle(rotor: Rotor) -> Iterator[Finding]:
    """A nacelle that leaves most of the disk to the air."""
    widest = NACELLE * rotor.diameter_m
    if rotor.nacelle_diameter_m > widest:
        expected = f"at most {NACELLE:g} of the diameter, {widest:g} [m]"
        yield Finding(f"rotor.{rotor.name}.nacelle_diameter_m", rotor.nacelle_diameter_m, expected, "nacelle")


def _solidity(aircraft: Aircraft, rotor: Rotor) -> Iterator[Finding]:
    """Blades side by side leave air between them: in the plane of the disk they fill less than the circumference."""
    blade = next((b for b in aircraft.blade if b.name == rotor.blade), None)
    if blade is None or not len(blade.r) == len(blade.c) == len(blade.twist_deg):
        return
    for i, (r, c, twist) in enumerate(zip(blade.r, blade.c, blade.twist_deg, strict=True)):
        filled = rotor.blades * c * abs(math.cos(math.radians(rotor.beta75_deg + twist))) / (2 * math.pi * r)
        if filled >= 1.0:
            expected = f"less than {c / filled:.4g}, or the {rotor.blades} blades of {rotor.name} overlap there"
            yield Finding(f"blade.{blade.name}.c.{i}", c, expected, "solid")


def _alike(aircraft: Aircraft) -> Iterator[Finding]:
    """Blades in use share kind of polar, axes of their tables, and losses: all rotors are solved at once."""
    used = dict.fromkeys(r.blade for r in aircraft.rotor)
    blades = [b for b in aircraft.blade if b.name in used]
    for first, blade in zip(blades[:1] * len(blades[1:]), blades[1:], strict=True):
        path, other = f"blade.{blade.name}", f"blade {first.name}, since all rotors are solved at once"
        for key in ("tip_loss", "hub_loss", "stall_delay"):
            if getattr(blade, key) != getattr(first, key):
                expected = f"{str(getattr(first, key)).lower()} as in {other}"
                yield Finding(f"{path}.{key}", getattr(blade, key), expected, "alike")
        if (blade.polar is None) != (first.polar is None):
            kind = "polar_table" if first.polar is None else "polar"
            yield Finding(path, "polar" if blade.polar else "polar_table", f"{kind} as in {other}", "alike")
        elif first.polar_table and blade.polar_table and first.polar_table.csv and blade.polar_table.csv:
            pair = [(t.csv or "", t.compressible) for t in (first.polar_table, blade.polar_table)]
            yield from _axes(path, other, *pair)


def _axes(path: str, other: str, first: tuple[str, bool], own: tuple[str, bool]) -> Iterator[Finding]:
    """Tables share their Reynolds and Mach numbers, or have a single one."""
    from hera_om.aircraft.polar_data import blade_axes  # numpy, which a definition without tables need not import

    for name, wanted, given in zip(("reynolds", "mach"), blade_axes(*first), blade_axes(*own), strict=True):
        if len(wanted) > 1 and len(given) > 1 and wanted != given:
            value, listed = (", ".join(f"{v:g}" for v in values) for values in (given, wanted))
            yield Finding(f"{path}.polar_table.{name}", value, f"{listed} as in {other}, or a single one", "alike")


def _failed(aircraft: Aircraft) -> Iterator[Finding]:
    """Failed rotors exist, each fails once, and one in the plane of symmetry has no side."""
    groups, seen = {r.name: r for r in aircraft.rotor}, set()
    for i, failed in enumerate(aircraft.flight.failed):
        path, group = f"flight.failed[{i}]", groups[failed.rotor]
        if failed.number > group.count_per_side:
            expected = f"at most {group.count_per_side}, the rotors of {group.name} on one side"
            yield Finding(f"{path}.number", failed.number, expected, "number")
        if group.y_m == 0.0 and failed.side != "both":
            yield Finding(f"{path}.side", failed.side, f"'both': {group.name} is in the plane of symmetry", "side")
        places = {(failed.rotor, failed.number, half) for half in failed.halves}
        if places & seen:
            yield Finding(path, failed.name, "a rotor that has not failed already", "twice")
        seen |= places


def _disks(aircraft: Aircraft, rotor: Rotor) -> Iterator[Disk]:
    """The disks of a group on the starboard side."""
    places = wing_sections(aircraft.wing) if aircraft.wing else ()
    for index, y in enumerate(hub_ys(rotor)):
        if rotor.x_m is not None and rotor.z_m is not None:
            x, z = rotor.x_m, rotor.z_m
        else:
            edge = _leading_edge(places, y)
            x, z = edge.x - (rotor.x_ahead_of_leading_edge_m or 0.0), edge.z + (rotor.z_offset_m or 0.0)
        yield Disk(rotor, index, x, y, z, 0.5 * rotor.diameter_m)


def _leading_edge(places: tuple[SectionPlace, ...], y: float) -> SectionPlace:
    """The wing's leading edge at a distance from the symmetry plane."""
    for a, b in pairwise(places):
        if y <= b.y and b.y > a.y:
            t = (y - a.y) / (b.y - a.y)
            return SectionPlace(a.x + t * (b.x - a.x), y, a.z + t * (b.z - a.z))
    return places[-1]


def slipstreams_meet_disks(aircraft: Aircraft) -> bool:
    """Whether a disk stands behind another, seen from the front, within a tenth of their radii."""
    disks = [disk for rotor in aircraft.rotor for disk in _disks(aircraft, rotor)]
    pairs = combinations(disks, 2)
    return any(math.hypot(b.y - a.y, b.z - a.z) < NEAR * (a.radius + b.radius) for a, b in pairs)


def _overlaps(disks: list[Disk]) -> Iterator[Finding]:
    """Disks on one side that overlap, seen from the front, stand at least the larger radius behind each other.

    So the rear one works in a slipstream that has left its rotor, and no blade meets another.
    """
    for a, b in combinations(disks, 2):
        distance, needed = math.hypot(b.y - a.y, b.z - a.z), a.radius + b.radius
        behind, apart = abs(b.x - a.x), max(a.radius, b.radius)
        if distance >= needed or behind >= apart:
            continue
        if a.rotor is b.rotor:
            key, value = f"rotor.{a.rotor.name}.spacing_m", a.rotor.spacing_m
            expected = f"hubs at least the diameter {needed:g} [m] apart, or the disks overlap"
        else:
            key, value = f"rotor.{b.rotor.name}.y_m", b.rotor.y_m
            expected = (
                f"at least {needed:g} [m] between hub {b.index + 1} of {b.rotor.name} at y = {b.y:g} and hub "
                f"{a.index + 1} of {a.rotor.name} at y = {a.y:g} (now {distance:.4g}), or one at least {apart:g} [m] "
                f"behind the other (now {behind:.4g}), or the disks overlap"
            )
        yield Finding(key, value, expected, "overlap")


def _mirror(disks: list[Disk]) -> Iterator[Finding]:
    """Disks do not reach their mirror images; a centred disk has none."""
    for disk in disks:
        if 0.0 < disk.y < disk.radius:
            expected = f"at least the radius {disk.radius:g} [m], or the disk overlaps its mirror image"
            yield Finding(f"rotor.{disk.rotor.name}.y_m", disk.rotor.y_m, expected, "mirror")


def _wing(aircraft: Aircraft, disks: list[Disk]) -> Iterator[Finding]:
    """Disks at the height of the wing stand ahead of its leading edge or behind its trailing edge."""
    if aircraft.wing is None:
        return
    edges, chords = wing_sections(aircraft.wing), [s.chord_m for s in aircraft.wing.section]
    tails = tuple(e._replace(x=e.x + c) for e, c in zip(edges, chords, strict=True))
    for disk in disks:
        reach = [max(edges[0].y, disk.y - disk.radius), disk.y, min(edges[-1].y, disk.y + disk.radius)]
        reach += [e.y for e in edges if abs(e.y - disk.y) < disk.radius]
        if abs(disk.z - _leading_edge(edges, disk.y).z) >= disk.radius:
            continue
        front, rear = (pick(_leading_edge(at, y).x for y in reach) for pick, at in ((min, edges), (max, tails)))
        if front <= disk.x <= rear:
            on_wing = disk.rotor.x_m is None
            key = "x_ahead_of_leading_edge_m" if on_wing else "x_m"
            expected = f"a disk ahead of x = {front:g} or behind {rear:g} [m] (now {disk.x:g}), or it cuts the wing"
            value = disk.rotor.x_ahead_of_leading_edge_m if on_wing else disk.rotor.x_m
            yield Finding(f"rotor.{disk.rotor.name}.{key}", value, expected, "wing")


def _fuselage(aircraft: Aircraft, disks: list[Disk]) -> Iterator[Finding]:
    """Disks beside the fuselage do not cut it; its full section is taken all along."""
    body = aircraft.fuselage
    if body is None:
        return
    for disk in disks:
        beside = 0.0 <= disk.x <= body.length_m and abs(disk.z) - disk.radius < 0.5 * body.height_m
        needed = disk.radius + 0.5 * body.width_m
        if beside and disk.y < needed:
            expected = f"at least {needed:g} [m], or the disk cuts the fuselage"
            yield Finding(f"rotor.{disk.rotor.name}.y_m", disk.rotor.y_m, expected, "fuselage")
