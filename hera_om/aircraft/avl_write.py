"""AVL geometry files out: every lifting surface of an aircraft, sections put in where controls end."""

import math
import warnings
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from hera_om.aircraft.airfoils import Coordinates
from hera_om.aircraft.avl_read import CONTROL_NAMES, AvlWarning
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.lifting_surfaces import LiftingSurface, SurfaceCommand, lifting_surfaces
from hera_om.aircraft.reference import reference_b, reference_c, reference_S, wing_quarter_mac
from hera_om.aircraft.spacing import Segment, avl_counts, segments

_LEAST_GAP = 1e-9  # of the span: two stations nearer than this are one
_BLEND_THICKNESS = 0.12  # of contours made for AVL; it takes the mean line alone


class _Row(NamedTuple):
    """A section as AVL has it."""

    place: tuple[float, ...]  # x_le, y, z, chord, twist
    station: float
    airfoil: str | Coordinates
    strips: Segment | None  # of the segment outboard, where the sections give them


def write_avl(aircraft: Aircraft, path: str | Path) -> None:
    """Write the lifting surfaces and reference quantities of an aircraft as an AVL geometry file.

    Control variables are named elevator, aileron, rudder, flap and mean our commands, so that a positive rudder
    of the file moves the trailing edge to port. Drag areas go into CDp. Numbers are written in full, so that
    reading gives them back; what AVL does not know is left out with an `AvlWarning`.

    Raises:
        ValueError: there is no lifting surface.
    """
    surfaces = lifting_surfaces(aircraft)
    if not surfaces:
        raise ValueError(f"{aircraft.name!r} has no lifting surface")
    lines = list(_header(aircraft))
    for surface in surfaces:
        lines += ["", *_surface(surface)]
    Path(path).write_text("\n".join(lines) + "\n", "utf-8")
    lost, moved = _left_out(aircraft), [s.name for s in surfaces if not _strips(s, _rows(s))[1]]
    if lost:
        warnings.warn(f"{path}: left out: {', '.join(lost)}", AvlWarning, stacklevel=2)
    if moved:
        warnings.warn(f"{path}: AVL sets the strips otherwise on {', '.join(moved)}", AvlWarning, stacklevel=2)


def _left_out(aircraft: Aircraft) -> list[str]:
    """What of the aircraft is not in the file."""
    surfaces = (aircraft.wing, aircraft.htail, aircraft.vtail, *aircraft.surface)
    parts = {
        "fuselage": aircraft.fuselage,
        "rotors": aircraft.rotor,
        "section polars": any(s is not None and s.polar is not None for s in surfaces),
        "masses": aircraft.mass,
    }
    return [name for name, there in parts.items() if there]


def _header(aircraft: Aircraft) -> Iterator[str]:
    """Title, Mach number, symmetry, reference quantities."""
    S = reference_S(aircraft)
    yield " ".join(aircraft.name.split()).replace("!", " ").replace("#", " ").strip() or "aircraft"
    yield f"{_text(aircraft.flight.mach)}   ! Mach"
    yield "0 0 0.0   ! iYsym iZsym Zsym"
    yield _line(S, reference_c(aircraft), reference_b(aircraft)) + "   ! Sref Cref Bref"
    yield _line(*_point(aircraft)) + "   ! Xref Yref Zref"
    yield f"{sum(a.value_m2 for a in aircraft.drag_area) / S:.12g}   ! CDp"


def _point(aircraft: Aircraft) -> tuple[float, ...]:
    """Moment point: as given, else centre of gravity of the mass items, else quarter of the wing's mean chord."""
    given = (aircraft.reference.x_m, aircraft.reference.y_m, aircraft.reference.z_m)
    if None not in given:
        return tuple(float(v) for v in given if v is not None)
    total = sum(m.m_kg for m in aircraft.mass)
    if total > 0.0:
        return tuple(sum(m.m_kg * getattr(m, k) for m in aircraft.mass) / total for k in ("x_m", "y_m", "z_m"))
    return wing_quarter_mac(aircraft.wing) if aircraft.wing is not None else (0.0, 0.0, 0.0)


def _surface(surface: LiftingSurface) -> Iterator[str]:
    """One surface with its sections and controls."""
    rows = _rows(surface)
    strips, _ = _strips(surface, rows)
    yield "SURFACE"
    yield surface.name
    head = [str(surface.chordwise), _text(surface.chordwise_law)]
    if strips is None:
        head += [str(surface.spanwise), _text(surface.spanwise_law)]
    yield " ".join(head)
    if surface.component is not None:
        yield from ("COMPONENT", str(surface.component))
    if surface.symmetric:
        yield from ("YDUPLICATE", "0.0")
    if surface.incidence_deg != 0.0:
        yield from ("ANGLE", _text(surface.incidence_deg))
    lines = _control_lines(surface, rows)
    for i, (row, controls) in enumerate(zip(rows, lines, strict=True)):
        yield "SECTION"
        by_section = f" {strips[i].count} {_text(strips[i].law)}" if strips and i < len(strips) else ""
        yield _line(*row.place) + by_section
        yield from _airfoil(row.airfoil)
        for control in controls:
            yield from ("CONTROL", control)


def _strips(surface: LiftingSurface, rows: Sequence[_Row]) -> tuple[list[Segment] | None, bool]:
    """Strips by section, None where AVL gets the number of the whole; and whether AVL sets them as we do."""
    parts = [r.strips for r in rows[:-1] if r.strips is not None]
    at, law = tuple(r.station for r in rows), surface.spanwise_law
    counts = avl_counts(at, surface.spanwise, law)
    if not parts and counts is not None:
        return None, len(rows) == 2
    if not parts:
        return [Segment(c, 0.0, 0.0, 1.0) for c in _shared(at, surface.spanwise)], False
    own = tuple(p.count for p in parts)
    if parts == list(segments(own, (None,) * len(own), law)) and counts == own:
        return None, True
    return [_whole_law(p) for p in parts], all((p.start, p.end) == (0.0, 1.0) for p in parts)


def _whole_law(part: Segment) -> Segment:
    """A segment whose law AVL knows; a part of a longer one becomes uniform."""
    return part if (part.start, part.end) == (0.0, 1.0) else Segment(part.count, 0.0, 0.0, 1.0)


def _shared(at: Sequence[float], n: int) -> list[int]:
    """About n strips in proportion to the widths of the segments, at least one each."""
    return [max(1, round(n * (b - a) / (at[-1] - at[0]))) for a, b in pairwise(at)]


def _rows(surface: LiftingSurface) -> list[_Row]:
    """The sections, and between them one at every end of a control; then strips are no longer by section."""
    own, span = surface.station, surface.station[-1] - surface.station[0]
    ends = {e for c in surface.controls for e in c.ends}
    extra = sorted(e for e in ends if own[0] < e < own[-1] and min(abs(e - s) for s in own) > _LEAST_GAP * span)
    out = []
    for s in sorted([*own, *extra]):
        i = max(k for k in range(len(own) - 1) if own[k] <= s)
        f = (s - own[i]) / (own[i + 1] - own[i])
        ends_of = [
            tuple(v[k] for v in (surface.x_le, surface.y, surface.z, surface.chord, surface.twist_deg))
            for k in (i, i + 1)
        ]
        place = ends_of[round(f)] if f in (0.0, 1.0) else tuple(a + f * (b - a) for a, b in zip(*ends_of, strict=True))
        airfoil = _between(surface.airfoils[i], surface.airfoils[i + 1], f)
        strips = surface.segments[i] if surface.segments and not extra and s != own[-1] else None
        out.append(_Row(place, s, airfoil, strips))
    return out


def _between(inner: str | Coordinates, outer: str | Coordinates, f: float) -> str | Coordinates:
    """Airfoil between two sections: theirs, or a contour about the mean of their mean lines."""
    if f in (0.0, 1.0) or inner == outer:
        return outer if f == 1.0 else inner
    from hera_om.core.mean_lines import contour, mean_line

    made = contour(lambda x: (1 - f) * mean_line(inner, x)[0] + f * mean_line(outer, x)[0], _BLEND_THICKNESS)
    return Coordinates(made.x, made.z)


def _airfoil(airfoil: str | Coordinates) -> Iterator[str]:
    """NACA four digits by name; AVL has no five digits, so those and all others by coordinates."""
    if airfoil == "flat":
        return
    digits = airfoil.split()[1] if isinstance(airfoil, str) else ""
    if len(digits) == 4:
        yield from ("NACA", digits)
        return
    from hera_om.core.mean_lines import contour, mean_line

    if isinstance(airfoil, str):
        airfoil = Coordinates(*contour(lambda x: mean_line(airfoil, x)[0], int(digits[-2:]) / 100))
    elif all(a < b for a, b in zip(airfoil.x[:-1], airfoil.x[1:], strict=True)):
        points = airfoil
        airfoil = Coordinates(*contour(lambda x: mean_line(points, x)[0], _BLEND_THICKNESS))
    yield "AIRFOIL"
    yield from (_line(x, z) for x, z in zip(airfoil.x, airfoil.z, strict=True))


def _control_lines(surface: LiftingSurface, rows: Sequence[_Row]) -> list[list[str]]:
    """CONTROL lines by section.

    AVL joins what one variable has at neighbouring sections. A control that does not go on where the last one of
    its command ended, with the same hinge and gain, therefore gets a variable of its own: elevator2.
    """
    lines: list[list[str]] = [[] for _ in rows]
    last: dict[str, tuple[str, SurfaceCommand]] = {}
    used: dict[str, int] = {}
    gap = _LEAST_GAP * (surface.station[-1] - surface.station[0])
    for control in sorted(surface.controls, key=lambda c: c.ends[0]):
        name, before = last.get(control.command, ("", None))
        if before is None or not _goes_on(before, control, gap):
            used[control.command] = used.get(control.command, 0) + 1
            count = used[control.command]
            name = CONTROL_NAMES[control.command] + (str(count) if count > 1 else "")
        last[control.command] = (name, control)
        for row, out in zip(rows, lines, strict=True):
            if control.ends[0] - gap <= row.station <= control.ends[1] + gap:
                text = _control_line(name, control, row.station)
                if not any(line.split()[0] == name for line in out):
                    out.append(text)
                elif row.station < control.ends[1] - gap:  # a segment takes sign and axis from its inner end
                    out[[line.split()[0] for line in out].index(name)] = text
    return lines


def _goes_on(before: SurfaceCommand, control: SurfaceCommand, gap: float) -> bool:
    """Whether a control takes over where another one ends."""
    meets = abs(before.ends[1] - control.ends[0]) <= gap
    return meets and (before.hinge[1], before.gain[1]) == (control.hinge[0], control.gain[0])


def _control_line(name: str, control: SurfaceCommand, station: float) -> str:
    """One CONTROL line; hinge and gain go linearly along the control."""
    inner, outer = control.ends
    f = min(max((station - inner) / (outer - inner), 0.0), 1.0)
    f = round(f) if math.isclose(f, round(f), abs_tol=1e-12) else f
    hinge, gain = (a + f * (b - a) if a != b else a for a, b in (control.hinge, control.gain))
    axis = (0.0, 0.0, 0.0) if control.axis is None else control.axis
    return f"{name} {_line(gain, hinge, *axis, control.mirror)}"


def _line(*values: float) -> str:
    """Numbers of one line."""
    return " ".join(_text(v) for v in values)


def _text(value: Any) -> str:
    """The shortest text that reads back as the number."""
    return repr(float(value) + 0.0)
