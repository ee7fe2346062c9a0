"""Rules on further lifting surfaces, strips of sections, airfoils by coordinates and the commands of controls."""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any

from hera_om.aircraft.airfoils import coordinate_fault
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.free_surfaces import COMMANDS, Surface, SurfaceControl
from hera_om.aircraft.lifting_surfaces import commands
from hera_om.aircraft.rules import Finding

LEAST_WIDTH = 1e-9  # m, of a segment in the y-z plane


def surface_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Every inconsistency of further surfaces, and what they share with the wing."""
    for surface in aircraft.surface:
        yield from _places(surface)
        yield from strip_findings(f"surface.{surface.name}", surface.section, surface.spanwise)
        for control in surface.control:
            yield from _control(surface, control)
    if aircraft.wing:
        yield from strip_findings("wing", aircraft.wing.section, None)
        yield from _numbers_of_strips(aircraft)
    for airfoil in aircraft.airfoil:
        yield from _airfoil(airfoil)
    yield from _polars(aircraft)
    if aircraft.fuselage and aircraft.fuselage.model == "slender" and not aircraft.wing:
        yield Finding("fuselage.model", "slender", "'munk', since there is no [wing] that it could change", "no wing")
    yield from _commands(aircraft)


def _polars(aircraft: Aircraft) -> Iterator[Finding]:
    """A surface has one polar, by formula or by table."""
    named = {"wing": aircraft.wing, "htail": aircraft.htail, "vtail": aircraft.vtail}
    for path, part in [*named.items(), *((f"surface.{s.name}", s) for s in aircraft.surface)]:
        if part is not None and part.polar is not None and part.polar_table is not None:
            yield Finding(f"{path}.polar_table", "a table", f"polar or polar_table of {path}, not both", "two polars")


def _places(surface: Surface) -> Iterator[Finding]:
    """Sections apart from each other, on the side that they belong to."""
    path = f"surface.{surface.name}"
    for inner, outer in pairwise(surface.section):
        width = ((outer.y_m - inner.y_m) ** 2 + (outer.z_m - inner.z_m) ** 2) ** 0.5
        if width < LEAST_WIDTH:
            expected = f"another y_m or z_m than {inner.name}: between them lies a segment of zero width and area"
            yield Finding(f"{path}.section.{outer.name}.y_m", outer.y_m, f"{expected} [m]", "zero width")
    for section in surface.section:
        key = f"{path}.section.{section.name}.y_m"
        if surface.side == "both" and section.y_m < 0.0:
            yield Finding(key, section.y_m, ">= 0 on a surface that is mirrored about y = 0 [m]", "side")
        if surface.side == "plane" and section.y_m != 0.0:
            yield Finding(key, section.y_m, "0 on a surface in the plane y = 0 [m]", "side")
    if surface.side != "plane" and all(s.y_m == 0.0 for s in surface.section):
        yield Finding(f"{path}.side", surface.side, "'plane', since every section stands at y_m = 0", "side")


def strip_findings(path: str, rows: tuple[Any, ...], spanwise: int | None) -> Iterator[Finding]:
    """Strips by section are given for every segment or for none."""
    *inner, last = rows
    for key in ("strips", "spacing"):
        if getattr(last, key) is not None:
            expected = "absent from the last section, which has no segment outboard of it"
            yield Finding(f"{path}.section.{last.name}.{key}", getattr(last, key), expected, "last section")
    given = [s for s in inner if s.strips is not None]
    for section in inner:
        key = f"{path}.section.{section.name}"
        if given and section.strips is None:
            expected = f"a number, since section {given[0].name} has one: strips of every segment or of none"
            yield Finding(f"{key}.strips", None, expected, "strips")
        if section.spacing is not None and section.strips is None:
            yield Finding(f"{key}.spacing", section.spacing, "strips beside it", "strips")
    if given and spanwise is not None:
        yield Finding(f"{path}.spanwise", spanwise, "absent where sections give their strips", "strips")
    if spanwise is not None and spanwise < len(inner):
        yield Finding(
            f"{path}.spanwise", spanwise, f"at least one strip for each of {len(inner)} segments", "few strips"
        )


def _numbers_of_strips(aircraft: Aircraft) -> Iterator[Finding]:
    """Each segment of the wing gets a strip."""
    segments = len(aircraft.wing.section) - 1 if aircraft.wing else 0
    if aircraft.lattice.wing_spanwise < segments:
        expected = f"at least one strip for each of the wing's {segments} segments"
        yield Finding("lattice.wing_spanwise", aircraft.lattice.wing_spanwise, expected, "few strips")


def _control(surface: Surface, control: SurfaceControl) -> Iterator[Finding]:
    """A control has a width; its axis is a direction."""
    path = f"surface.{surface.name}.control.{control.name}"
    if control.inner >= control.outer:
        expected = f"less than the outer end {control.outer:g}: a control of positive width"
        yield Finding(f"{path}.inner", control.inner, expected, "ends reversed")
    axis = {key: getattr(control, key) for key in ("axis_x", "axis_y", "axis_z")}
    missing = [key for key, value in axis.items() if value is None]
    if 0 < len(missing) < 3:
        yield Finding(f"{path}.{missing[0]}", None, "all three of axis_x, axis_y, axis_z, or none", "axis")
    if not missing and not any(axis.values()):
        yield Finding(f"{path}.axis_x", 0.0, "a direction: not all of axis_x, axis_y, axis_z zero", "axis")
    if control.mirror is not None and surface.side != "both":
        yield Finding(f"{path}.mirror", control.mirror, "absent: the surface has no mirrored half", "mirror")


def _airfoil(airfoil: Any) -> Iterator[Finding]:
    """Coordinates that belong together."""
    path = f"airfoil.{airfoil.name}"
    if len(airfoil.x) != len(airfoil.z):
        yield Finding(f"{path}.z", f"{len(airfoil.z)} entries", f"as many as x, which has {len(airfoil.x)}", "length")
        return
    fault = coordinate_fault(airfoil.x, airfoil.z)
    if fault:
        expected = f"a contour from trailing edge to trailing edge, or a mean line with rising x; {fault}"
        yield Finding(f"{path}.x", f"{len(airfoil.x)} entries", expected, "coordinates")


def _commands(aircraft: Aircraft) -> Iterator[Finding]:
    """Deflections that the flight condition asks for have a control."""
    known = commands(aircraft)
    for command in COMMANDS:
        value = getattr(aircraft.flight, f"{command}_deg")
        if value != 0.0 and command not in known:
            listed = f"those that have one: {', '.join(known)}" if known else "no command has one"
            expected = f"0, since no surface has a control that answers to {command}; {listed}"
            yield Finding(f"flight.{command}_deg", value, expected, "no control")


def names_of_surfaces(aircraft: Aircraft) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """Arrays of tables of further surfaces, whose names must differ."""
    for surface in aircraft.surface:
        yield f"surface.{surface.name}.section", surface.section
        yield f"surface.{surface.name}.control", surface.control


def airfoil_holders(aircraft: Aircraft) -> Iterator[tuple[str, str]]:
    """Paths of the keys that name an airfoil, and the names."""
    rows: list[tuple[str, Iterable[Any]]] = [("wing", aircraft.wing.section)] if aircraft.wing else []
    for path, sections in [*rows, *((f"surface.{s.name}", s.section) for s in aircraft.surface)]:
        yield from ((f"{path}.section.{s.name}.airfoil", s.airfoil) for s in sections)
    for path, tail in (("htail", aircraft.htail), ("vtail", aircraft.vtail)):
        if tail is not None:
            yield f"{path}.airfoil", tail.airfoil
