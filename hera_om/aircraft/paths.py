"""The numbers of a definition by dotted path, and the split of an aircraft into structure and numbers.

Paths go by the keys of the TOML file; an item of an array of tables stands under its name and an element of
an array of numbers under its index: ``wing.section.kink.y_m``, ``blade.main.twist_deg.3``. ``blank`` leaves
the structure (hashable, a static argument of a compiled function) and ``fill`` puts numbers of any kind,
traced ones included, back in.
"""

import difflib
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, TypeVar

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import Part, keys_of

PartT = TypeVar("PartT", bound=Part)

_UNITS = {  # suffix of a key -> OpenMDAO unit; a longer suffix comes before its own tail
    "_kg_m3": "kg/m**3",
    "_kg_m2": "kg/m**2",
    "_kgm2": "kg*m**2",
    "_1_per_s": "1/s",
    "_per_rad": "1/rad",
    "_m_s": "m/s",
    "_deg": "deg",
    "_m2": "m**2",
    "_kg": "kg",
    "_Pa": "Pa",
    "_m": "m",
    "_N": "N",
    "_W": "W",
}


class VariableBox(NamedTuple):
    """The design variables of a definition, one entry each."""

    names: tuple[str, ...]
    paths: tuple[str, ...]
    lower: tuple[float, ...]
    baseline: tuple[float, ...]
    upper: tuple[float, ...]
    ref: tuple[float, ...]
    units: tuple[str | None, ...]


def numbers(aircraft: Aircraft) -> dict[str, Any]:
    """Every number of the definition by path, in the order of the schema.

    Floats only: integers, switches, text, coordinates of airfoils and absent numbers are structure. The values
    are floats, or whatever ``fill`` has put in.
    """
    return dict(_numbers(aircraft, ""))


def replace_numbers(aircraft: Aircraft, values: Mapping[str, Any]) -> Aircraft:
    """A copy with some numbers replaced, NOT validated: any object goes, a traced number included.

    Raises:
        KeyError: a path is not a number of this definition; the message names the nearest ones.
    """
    present = numbers(aircraft)
    for path in values:
        if path not in present:
            raise KeyError(f"{path!r} is no number of {aircraft.name!r}{suggest(path, present)}")
    return fill(aircraft, [values.get(path, old) for path, old in present.items()])


def blank(aircraft: Aircraft) -> Aircraft:
    """The structure alone: every number 0.0. Hashable; equal for two aircraft that differ in numbers only."""
    return _rebuild(aircraft, lambda: 0.0)


def fill(structure: Aircraft, values: Sequence[Any]) -> Aircraft:
    """Put numbers into a structure, in the order of ``numbers``; any objects, nothing is validated.

    Raises:
        ValueError: too few or too many values.
    """
    count, supply = len(values), iter(values)
    try:
        filled = _rebuild(structure, partial(next, supply))
    except StopIteration:
        raise ValueError(f"{count} values for {len(numbers(structure))} numbers") from None
    if next(supply, supply) is not supply:
        raise ValueError(f"{count} values for {len(numbers(structure))} numbers")
    return filled


def unit_of(path: str) -> str | None:
    """OpenMDAO unit of the number at a path, by the suffix of its key; None: dimensionless."""
    key = next(segment for segment in reversed(path.split(".")) if not segment.isdigit())
    if key == "rpm":
        return "rpm"
    return next((unit for suffix, unit in _UNITS.items() if key.endswith(suffix)), None)


def variable_box(aircraft: Aircraft) -> VariableBox:
    """Names, paths, bounds, baseline values, scales and units of the design variables."""
    present = numbers(aircraft)
    rows = [
        (v.name, v.path, v.lower, present[v.path], v.upper, _ref(v.lower, v.upper, v.ref), unit_of(v.path))
        for v in aircraft.variables
    ]
    return VariableBox(*(tuple(column) for column in zip(*rows, strict=True))) if rows else VariableBox(*[()] * 7)


def suggest(word: str, known: Mapping[str, Any] | Sequence[str]) -> str:
    """``; did you mean ...?`` with the nearest known words, or nothing."""
    near = difflib.get_close_matches(word, list(known), n=3, cutoff=0.6)
    return f"; did you mean {' or '.join(near)}?" if near else ""


def _ref(lower: float, upper: float, ref: float | None) -> float:
    """The driver's scale of a variable."""
    return ref if ref is not None else max(math.fabs(lower), math.fabs(upper))


def _numbers(part: Part, prefix: str) -> Iterator[tuple[str, Any]]:
    """Walk the numbers of a part."""
    for name, key in keys_of(type(part)).items():
        value, path = getattr(part, name), prefix + name
        if value is None:
            continue
        if key.kind == "number":
            yield path, value
        elif key.kind == "numbers":
            yield from ((f"{path}.{i}", v) for i, v in enumerate(value))
        elif key.kind == "table":
            yield from _numbers(value, path + ".")
        elif key.kind == "tables":
            for entry in value:
                yield from _numbers(entry, f"{path}.{entry.name}.")


def _rebuild(part: PartT, supply: Any) -> PartT:
    """Copy a part, taking each number from the supply."""
    update: dict[str, Any] = {}
    for name, key in keys_of(type(part)).items():
        value = getattr(part, name)
        if value is None:
            continue
        if key.kind == "number":
            update[name] = supply()
        elif key.kind == "numbers":
            update[name] = tuple([supply() for _ in value])
        elif key.kind == "table":
            update[name] = _rebuild(value, supply)
        elif key.kind == "tables":
            update[name] = tuple([_rebuild(entry, supply) for entry in value])
    return part.model_copy(update=update)
