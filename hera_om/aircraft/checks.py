"""Cross-field checks of a typed definition, at its baseline and at the corners of its variables' box."""

import itertools
from collections.abc import Iterator

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import key_at
from hera_om.aircraft.mission import Variable
from hera_om.aircraft.paths import fill, numbers
from hera_om.aircraft.report import expectation
from hera_om.aircraft.rules import Finding
from hera_om.aircraft.rules_geometry import geometry_findings
from hera_om.aircraft.rules_names import name_findings, variable_findings
from hera_om.aircraft.rules_rotors import rotor_findings
from hera_om.aircraft.rules_surfaces import surface_findings
from hera_om.core.errors import Problem

_MOST_VARIABLES_FOR_ALL_CORNERS = 8  # 2^8 corners take about 0.2 s


def find_problems(aircraft: Aircraft, file: str) -> list[Problem]:
    """Every inconsistency of names, of geometry at the baseline, of variables, of geometry in their corners.

    Geometry is only looked at where names are sound, corners only where geometry and variables are: what
    follows from another fault would bury it.
    """
    found = list(name_findings(aircraft))
    if not found:
        found = [*_number_findings(aircraft), *variable_findings(aircraft)]
    if not found:
        found = _corner_findings(aircraft)
    return [Problem(file, f.key, f.value, f.expected) for f in dict.fromkeys(found)]


def _number_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Every rule that depends on numbers."""
    yield from geometry_findings(aircraft)
    yield from surface_findings(aircraft)
    yield from rotor_findings(aircraft)


def _corner_findings(aircraft: Aircraft) -> list[Finding]:
    """What goes wrong inside the box of the variables only; each fault once, at its simplest corner."""
    found: dict[tuple[str, str], Finding] = {}
    present = numbers(aircraft)
    for finding in _range_findings(aircraft):
        found.setdefault((finding.key, "range"), finding)
    if found:
        return list(found.values())
    for corner in _corners(aircraft.variables):
        values = present | {v.path: bound for v, bound in corner}
        for f in _number_findings(fill(aircraft, list(values.values()))):
            where = ", ".join(f"{v.name} = {bound:g}" for v, bound in corner)
            at_corner = Finding(f.key, f.value, f"{f.expected} (at the corner {where} of the variables)", f.rule)
            found.setdefault((f.key, f.rule), at_corner)
    return list(found.values())


def _range_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Bounds that a number may not take by its own range."""
    for v in aircraft.variables:
        key = key_at(Aircraft, v.path)
        if key is None:
            continue
        for side, bound in (("lower", v.lower), ("upper", v.upper)):
            if not key.admits(bound):
                yield Finding(f"variables.{v.name}.{side}", bound, f"for {v.path}: {expectation(key, v.path)}", "range")


def _corners(variables: tuple[Variable, ...]) -> Iterator[list[tuple[Variable, float]]]:
    """One variable at a time, then all combinations of bounds while they are few."""
    for v in variables:
        yield from ([(v, v.lower)], [(v, v.upper)])
    if 2 <= len(variables) <= _MOST_VARIABLES_FOR_ALL_CORNERS:
        for bounds in itertools.product(*((v.lower, v.upper) for v in variables)):
            yield list(zip(variables, bounds, strict=True))
