"""Write docs/wing_mass_tables.md: build-up of the wing masses, their spread, exponents beside published methods.

python docs/make_wing_mass.py
"""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

from hera_om.aircraft import load_aircraft
from hera_om.aircraft.paths import numbers, replace_numbers, variable_box
from hera_om.components.build_up import secondary_areas
from hera_om.models import build_aircraft

sys.path.insert(0, str(Path(__file__).parent))
import wing_mass_methods as published

OUT = Path(__file__).with_name("wing_mass_tables.md")
AIRCRAFT = ("atr72", "q400", "hera_like")
STEP = 0.05
VARIED = ("span", "ultimate factor", "thickness")
MANOEUVRE = "manoeuvre factor alone"
BOX = ("skins", "webs", "caps", "stringers", "ribs", "centre_section", "primary")


def sized(aircraft) -> tuple[Any, dict[str, Any]]:
    """The trimmed and sized aircraft, and everything that its box knows."""
    problem = build_aircraft(aircraft)
    problem.run_model()
    return problem, problem.model.wing_box.last


def built(box: dict[str, Any]) -> float:
    """Mass by the build-up, whatever the rule of the definition, kg."""
    whole = box["build_up"]
    return float(box["m_primary"]) + float(sum(whole.penalties)) + float(sum(whole.secondary))


def changed(aircraft, what: str, factor: float, given: bool):
    """The definition with one thing changed, the span at constant area; the ultimate factor in all cases, gusts too.

    Caps and stringers stay as given, or follow the rule of the definitions, n W b / h.
    """
    path_of = numbers(aircraft)
    values: dict[str, float] = {}

    def scale(names, by):
        values.update({p: path_of[p] * by for p in path_of if p in names})

    sections = [f"wing.section.{s.name}" for s in aircraft.wing.section]
    if what == "span":
        along = [f"{s}.y_m" for s in sections] + [f"rotor.{r.name}.y_m" for r in aircraft.rotor]
        along += [f"wing.{part}.{end}" for part in ("control.flap", "control.aileron") for end in ("y0_m", "y1_m")]
        scale([*along, "wing.fuel_tank.y1_m"], factor)
        scale([f"{s}.chord_m" for s in sections], 1.0 / factor)
    elif what == "thickness":
        scale([f"{s}.thickness" for s in sections], factor)
    elif what == MANOEUVRE:
        scale(["mission.limit_load_factor"], factor)
    else:
        scale(["mission.reserve_factor"], factor)
    if not given:
        follow = {"span": factor**2, "thickness": 1.0 / factor}.get(what, factor)
        scale(["wing.structure.A_cap_root_m2", "wing.structure.A_stringer_root_m2"], follow)
    return replace_numbers(aircraft, values)


def exponent(mass) -> float:
    """d ln m / d ln x of mass(factor), by a central difference."""
    return math.log(mass(1 + STEP) / mass(1 - STEP)) / math.log((1 + STEP) / (1 - STEP))


def own_exponents(aircraft, given: bool) -> dict[str, float]:
    """Exponents of the sized and built-up mass."""

    def mass(what):
        return lambda factor: built(sized(changed(aircraft, what, factor, given))[1])

    return {what: exponent(mass(what)) for what in (*VARIED, MANOEUVRE)}


def published_exponents(wing: published.Wing) -> dict[str, dict[str, float]]:
    """Exponents of the published methods at the same wing."""
    return {
        name: {what: exponent(lambda f, w=what, m=method: m(published.varied(wing, w, f))) for what in VARIED}
        for name, method in published.METHODS.items()
    }


def wing_of(aircraft, box: dict[str, Any]) -> published.Wing:
    """The wing as the published methods see it."""
    areas, sections, mission = secondary_areas(aircraft), aircraft.wing.section, aircraft.mission
    items = {m.name: m.m_kg for m in aircraft.mass}
    total, fuel = sum(items.values()), sum(m.m_kg for m in aircraft.mass if m.tracks == "fuel")
    y, chord = ([getattr(s, k) for s in sections] for k in ("y_m", "chord_m"))
    return published.Wing(
        mass=total,
        zero_fuel=total - fuel - items["wing"],
        span=2 * y[-1],
        area=2 * float(np.trapezoid(chord, y)),
        thickness=sections[0].thickness,
        root_chord=chord[0],
        taper=chord[-1] / chord[0],
        ultimate=mission.limit_load_factor * mission.reserve_factor,
        V_D=mission.V_D_EAS_m_s,
        control_area=float(areas.flaps) + float(areas.ailerons),
    )


def spread(aircraft, box: dict[str, Any]) -> dict[str, float]:
    """Wing mass by other readings of the sources, and by other sources, kg."""
    whole, areas, wing = box["build_up"], secondary_areas(aircraft), wing_of(aircraft, box)
    primary, p, s = float(box["m_primary"]), whole.penalties, whole.secondary
    penalties, secondary = float(sum(p)), float(sum(s))
    fixed = float(p.engines + p.gear + p.fuselage)
    older = primary * (published.joints_1976(wing.span) * published.stiffness_1976(wing) - 1.0) + fixed
    edges = (float(v) for v in (areas.leading, areas.trailing, areas.flaps, areas.ailerons))
    exposed = float(areas.leading) / aircraft.wing.structure.front_spar
    support = {"hinge": 1.0, "link": 1.2, "track": 1.6}[aircraft.wing.structure.flap_support]
    flaps = 1.1 * float(s.flaps) / support
    return {
        "before: primary / 0.85": primary / 0.85,
        "adopted: Torenbeek 2013": primary + penalties + secondary,
        "- without the stiffness term": primary + penalties + secondary - float(p.stiffness),
        "- without terms read in one program alone (joints, gear, stiffness)": primary
        + penalties
        + secondary
        - float(p.joints + p.gear + p.stiffness),
        "- flaps on the lightest support, one slot": primary + penalties + secondary - 1.1 * float(s.flaps) + flaps,
        "- flaps on tracks, two slots": primary + penalties + secondary - 1.1 * float(s.flaps) + 2.4 * flaps,
        "- penalties of Torenbeek 1976, eq. C-2 and C-4": primary + older + secondary,
        "- secondary structure of LR-693 (1992)": primary + penalties + published.secondary_1992(wing.mass, *edges),
        "- secondary structure of FAST-OAD-RTA": primary + penalties + published.secondary_rta(wing.mass, exposed),
        "TASOPT's shares of the box": primary * (1 + published.TASOPT),
        **{f"statistics: {name}": method(wing) for name, method in published.METHODS.items()},
    }


def corner(problem) -> list[str]:
    """RFC and RFT over the areas of caps and stringers, at the loads of the baseline."""
    component, bounds = problem.model.wing_box, variable_box(problem.model.wing_box.options["aircraft"])
    evaluate, values = component.call()[0], component.values(component._inputs)
    fixed = component.structure, component.statics, tuple(component.paths.items()), component.base, component.constants
    ends = {n: (bounds.lower[i], bounds.baseline[i], bounds.upper[i]) for i, n in enumerate(bounds.names)}
    lines = ["| A_cap_root [cm2] | A_stringer_root [cm2] | RFC | RFT |", "|---|---|---|---|"]
    for cap in ends["A_cap_root"]:
        for stringer in ends["A_stringer_root"]:
            areas = {"A_cap_root": np.asarray(cap), "A_stringer_root": np.asarray(stringer)}
            found = evaluate(*fixed, values | areas)
            numbers_ = f"{float(found['RFC']):.3f} | {float(found['RFT']):.3f}"
            lines.append(f"| {1e4 * cap:g} | {1e4 * stringer:g} | {numbers_} |")
    return lines


def main() -> None:
    """Size, compare, write."""
    fleet = {name: load_aircraft(name) for name in AIRCRAFT}
    found = {name: sized(aircraft) for name, aircraft in fleet.items()}
    boxes = {name: box for name, (_, box) in found.items()}
    head = ["| kg | " + " | ".join(AIRCRAFT) + " |", "|---" * (len(AIRCRAFT) + 1) + "|"]

    def row(label, values, form="{:.0f}"):
        return f"| {label} | " + " | ".join(form.format(float(v)) for v in values) + " |"

    lines = ["# Wing masses: tables made by docs/make_wing_mass.py", "", "## Build-up", "", *head]
    lines += [row(f"box: {p.replace('_', ' ')}", (b[f"m_{p}"] for b in boxes.values())) for p in BOX]
    for kind in ("penalties", "secondary"):
        for i, part in enumerate(getattr(boxes["atr72"]["build_up"], kind)._fields):
            values = (getattr(b["build_up"], kind)[i] for b in boxes.values())
            lines.append(row(f"{kind}: {part.replace('_', ' ')}", values))
    lines += [row("**built up**", (built(b) for b in boxes.values()))]
    lines += [row("frozen remainder of the definition", (b["m_remainder"] for b in boxes.values()))]
    lines += [row("**m_wing by the definition's rule**", (b["m_wing"] for b in boxes.values()))]
    spreads = [spread(fleet[name], boxes[name]) for name in AIRCRAFT]
    lines += ["", "## Spread", "", *head, *(row(key, (s[key] for s in spreads)) for key in spreads[0])]
    lines += [
        "",
        "## Exponents of the wing mass, ATR 72",
        "",
        "| | " + " | ".join((*VARIED, MANOEUVRE)) + " |",
        "|---|---|---|---|---|",
    ]
    wing = wing_of(fleet["atr72"], boxes["atr72"])
    table = {
        "sized, areas of caps and stringers given": own_exponents(fleet["atr72"], True),
        "sized, areas by n W b / h": own_exponents(fleet["atr72"], False),
        **published_exponents(wing),
    }
    for name, values in table.items():
        lines.append(row(name, values.values(), "{:+.2f}") + ("" if MANOEUVRE in values else " |"))
    lines += ["", "## Reserve factors over the areas, HERA-like aircraft, loads of the baseline", ""]
    lines += corner(found["hera_like"][0])
    OUT.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(OUT.read_text("utf-8"))


if __name__ == "__main__":
    main()
