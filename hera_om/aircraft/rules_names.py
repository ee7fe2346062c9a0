"""Rules on names, references between tables, and design variables."""

from collections.abc import Iterable, Iterator, Mapping

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.paths import numbers, suggest, unit_of
from hera_om.aircraft.rules import Finding
from hera_om.aircraft.rules_surfaces import airfoil_holders, names_of_surfaces
from hera_om.aircraft.structure import shipped_materials
from hera_om.aircraft.surfaces import AIRFOIL_TEXT
from hera_om.core.registry import OUTPUTS

BUILT_IN = ("wing", "htail", "vtail", "fuselage", "rotors")
"""Parts that have names already, in tables of their own or in outputs by part."""


def name_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Names used twice and references to what does not exist."""
    yield from _duplicates(aircraft)
    yield from _references(aircraft)
    yield from _tracks(aircraft)


def variable_findings(aircraft: Aircraft) -> Iterator[Finding]:
    """Design variables: their paths, bounds and baselines."""
    present = numbers(aircraft)
    owners: dict[str, str] = {}
    for v in aircraft.variables:
        key = f"variables.{v.name}"
        if v.name in OUTPUTS:
            yield Finding(f"{key}.name", v.name, "a name that is not an output of the analysis", "output name")
        if v.path not in present or v.path.startswith("variables."):
            known = [p for p in present if not p.startswith("variables.")]
            expected = f"the path of a number that is present in the definition{suggest(v.path, known)}"
            yield Finding(f"{key}.path", v.path, expected, "path")
            continue
        if v.path in owners:
            yield Finding(f"{key}.path", v.path, f"a path that variable {owners[v.path]} has not taken", "path twice")
        owners.setdefault(v.path, v.name)
        yield from _bounds(key, v.lower, present[v.path], v.upper, v.path)


def _bounds(key: str, lower: float, baseline: float, upper: float, path: str) -> Iterator[Finding]:
    """Bounds in order, baseline between them."""
    if lower >= upper:
        yield Finding(f"{key}.lower", lower, f"less than the upper bound {upper:g}", "bounds reversed")
    elif not lower <= baseline <= upper:
        unit = unit_of(path) or "-"
        expected = f"between the bounds {lower:g} and {upper:g} [{unit}] of {key}"
        yield Finding(path, baseline, expected, "baseline")


def _duplicates(aircraft: Aircraft) -> Iterator[Finding]:
    """Names that stand twice in one array of tables."""
    arrays: dict[str, tuple] = {
        "wing.section": aircraft.wing.section if aircraft.wing else (),
        "drag_area": aircraft.drag_area,
        "rotor": aircraft.rotor,
        "blade": aircraft.blade,
        "mass": aircraft.mass,
        "material": (*aircraft.material, *aircraft.laminate),
        "variables": aircraft.variables,
        "surface": aircraft.surface,
        "airfoil": aircraft.airfoil,
        **dict(names_of_surfaces(aircraft)),
    }
    for path, entries in arrays.items():
        names = [entry.name for entry in entries]
        for name in dict.fromkeys(n for n in names if names.count(n) > 1):
            expected = f"a name that stands once among [[{path}]], not {names.count(name)} times"
            yield Finding(f"{path}.{name}.name", name, expected, "duplicate")
    for surface in aircraft.surface:
        if surface.name in BUILT_IN:
            expected = f"another name than {', '.join(BUILT_IN)}, which name other parts"
            yield Finding(f"surface.{surface.name}.name", surface.name, expected, "duplicate")
    for airfoil in aircraft.airfoil:
        if airfoil.name.lower() == "flat":
            yield Finding(f"airfoil.{airfoil.name}.name", airfoil.name, "another name than flat", "duplicate")


def _references(aircraft: Aircraft) -> Iterator[Finding]:
    """Names of blades, materials, rotor groups and airfoils."""
    yield from _airfoils(aircraft)
    blades = [b.name for b in aircraft.blade]
    groups = [r.name for r in aircraft.rotor]
    for rotor in aircraft.rotor:
        yield from _reference(f"rotor.{rotor.name}.blade", rotor.blade, blades, "blade")
    for i, failed in enumerate(aircraft.flight.failed):
        yield from _reference(f"flight.failed[{i}].rotor", failed.rotor, groups, "rotor")
    for area in aircraft.drag_area:
        if area.rotor is not None:
            yield from _reference(f"drag_area.{area.name}.rotor", area.rotor, groups, "rotor")
        if area.rotor is not None and area.y_m is not None:
            yield Finding(f"drag_area.{area.name}.y_m", area.y_m, "either y_m or rotor, not both", "either or")
    if aircraft.wing and aircraft.wing.structure:
        own: Mapping[str, object] = {m.name: m for m in (*aircraft.material, *aircraft.laminate)}
        known = list(own | shipped_materials())
        yield from _reference("wing.structure.material", aircraft.wing.structure.material, known, "material")


def _airfoils(aircraft: Aircraft) -> Iterator[Finding]:
    """Airfoils of sections and tails."""
    own = [a.name for a in aircraft.airfoil]
    for key, name in airfoil_holders(aircraft):
        if name != "flat" and not name.startswith("NACA ") and name not in own:
            yield Finding(key, name, AIRFOIL_TEXT + suggest(name, [*own, "flat"]), "reference")


def _reference(key: str, name: str, known: Iterable[str], table: str) -> Iterator[Finding]:
    """One reference by name."""
    known = list(known)
    if name not in known:
        listed = f"one of {', '.join(known)}" if known else "there is none"
        yield Finding(key, name, f"the name of a [[{table}]]: {listed}{suggest(name, known)}", "reference")


def _tracks(aircraft: Aircraft) -> Iterator[Finding]:
    """What mass items follow must exist, and only one item can be the wing or a tail."""
    present = {"wing": aircraft.wing, "htail": aircraft.htail, "vtail": aircraft.vtail, "fuel": True}
    known = [k for k, v in present.items() if v] + [f"rotor:{r.name}" for r in aircraft.rotor]
    taken: set[str] = set()
    for mass in aircraft.mass:
        if mass.tracks is None:
            continue
        key = f"mass.{mass.name}.tracks"
        if mass.tracks not in known:
            yield Finding(key, mass.tracks, f"what this aircraft has: {', '.join(known)}", "reference")
        elif mass.tracks in taken and mass.tracks in ("wing", "htail", "vtail"):
            yield Finding(key, mass.tracks, f"one item that tracks {mass.tracks}, not two", "tracks twice")
        taken.add(mass.tracks)
