"""Reference quantities derived from the planform, in plain arithmetic that works on traced numbers too."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.surfaces import Wing


class SectionPlace(NamedTuple):
    """Leading edge of a wing section [m] in geometry axes."""

    x: Any
    y: Any
    z: Any


def wing_sections(wing: Wing, tan: Callable[[Any], Any] = math.tan) -> tuple[SectionPlace, ...]:
    """Leading edges of the sections, untwisted, from the root to the tip.

    The quarter-chord line is straight between sections: x_q = x_q,inner + dy tan(sweep),
    z = z_inner + dy tan(dihedral).

    Args:
        wing: the wing.
        tan: tangent of an angle in radians; pass ``jax.numpy.tan`` when the numbers are traced.
    """
    rad = math.pi / 180.0
    places = [SectionPlace(wing.x_le_root_m, wing.section[0].y_m, wing.z_root_m)]
    for inner, outer in zip(wing.section[:-1], wing.section[1:], strict=True):
        if outer.x_le_m is not None and outer.z_m is not None:
            places.append(SectionPlace(outer.x_le_m, outer.y_m, outer.z_m))
            continue
        sweep = 0.0 if outer.sweep_quarter_deg is None else outer.sweep_quarter_deg
        dihedral = 0.0 if outer.dihedral_deg is None else outer.dihedral_deg
        dy = outer.y_m - inner.y_m
        x = places[-1].x + 0.25 * (inner.chord_m - outer.chord_m) + dy * tan(sweep * rad)
        places.append(SectionPlace(x, outer.y_m, places[-1].z + dy * tan(dihedral * rad)))
    return tuple(places)


def wing_area(wing: Wing) -> Any:
    """Planform area of both sides [m2]: sum of (c1 + c2) dy."""
    return sum((a.chord_m + b.chord_m) * (b.y_m - a.y_m) for a, b in _panels(wing))


def wing_span(wing: Wing) -> Any:
    """Projected span [m]."""
    return 2.0 * wing.section[-1].y_m


def wing_mac(wing: Wing) -> Any:
    """Mean aerodynamic chord [m]: 2/S times the integral of c^2 over the semispan."""
    square = sum(
        (a.chord_m**2 + a.chord_m * b.chord_m + b.chord_m**2) * (b.y_m - a.y_m) / 3.0 for a, b in _panels(wing)
    )
    return 2.0 * square / wing_area(wing)


def wing_quarter_mac(wing: Wing, tan: Callable[[Any], Any] = math.tan) -> SectionPlace:
    """Quarter of the mean aerodynamic chord [m]: the mean of the quarter-chord line, weighted by the chord.

    y is 0; ``tan`` as in ``wing_sections``.
    """
    places = wing_sections(wing, tan)
    x_sum = z_sum = 0.0
    for (a, b), p, q in zip(_panels(wing), places[:-1], places[1:], strict=True):
        inner, outer = (2.0 * a.chord_m + b.chord_m) / 6.0, (a.chord_m + 2.0 * b.chord_m) / 6.0
        dy = b.y_m - a.y_m
        x_sum = x_sum + dy * (inner * (p.x + 0.25 * a.chord_m) + outer * (q.x + 0.25 * b.chord_m))
        z_sum = z_sum + dy * (inner * p.z + outer * q.z)
    half_area = 0.5 * wing_area(wing)
    return SectionPlace(x_sum / half_area, 0.0, z_sum / half_area)


def reference_S(aircraft: Aircraft) -> Any:
    """Reference area [m2]: as given, else the wing's. ValueError when there is neither."""
    given = aircraft.reference.S_m2
    return given if given is not None else wing_area(_wing(aircraft, "S_m2"))


def reference_c(aircraft: Aircraft) -> Any:
    """Reference chord [m]: as given, else the wing's mean chord. ValueError when there is neither."""
    given = aircraft.reference.c_m
    return given if given is not None else wing_mac(_wing(aircraft, "c_m"))


def reference_b(aircraft: Aircraft) -> Any:
    """Reference span [m]: as given, else the wing's. ValueError when there is neither."""
    given = aircraft.reference.b_m
    return given if given is not None else wing_span(_wing(aircraft, "b_m"))


def _wing(aircraft: Aircraft, key: str) -> Wing:
    """The wing, or the reason why there is no reference."""
    if aircraft.wing is None:
        raise ValueError(f"{aircraft.name!r} has neither reference.{key} nor a wing")
    return aircraft.wing


def _panels(wing: Wing) -> list[tuple[Any, Any]]:
    """Neighbouring sections."""
    return list(zip(wing.section[:-1], wing.section[1:], strict=True))
