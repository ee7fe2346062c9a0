"""Every lifting surface of an aircraft in one form: wing, horizontal tail, fin, further surfaces.

Plain arithmetic that works on traced numbers too: whatever decides about structure (which surfaces, controls, strips)
is structure of the definition and not a number.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from hera_om.aircraft.airfoils import Coordinates
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.free_surfaces import COMMANDS, Surface, SurfaceControl
from hera_om.aircraft.mission import Lattice
from hera_om.aircraft.polars import PolarTable
from hera_om.aircraft.reference import wing_sections
from hera_om.aircraft.spacing import Segment, law_number, segments
from hera_om.aircraft.surfaces import HTail, Polar, VTail, Wing

RAD = math.pi / 180.0
WING, TAILS = 1, 2  # numbers of components
Pair = tuple[Any, Any]


class SurfaceCommand(NamedTuple):
    """A control of a surface. The deflection, gain times the command, turns by the right-hand rule from root to tip."""

    name: str
    command: str  # delta_e, delta_a, delta_r, delta_f
    ends: Pair  # inner and outer end, in the coordinate `LiftingSurface.station`
    hinge: Pair  # chord fractions at the ends, linear between
    gain: Pair  # at the ends, linear between
    mirror: Any  # deflection of the mirrored half: 1 its mirror image, -1 opposed (and of a surface in the plane)
    limit_deg: Any  # None: no limit
    axis: tuple[Any, Any, Any] | None  # of the rotation; None: the hinge line


class LiftingSurface(NamedTuple):
    """One lifting surface; one entry a section in every tuple from `x_le` to `airfoils`, root first."""

    name: str  # wing, htail, vtail, or that of a further surface
    symmetric: bool  # mirrored about y = 0
    in_plane: bool  # stands in the plane y = 0
    x_le: tuple[Any, ...]  # leading edge, m, geometry axes
    y: tuple[Any, ...]
    z: tuple[Any, ...]
    chord: tuple[Any, ...]  # m
    thickness: tuple[Any, ...]  # over chord; further surfaces have none
    twist_deg: tuple[Any, ...]  # without the incidence
    incidence_deg: Any  # to add to every twist
    station: tuple[Any, ...]  # coordinate along the span, rising from section to section, m
    airfoils: tuple[str | Coordinates, ...]  # as `physics.airfoil.camber_line` takes them
    chordwise: int
    chordwise_law: float  # AVL's number, see `spacing.law_number`
    spanwise: int  # strips of the whole
    spanwise_law: float
    segments: tuple[Segment, ...] | None  # None: `spanwise` strips are shared out by `spanwise_law`
    controls: tuple[SurfaceCommand, ...]
    polar: Polar | None
    polar_table: PolarTable | None
    component: int | None  # see `free_surfaces.Surface`; the wing is 1, the tails together 2


def lifting_surfaces(aircraft: Aircraft, tan: Callable[[Any], Any] = math.tan) -> tuple[LiftingSurface, ...]:
    """Every lifting surface: wing, htail, vtail as far as there are, then the further ones in the file's order.

    Args:
        aircraft: the definition; its numbers may be traced.
        tan: tangent of an angle in radians; pass ``jax.numpy.tan`` when the numbers are traced.
    """
    out = []
    if aircraft.wing is not None:
        out.append(_wing(aircraft, aircraft.wing, tan))
    if aircraft.htail is not None:
        out.append(_htail(aircraft, aircraft.htail, tan))
    if aircraft.vtail is not None:
        out.append(_vtail(aircraft, aircraft.vtail, tan))
    return (*out, *(_free(aircraft, surface) for surface in aircraft.surface))


def commands(aircraft: Aircraft) -> tuple[str, ...]:
    """The commands that some control of the aircraft answers to, in the order of the registry."""
    wing, htail, vtail = aircraft.wing, aircraft.htail, aircraft.vtail
    found = {c.command for s in aircraft.surface for c in s.control}
    built_in = {
        "delta_e": htail is not None and htail.control.elevator is not None,
        "delta_a": wing is not None and wing.control.aileron is not None,
        "delta_r": vtail is not None and vtail.control.rudder is not None,
        "delta_f": wing is not None and wing.control.flap is not None,
    }
    return tuple(c for c in COMMANDS if c in found or built_in[c])


def command_limit_deg(aircraft: Aircraft, command: str) -> float | None:
    """Largest command within every control's limit, from the definition's own numbers; None: no limit."""
    limits = [
        control.limit_deg / max(abs(g) for g in control.gain)
        for surface in lifting_surfaces(aircraft)
        for control in surface.controls
        if control.command == command and control.limit_deg is not None and any(control.gain)
    ]
    return min(limits, default=None)


def airfoil_of(aircraft: Aircraft, name: str) -> str | Coordinates:
    """The name itself, or the coordinates of the [[airfoil]] that it names."""
    return next((Coordinates(a.x, a.z) for a in aircraft.airfoil if a.name == name), name)


def stations(y: tuple[Any, ...], z: tuple[Any, ...]) -> tuple[Any, ...]:
    """Lengths along the sections in the y-z plane, from 0 at the first [m]."""
    out: list[Any] = [0.0]
    for i in range(len(y) - 1):
        out.append(out[-1] + ((y[i + 1] - y[i]) ** 2 + (z[i + 1] - z[i]) ** 2) ** 0.5)
    return tuple(out)


def _wing(aircraft: Aircraft, wing: Wing, tan: Callable[[Any], Any]) -> LiftingSurface:
    """The wing; its spanwise coordinate is y."""
    x, y, z = zip(*wing_sections(wing, tan), strict=True)
    lattice, control = aircraft.lattice, wing.control
    counts = _counts(wing.section)
    law = law_number(lattice.spacing)
    pairs = (("aileron", "delta_a", -1.0, control.aileron), ("flap", "delta_f", 1.0, control.flap))
    return LiftingSurface(
        name="wing",
        symmetric=True,
        in_plane=False,
        x_le=x,
        y=y,
        z=z,
        chord=tuple(s.chord_m for s in wing.section),
        thickness=tuple(s.thickness for s in wing.section),
        twist_deg=tuple(s.twist_deg for s in wing.section),
        incidence_deg=wing.incidence_deg,
        station=y,
        airfoils=tuple(airfoil_of(aircraft, s.airfoil) for s in wing.section),
        chordwise=lattice.wing_chordwise,
        chordwise_law=law_number(lattice.chordwise_spacing),
        spanwise=sum(counts) if counts else lattice.wing_spanwise,
        spanwise_law=law,
        segments=segments(counts, tuple(s.spacing for s in wing.section[:-1]), law) if counts else None,
        controls=tuple(_partial(*row) for row in pairs if row[3] is not None),
        polar=wing.polar,
        polar_table=wing.polar_table,
        component=WING,
    )


def _partial(name: str, command: str, mirror: float, control: Any) -> SurfaceCommand:
    """A control over a part of the wing's span."""
    hinge, gain = (control.hinge, control.hinge), (control.gain, control.gain)
    return SurfaceCommand(name, command, (control.y0_m, control.y1_m), hinge, gain, mirror, control.limit_deg, None)


def _htail(aircraft: Aircraft, tail: HTail, tan: Callable[[Any], Any]) -> LiftingSurface:
    """The horizontal tail: the quarter of its mean aerodynamic chord stays where it is."""
    area = tail.S_m2 * tail.scale**2
    span = (tail.aspect_ratio * area) ** 0.5
    root = 2.0 * area / (span * (1.0 + tail.taper))
    y_mac = span / 6.0 * (1.0 + 2.0 * tail.taper) / (1.0 + tail.taper)
    y, chord = (0.0, span / 2.0), (root, root * tail.taper)
    slope, rise = tan(tail.sweep_quarter_deg * RAD), tan(tail.dihedral_deg * RAD)
    place = {
        "x_le": tuple(tail.x_quarter_mac_m + (at - y_mac) * slope - c / 4.0 for at, c in zip(y, chord, strict=True)),
        "y": y,
        "z": tuple(tail.z_m + at * rise for at in y),
        "chord": chord,
    }
    lattice, elevator = aircraft.lattice, tail.control.elevator
    controls = () if elevator is None else (_whole("elevator", "delta_e", elevator, y, 1.0),)
    numbers = (lattice.tail_chordwise, lattice.tail_spanwise)
    return _trapezoid(aircraft, "htail", tail, place, y, numbers, controls, tail.incidence_deg)


def _vtail(aircraft: Aircraft, tail: VTail, tan: Callable[[Any], Any]) -> LiftingSurface:
    """The fin: the leading edge of its root stays where it is. A rudder to port turns against the right-hand rule."""
    area = tail.S_m2 * tail.scale**2
    height = (tail.aspect_ratio * area) ** 0.5
    root = 2.0 * area / (height * (1.0 + tail.taper))
    tip = root * tail.taper
    quarter = tail.x_le_root_m + root / 4.0 + height * tan(tail.sweep_quarter_deg * RAD)
    station = (0.0, height)
    place = {
        "x_le": (tail.x_le_root_m, quarter - tip / 4.0),
        "y": (0.0, 0.0),
        "z": (tail.z_root_m, tail.z_root_m + height),
        "chord": (root, tip),
    }
    rudder = tail.control.rudder
    controls = () if rudder is None else (_whole("rudder", "delta_r", rudder, station, -1.0),)
    return _trapezoid(aircraft, "vtail", tail, place, station, fin_panels(aircraft.lattice), controls, 0.0)


def fin_panels(lattice: Lattice) -> tuple[int, int]:
    """Panels of the fin along chord and height."""
    chordwise = lattice.tail_chordwise if lattice.fin_chordwise is None else lattice.fin_chordwise
    return chordwise, lattice.tail_spanwise if lattice.fin_spanwise is None else lattice.fin_spanwise


def _trapezoid(
    aircraft: Aircraft,
    name: str,
    tail: HTail | VTail,
    place: dict[str, tuple[Any, ...]],
    station: Pair,
    panels: tuple[int, int],
    controls: tuple[SurfaceCommand, ...],
    incidence_deg: Any,
) -> LiftingSurface:
    """A tail of two sections."""
    lattice = aircraft.lattice
    return LiftingSurface(
        name=name,
        symmetric=name == "htail",
        in_plane=name == "vtail",
        **place,
        thickness=(tail.thickness,) * 2,
        twist_deg=(0.0, 0.0),
        incidence_deg=incidence_deg,
        station=station,
        airfoils=(airfoil_of(aircraft, tail.airfoil),) * 2,
        chordwise=panels[0],
        chordwise_law=law_number(lattice.chordwise_spacing),
        spanwise=panels[1],
        spanwise_law=law_number(lattice.spacing),
        segments=None,
        controls=controls,
        polar=tail.polar,
        polar_table=tail.polar_table,
        component=TAILS,
    )


def _whole(name: str, command: str, control: Any, ends: Pair, sign: float) -> SurfaceCommand:
    """A control over the whole span of a tail."""
    gain = (sign * control.gain, sign * control.gain)
    return SurfaceCommand(name, command, ends, (control.hinge, control.hinge), gain, sign, control.limit_deg, None)


def _free(aircraft: Aircraft, surface: Surface) -> LiftingSurface:
    """A further surface; its spanwise coordinate is the length along its sections in the y-z plane."""
    lattice, rows = aircraft.lattice, surface.section
    y, z = tuple(s.y_m for s in rows), tuple(s.z_m for s in rows)
    station, counts = stations(y, z), _counts(rows)
    law = law_number(lattice.spacing if surface.spacing is None else surface.spacing)
    chord_law = lattice.chordwise_spacing if surface.chordwise_spacing is None else surface.chordwise_spacing
    spanwise = lattice.tail_spanwise if surface.spanwise is None else surface.spanwise
    return LiftingSurface(
        name=surface.name,
        symmetric=surface.side == "both",
        in_plane=surface.side == "plane",
        x_le=tuple(s.x_le_m for s in rows),
        y=y,
        z=z,
        chord=tuple(s.chord_m for s in rows),
        thickness=(0.0,) * len(rows),
        twist_deg=tuple(s.twist_deg for s in rows),
        incidence_deg=surface.incidence_deg,
        station=station,
        airfoils=tuple(airfoil_of(aircraft, s.airfoil) for s in rows),
        chordwise=lattice.tail_chordwise if surface.chordwise is None else surface.chordwise,
        chordwise_law=law_number(chord_law),
        spanwise=sum(counts) if counts else spanwise,
        spanwise_law=law,
        segments=segments(counts, tuple(s.spacing for s in rows[:-1]), law) if counts else None,
        controls=tuple(_free_control(c, surface.side, station[-1]) for c in surface.control),
        polar=surface.polar,
        polar_table=surface.polar_table,
        component=surface.component,
    )


def _free_control(control: SurfaceControl, side: str, length: Any) -> SurfaceCommand:
    """A control of a further surface."""
    mirror = control.mirror
    if mirror is None:
        mirror = -1.0 if side == "plane" or control.command in ("delta_a", "delta_r") else 1.0
    outer_hinge = control.hinge if control.hinge_outer is None else control.hinge_outer
    outer_gain = control.gain if control.gain_outer is None else control.gain_outer
    axis = None if control.axis_x is None else (control.axis_x, control.axis_y, control.axis_z)
    return SurfaceCommand(
        name=control.name,
        command=control.command,
        ends=(control.inner * length, control.outer * length),
        hinge=(control.hinge, outer_hinge),
        gain=(control.gain, outer_gain),
        mirror=mirror,
        limit_deg=control.limit_deg,
        axis=axis,
    )


def _counts(rows: tuple[Any, ...]) -> tuple[int, ...] | None:
    """Strips of each segment, where the sections give them."""
    counts = tuple(s.strips for s in rows[:-1])
    return None if any(c is None for c in counts) else counts
