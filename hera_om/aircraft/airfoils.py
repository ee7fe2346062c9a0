"""Airfoils by coordinates: the table [[airfoil]], and coordinate files that are copied into a definition."""

import re
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from hera_om.aircraft.fields import NAME, Constant, Part, item
from hera_om.core.errors import Problem

_LEAST_POINTS = 5
_EXPECTED = "a coordinate file, Selig's or Lednicer's format"
_Chord = Annotated[float, Field(ge=-0.05, le=1.05), Constant]
_Height = Annotated[float, Field(ge=-1, le=1), Constant]


class Coordinates(NamedTuple):
    """Points of an airfoil over the chord: a contour, or a mean line whose x only rises."""

    x: tuple[float, ...]
    z: tuple[float, ...]


class Airfoil(Part):
    """An airfoil by coordinates: a contour from the trailing edge over the nose and back, or a mean line with rising x.

    Coordinates are structure, not numbers: they have no paths.
    """

    name: str = item("name of the airfoil, which sections refer to", pattern=NAME)
    x: tuple[_Chord, ...] = Field(description="chord fractions [-]", min_length=_LEAST_POINTS)
    z: tuple[_Height, ...] = Field(description="heights over the chord [-]", min_length=_LEAST_POINTS)


class CoordinateFileError(ValueError):
    """What is wrong with a coordinate file, in words."""


def read_coordinates(path: Path) -> Coordinates:
    """Coordinates of a .dat file: Selig's order, or Lednicer's two sides, which are put into Selig's order.

    Raises:
        CoordinateFileError: the file cannot be read or is no such file; the message says why and in which line.
    """
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CoordinateFileError("it is no text") from None
    except (OSError, ValueError) as error:
        raise CoordinateFileError((getattr(error, "strerror", None) or str(error)).lower()) from None
    return coordinates_of(text.splitlines())


def coordinates_of(lines: list[str]) -> Coordinates:
    """Coordinates of the lines of a file; the first may be a title."""
    rows: list[tuple[float, float]] = []
    for place, line in enumerate(lines, 1):
        pair = _pair(line)
        if pair is not None:
            rows.append(pair)
        elif line.strip() and (rows or any(text.strip() for text in lines[: place - 1])):
            raise CoordinateFileError(f"line {place} is no pair of numbers: {line.strip()[:40]!r}")
    if rows and min(rows[0]) > 1.5:  # Lednicer's line of the numbers of points
        rows = _joined(rows[1:], *(int(v) for v in rows[0]))
    if len(rows) < _LEAST_POINTS:
        raise CoordinateFileError(f"it has {len(rows)} points, fewer than {_LEAST_POINTS}")
    x, z = zip(*rows, strict=True)
    fault = coordinate_fault(x, z)
    if fault:
        raise CoordinateFileError(fault)
    return Coordinates(x, z)


def coordinate_fault(x: tuple[float, ...], z: tuple[float, ...]) -> str | None:
    """What keeps points from being an airfoil, or None."""
    if not all(-0.05 <= v <= 1.05 for v in x) or min(x) > 0.05 or max(x) < 0.95:
        return f"x runs from {min(x):g} to {max(x):g}, not from 0 to 1"
    if not all(-1.0 <= v <= 1.0 for v in z):
        return "heights reach more than a chord"
    if all(a < b for a, b in pairwise(x)):
        return None
    nose = x.index(min(x))
    ahead, back = x[: nose + 1], x[nose:]
    falls = all(a >= b - 1e-9 for a, b in pairwise(ahead))
    rises = all(a <= b + 1e-9 for a, b in pairwise(back))
    if not falls or not rises or min(ahead[0], back[-1]) < 0.95:
        return "x neither rises throughout nor falls to the nose and rises again to the trailing edge"
    return None if min(len(ahead), len(back)) >= 3 else "one side has fewer than three points"


def copy_airfoil_files(data: dict[str, Any], file: str) -> list[Problem]:
    """Replace every .dat path of the raw tables by the name of an [[airfoil]] with its coordinates; the faults."""
    own = data.get("airfoil", [])
    found: dict[Path, str] = {}
    problems = []
    tables = [own] if isinstance(own, list) else []
    names = {a.get("name") for a in own if isinstance(a, dict)} if tables else set()
    added: list[dict[str, Any]] = []
    for key, table in _holders(data):
        text = table.get("airfoil")
        if not isinstance(text, str) or not text.lower().endswith(".dat"):
            continue
        path = Path(file).parent / text
        if path not in found:
            try:
                x, z = read_coordinates(path)
            except CoordinateFileError as error:
                problems.append(Problem(file, f"{key}.airfoil", text, f"{_EXPECTED}; {error}"))
                table["airfoil"] = "flat"  # so that the other faults are found too
                continue
            found[path] = free_name(slug(Path(text).stem, "airfoil"), names)
            names.add(found[path])
            added.append({"name": found[path], "x": list(x), "z": list(z)})
        table["airfoil"] = found[path]
    if added and tables:
        data["airfoil"] = [*own, *added]
    return problems


def slug(text: str, prefix: str) -> str:
    """A name that may stand in a path."""
    name = re.sub(r"[^A-Za-z0-9-]+", "_", text).strip("_-")
    return name if name[:1].isalpha() else f"{prefix}_{name}".rstrip("_")


def free_name(name: str, taken: set[Any]) -> str:
    """The name, with a number where it is taken."""
    number, candidate = 1, name
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    return candidate


def _holders(data: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Raw tables that name an airfoil, with their paths."""
    out = [(key, data[key]) for key in ("htail", "vtail") if isinstance(data.get(key), dict)]
    owners = [("wing", data.get("wing"))]
    surfaces = data.get("surface")
    owners += [(f"surface.{_name(s)}", s) for s in surfaces] if isinstance(surfaces, list) else []
    for path, owner in owners:
        rows = owner.get("section") if isinstance(owner, dict) else None
        rows = rows if isinstance(rows, list) else []
        out += [(f"{path}.section.{_name(r)}", r) for r in rows if isinstance(r, dict)]
    return out


def _name(table: Any) -> str:
    """Name of a raw table."""
    return str(table.get("name")) if isinstance(table, dict) else "?"


def _pair(line: str) -> tuple[float, float] | None:
    """Two numbers of a line, or None."""
    words = line.replace(",", " ").split()
    try:
        return (float(words[0]), float(words[1])) if len(words) == 2 else None
    except ValueError:
        return None


def _joined(rows: list[tuple[float, float]], upper: int, lower: int) -> list[tuple[float, float]]:
    """Lednicer's sides, each from the nose, in Selig's order."""
    if len(rows) != upper + lower or upper < 3 or lower < 3:
        raise CoordinateFileError(f"it has {len(rows)} points where its second line says {upper} + {lower}")
    top, bottom = rows[:upper], rows[upper:]
    return top[::-1] + (bottom[1:] if bottom[0] == top[0] else bottom)
