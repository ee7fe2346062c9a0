"""AVL geometry files in: every surface becomes a [[surface]], every control answers to one of our commands.

Signs. In AVL and in a [[surface.control]] alike a positive deflection turns by the right-hand rule about the hinge
line from the first section to the last. What differs is the sense of a positive command: ours moves the trailing
edge down (elevator, flap), down to starboard (aileron), to PORT (rudder), while an AVL file may choose. A control
whose gains make a positive command move the other way gets all its gains turned round, so that our command is
minus the file's; a note says so. The usual rudder of an AVL file, gain +1 on a fin that runs up, is such a case.
"""

import math
import warnings
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

from hera_om.aircraft.airfoils import Coordinates, free_name, slug
from hera_om.aircraft.avl_text import AvlControl, AvlSection, AvlSurface, AvlText
from hera_om.aircraft.lifting_surfaces import stations
from hera_om.aircraft.spacing import avl_counts, law_text
from hera_om.core.errors import InputError, Problem

SOURCE = "AVL geometry file"
DRAG_NAME = "CDp"  # the drag area that stands for the profile drag of the header
CONTROL_NAMES = {"delta_e": "elevator", "delta_a": "aileron", "delta_r": "rudder", "delta_f": "flap"}
_COMMANDS = {"elev": "delta_e", "ail": "delta_a", "rud": "delta_r", "flap": "delta_f"}
_MIXED = ("elevon", "flaperon", "ruddervator", "ruddervon")


class AvlWarning(UserWarning):
    """Something of an AVL file, or of an aircraft, that the other side does not know and that is left out."""


class _Piece(NamedTuple):
    """A control over one segment of a surface."""

    surface: int
    segment: int
    inner: AvlControl
    outer: AvlControl


def avl_tables(text: str, file: str) -> dict[str, Any]:
    """The raw tables of a definition from the text of an AVL file.

    Raises:
        InputError: with every line that is wrong.
    """
    blocks = AvlText(text, file)
    problems = [*blocks.problems, *_refused(blocks)]
    if problems:
        raise InputError(problems)
    airfoils: dict[Coordinates, str] = {}
    names: set[str] = set()
    surfaces = []
    for block in blocks.surfaces:
        name = free_name(slug(block.name, "surface"), names | {"wing", "htail", "vtail"})
        names.add(name)
        surfaces.append(_surface(block, name, blocks, airfoils, problems))
    notes = [*blocks.warnings, *_controls(blocks, surfaces)]
    if problems:
        raise InputError(problems)
    for note in notes:
        warnings.warn(f"{file}: {note}", AvlWarning, stacklevel=3)
    return _tables(blocks, surfaces, airfoils)


def _tables(blocks: AvlText, surfaces: list[dict[str, Any]], airfoils: dict[Coordinates, str]) -> dict[str, Any]:
    """Header and tables; AVL takes 1 for a reference quantity of 0."""
    S, c, b = (v if v != 0.0 else 1.0 for v in blocks.reference)
    x, y, z = blocks.point
    data: dict[str, Any] = {"name": blocks.title, "source": SOURCE, "flight": {"mach": blocks.mach}}
    data["reference"] = {"S_m2": S, "c_m": c, "b_m": b, "x_m": x, "y_m": y, "z_m": z}
    data["surface"] = surfaces
    data["lattice"] = {"convention": "avl"}
    if airfoils:
        data["airfoil"] = [{"name": name, "x": list(k.x), "z": list(k.z)} for k, name in airfoils.items()]
    if blocks.drag != 0.0:
        data["drag_area"] = [{"name": DRAG_NAME, "value_m2": blocks.drag * S}]
    return data


def _refused(blocks: AvlText) -> Iterator[Problem]:
    """What the header or a surface asks for that has no counterpart."""
    key = f"line {blocks.symmetry_line}"
    if blocks.symmetry[0] not in (0.0, 1.0):
        yield Problem(blocks.file, key, blocks.symmetry[0], "iYsym 0 or 1; an antisymmetric image is not known")
    if blocks.symmetry[1] != 0.0:
        yield Problem(blocks.file, key, blocks.symmetry[1], "iZsym 0; ground and jet edge are not known")
    if not blocks.surfaces:
        yield Problem(blocks.file, "", "no surface", "at least one SURFACE")
    for surface in blocks.surfaces:
        key = f"line {surface.line}"
        if len(surface.sections) < 2:
            expected = "at least two SECTIONs"
            yield Problem(blocks.file, key, f"{surface.name}: {len(surface.sections)}", expected)
        if surface.mirrored and blocks.symmetry[0] == 1.0:
            yield Problem(blocks.file, key, f"{surface.name}: YDUPLICATE", "either YDUPLICATE or iYsym = 1")
        laws = [surface.chordwise_spacing, surface.spacing, *(s.spacing for s in surface.sections)]
        for law in laws:
            if not -3.0 <= law <= 3.0:
                yield Problem(blocks.file, key, law, f"a spacing from -3 to 3 on surface {surface.name}")


def _surface(
    block: AvlSurface, name: str, blocks: AvlText, airfoils: dict[Coordinates, str], problems: list[Problem]
) -> dict[str, Any]:
    """One surface without its controls: scaled, then shifted, as in AVL."""
    (sx, sy, sz), (dx, dy, dz) = block.scale, block.shift
    rows: list[dict[str, Any]] = []
    for i, section in enumerate(block.sections, 1):
        x, y, z, chord, twist = section.place
        row: dict[str, Any] = {"name": f"s{i}", "x_le_m": x * sx + dx, "y_m": y * sy + dy, "z_m": z * sz + dz}
        row |= {"chord_m": chord * sx, "twist_deg": twist, "airfoil": _airfoil(section, airfoils)}
        rows.append(row)
    in_plane = all(row["y_m"] == 0.0 for row in rows)
    both = block.mirrored or (blocks.symmetry[0] == 1.0 and not in_plane)
    table: dict[str, Any] = {"name": name, "side": "both" if both else "plane" if in_plane else "one"}
    table |= {"incidence_deg": block.angle, "chordwise": block.chordwise}
    if block.component is not None:
        table["component"] = block.component
    table |= {"chordwise_spacing": law_text(block.chordwise_spacing), "section": rows}
    _strips(block, table, blocks.file, problems)
    return table


def _strips(block: AvlSurface, table: dict[str, Any], file: str, problems: list[Problem]) -> None:
    """Numbers of strips: the surface's, shared out by AVL's rule, or else the sections'."""
    rows, key = table["section"], f"line {block.line}"
    if block.spanwise > 0:
        at = stations(tuple(r["y_m"] for r in rows), tuple(r["z_m"] for r in rows))
        table["spacing"] = law_text(block.spacing)
        counts = avl_counts(at, block.spanwise, block.spacing) if _apart(at) else (1,) * (len(rows) - 1)
        if counts is None:
            expected = f"more strips on surface {block.name}: two of its sections would stand at one edge"
            problems.append(Problem(file, key, block.spanwise, expected))
            return
        for row, count in zip(rows, counts, strict=False):
            row["strips"] = count
        return
    for row, section in zip(rows[:-1], block.sections, strict=False):
        if section.strips < 1:
            expected = f"Nspan of the section, since surface {block.name} has none"
            problems.append(Problem(file, f"line {section.line}", section.strips, expected))
        row["strips"] = section.strips
        (row if len(rows) > 2 else table)["spacing"] = law_text(section.spacing)


def _apart(at: tuple[float, ...]) -> bool:
    """Whether all segments have a width; the rules name those that have none."""
    return all(a < b for a, b in pairwise(at))


def _airfoil(section: AvlSection, airfoils: dict[Coordinates, str]) -> str:
    """Name of the section's airfoil; equal coordinates share one. AVL's default is flat."""
    if section.coordinates is not None:
        return airfoils.setdefault(section.coordinates, f"airfoil_{len(airfoils) + 1}")
    return "flat" if section.naca is None else f"NACA {section.naca}"


def _controls(blocks: AvlText, surfaces: list[dict[str, Any]]) -> Iterator[str]:
    """Add the controls to the raw tables of the surfaces; the notes tell what was turned or left out."""
    pieces: dict[str, list[_Piece]] = {}
    for i, block in enumerate(blocks.surfaces):
        for k, (inner, outer) in enumerate(pairwise(block.sections)):
            ends = {c.name: c for c in outer.controls}
            for name, control in {c.name: c for c in inner.controls}.items():
                if name in ends:
                    pieces.setdefault(name, []).append(_Piece(i, k, control, ends[name]))
    answering: dict[str, list[str]] = {}
    rows: list[tuple[_Piece, str, float]] = []
    for name, parts in pieces.items():
        command = command_of(name)
        if command is None:
            yield f"control {name} is left out: its name starts with none of {', '.join(_COMMANDS)}"
            continue
        answering.setdefault(command, []).append(name)
        sign = -1.0 if sum(_sense(p, command, blocks, surfaces) for p in parts) < 0.0 else 1.0
        if sign < 0.0:
            yield f"{command} is minus the file's {name}: there a positive {name} moves the other way"
        rows += [(p, command, sign) for p in parts]
    for command, names in answering.items():
        if len(names) > 1:
            yield f"controls {', '.join(names)} all answer to {command}"
    for i, (block, table) in enumerate(zip(blocks.surfaces, surfaces, strict=True)):
        merged = _merged([row for row in rows if row[0].surface == i])
        if merged:
            table["control"] = list(_control_tables(merged, block, table))


def command_of(name: str) -> str | None:
    """Our command that a control's name stands for: by its start, or the command itself."""
    low = name.lower()
    if low in CONTROL_NAMES:
        return low
    if low.startswith(_MIXED):
        return None
    return next((c for start, c in _COMMANDS.items() if low.startswith(start)), None)


def _sense(piece: _Piece, command: str, blocks: AvlText, surfaces: list[dict[str, Any]]) -> float:
    """How far a positive command of the file moves the trailing edge our way, weighted by gain and width."""
    a, b = surfaces[piece.surface]["section"][piece.segment : piece.segment + 2]
    along = (b["y_m"] - a["y_m"], b["z_m"] - a["z_m"])
    width = math.hypot(*along)
    hy, hz = _axis(piece.inner, blocks.surfaces[piece.surface])[1:] if any(piece.inner.axis) else along
    size = math.hypot(hy, hz) or 1.0
    starboard = 1.0 if a["y_m"] + b["y_m"] >= 0.0 else -1.0
    ours = {"delta_r": -hz, "delta_a": hy * starboard}.get(command, hy)  # the trailing edge moves by (hz, -hy)
    return (piece.inner.gain + piece.outer.gain) / 2 * ours / size * width


def _axis(control: AvlControl, block: AvlSurface) -> tuple[float, ...]:
    """The axis of rotation in our lengths."""
    return tuple(v * s for v, s in zip(control.axis, block.scale, strict=True))


def _merged(rows: list[tuple[_Piece, str, float]]) -> list[list[tuple[_Piece, str, float]]]:
    """Runs of segments over which a control stays what it is."""
    runs: list[list[tuple[_Piece, str, float]]] = []
    for row in sorted(rows, key=lambda r: r[0].segment):
        run = next((r for r in runs if _continues(r, row)), None)
        if run is None:
            runs.append([row])
        else:
            run.append(row)
    return runs


def _continues(run: list[tuple[_Piece, str, float]], row: tuple[_Piece, str, float]) -> bool:
    """Whether a piece follows the run, with one hinge, gain, sign and axis all along."""
    first, last, new = run[0][0], run[-1][0], row[0]
    ends = [first.inner, last.outer, new.inner, new.outer]
    constant = len({(c.gain, c.hinge) for c in ends}) == 1
    same = len({(p.inner.mirror, p.inner.axis) for p in (first, new)}) == 1
    return constant and same and run[0][1:] == row[1:] and new.segment == last.segment + 1


def _control_tables(
    runs: list[list[tuple[_Piece, str, float]]], block: AvlSurface, table: dict[str, Any]
) -> Iterator[dict[str, Any]]:
    """Raw tables of the controls of one surface; their ends are fractions of the length along its sections."""
    rows, taken = table["section"], set()
    at = stations(tuple(r["y_m"] for r in rows), tuple(r["z_m"] for r in rows))
    for run in runs:
        (first, command, sign), last = run[0], run[-1][0]
        name = free_name(CONTROL_NAMES[command], taken)
        taken.add(name)
        inner, outer = first.inner, last.outer
        out: dict[str, Any] = {"name": name, "command": command}
        length = at[-1] or 1.0
        out |= {"inner": at[first.segment] / length, "outer": at[last.segment + 1] / length}
        out |= {"hinge": inner.hinge, "gain": sign * inner.gain + 0.0}
        if outer.hinge != inner.hinge:
            out["hinge_outer"] = outer.hinge
        if outer.gain != inner.gain:
            out["gain_outer"] = sign * outer.gain + 0.0
        if table["side"] == "both":
            out["mirror"] = inner.mirror
        if any(inner.axis):
            out |= dict(zip(("axis_x", "axis_y", "axis_z"), _axis(inner, block), strict=True))
        yield out
