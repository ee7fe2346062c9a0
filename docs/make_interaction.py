"""Write docs/interaction.md and its pictures: Tables 2 and 3 beside the paper's, and runs that isolate causes.

Run as ``python docs/make_interaction.py``. It changes constants of the physics, so it keeps no programs.
"""

import argparse
import importlib.util
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from hera_om.aircraft import Aircraft, load_aircraft
from hera_om.components import aero, aero_stages, arrays
from hera_om.physics import aerodynamics, coupling, slipstream
from hera_om.physics.geometry import surface_mesh
from hera_om.physics.lattice_forces import pressure_cells
from hera_om.post.figures_interaction import plot_propeller, save, write_figures
from hera_om.studies import interaction as study
from hera_om.studies.snapshot import panel_pressures

ROOT = Path(__file__).resolve().parents[1]
RAD = np.pi / 180.0
ALPHAS = (0.0, 5.0, 10.0)
Found = dict[str, dict[float, dict[str, Any]]]

HEAD = """# What rotors, wing and tail do to each other

Written by `python docs/make_interaction.py`; do not edit. The same numbers, without the runs that isolate causes,
come from `hera-om interaction hera_like`. The aircraft is not the paper's, whose geometry is not public: it is an open
one of its class, frozen before this comparison. So signs and percent changes are compared, not values; what differs by
more than a factor of 1.5 or in sign (bold) has a run below that isolates its cause.

Slopes are those of the chord from 0 to 5 degrees, per degree, as in the paper. Moments are about the centre of
gravity, nose up positive, on the definition's reference area and chord in all configurations. Changes are in percent of
the size of the first row's number. L/D is that of the wing: forces at the hubs are not in it. Thrust is along the
shafts, all six rotors.
"""
SUCTION = """\
With our CL the paper's L/D at 0 and 5 degrees asks for CD = {base:.4f} + {k:.4f} CL²: an efficiency of {e:.2f} on our
aspect ratio. At 10 degrees this parabola gives {at_10:.2f}, the paper has {paper_10:.2f}. Profile drag does not
explain it: as much constant drag as gives 14.33 at 0 degrees gives {constant:.1f} at 5, where the paper has 11.01. So
it is drag due to lift: an elliptic load has an efficiency of 1, ours has nearly that, and the column without suction
takes the normal pressures of the same panels alone. The paper does not say what its drag consists of.
"""
AREA = """\
The paper's wing (full less tail less body) has a slope of 0.053 per degree or 3.0 per rad on its reference area; a
straight wing of aspect ratio 12 has 5.4 on its own (lifting line, 2π A / (A + 2)). So the reference area is larger
than such a wing, or the wing is of another kind; the tail's slope agrees. Runs: Mach number 0, without any effect of
compressibility; and besides, the reference area and the tail's area times {k:.3f}, which makes the wing smaller
beside both, with the chord as above.
"""
CENTRE = """\
Table 3 does not say what its moments refer to. About a point {back:.3f} of that chord farther aft, chosen so that the
first row's slope is the paper's, slope and change of fuselage and tail come out as the paper's; the tail's own slopes
hardly move, and the rotors' change, which their forces far ahead of any such point make, is not explained by it:
"""
INSTALLED = """\
ΔL/D is swirl that the wing recovers: it goes with the swirl, is gone with the other sense of
rotation, and grows with thrust. At 5 degrees the rotors' own lift, which is not in this L/D, turns the slipstreams
down, and that takes back what the swirl gives: see the run without the turn. The paper does not give its thrust;
the runs over blade pitch show what more of it does: at 0 degrees its ΔL/D lies between 2 and 4 degrees more and its ΔT
between 0 and 2, at 5 degrees its ΔL/D lies beyond 4 and its ΔT between 2 and 4. ΔT is the flow of the
wing's thickness, which slows the disks alike at any incidence, and upwash, which grows with incidence; at fixed pitch
either counts the more the less the rotors are loaded. What the thickness gives to the thrust it takes from L/D, as drag
in the pressure of the slipstream. ΔCZ_α and ΔCm_α are mostly forces at the hubs, normal to the shafts and ahead of
the centre of gravity: the split by part shows that what slipstreams do to surfaces is a third to a half of the paper's
changes, the forces of the rotors themselves are beyond them.
"""
TAIL = """\
The tail stands at z = {z:g} m, above the slipstreams of rotors on a wing at {wing:g} m. Height alone changes size and
sign of what the rotors do to the tail's slope:
"""
TAIL_HEIGHTS = (-0.5, 1.0, 2.0, 3.0, 4.0, 4.5, 7.0)
COLUMNS = {
    "L_over_D isolated": "L/D wing alone",
    "L_over_D": "L/D",
    "L_over_D change": "ΔL/D [%]",
    "thrust change": "ΔT [%]",
    "CZ_alpha": "CZ_α",
    "CZ_alpha change": "ΔCZ_α [%]",
    "Cm_alpha": "Cm_α",
    "Cm_alpha change": "ΔCm_α [%]",
    "CZ_tail_alpha": "CZ_tail,α",
    "CZ_tail_alpha change": "ΔCZ_tail,α [%]",
    "Cm_tail_alpha": "Cm_tail,α",
    "Cm_tail_alpha change": "ΔCm_tail,α [%]",
}


@contextmanager
def switched(**constants: Any) -> Iterator[None]:
    """Constants and functions of `physics.coupling` and `slipstream` changed for the runs inside, wherever imported."""
    before = {name: getattr(coupling, name, getattr(slipstream, name, None)) for name in constants}
    try:
        _set(constants)
        yield
    finally:
        _set(before)


def _set(constants: Mapping[str, Any]) -> None:
    """Change constants; what was compiled or kept with others is thrown away."""
    for name, value in constants.items():
        for module in (coupling, aerodynamics, slipstream):
            if hasattr(module, name):
                setattr(module, name, value)
    aero_stages.stages.cache_clear()
    for store in (aero._systems, aero._states, aero._tangents):
        store.clear()


def without_swirl(rotors, plan, wake, *places, **named):
    """`disks.mean_slipstreams` of slipstreams that do not turn."""
    return _slipstreams(rotors, plan, wake._replace(swirl=0.0 * wake.swirl), *places, **named)


_slipstreams = coupling.mean_slipstreams


def each_rotor(aircraft: Aircraft, **changes: Any) -> Aircraft:
    """The aircraft with numbers of all its rotor groups changed; a callable makes the new from the old."""
    groups = tuple(
        r.model_copy(update={k: v(getattr(r, k)) if callable(v) else v for k, v in changes.items()})
        for r in aircraft.rotor
    )
    return aircraft.model_copy(update={"rotor": groups})


def part(aircraft: Aircraft, name: str, **changes: Any) -> Aircraft:
    """The aircraft with numbers of one part changed, if it has that part."""
    old = getattr(aircraft, name)
    return aircraft if old is None else aircraft.model_copy(update={name: old.model_copy(update=changes)})


class Runs:
    """Cases of one aircraft, their states, and tables of changed cases."""

    def __init__(self, aircraft: Aircraft) -> None:
        self.cases = study.configurations(aircraft)
        self.found = study.states(self.cases, ALPHAS)

    def changed(self, change, names: Iterable[str]) -> Found:
        """States with a change of the aircraft in some configurations; the others keep theirs."""
        print(f"  {getattr(change, '__name__', change)} {names}", flush=True)
        return self.found | study.states({n: change(self.cases[n]) for n in names}, ALPHAS[:2])

    def switched(self, names, **constants: Any) -> Found:
        """States with constants of the coupling changed."""
        with switched(**constants):
            return self.changed(lambda case: case, names)


def pick(found: Found) -> dict[str, Any]:
    """The numbers of both tables by row."""
    rows = [*study.table2(found, ALPHAS[:2]), *study.table3(found, ALPHAS[:2])]
    return {row["case"]: row["ours"] for row in rows}


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Markdown."""
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(r) + " |" for r in rows), ""]


def compared(rows: list[dict[str, Any]], names: tuple[str, ...]) -> list[str]:
    """Ours beside the paper's, those far off in bold."""
    far = {(d["case"], d["quantity"]) for d in study.differences(rows)}
    lines = []
    for row in rows:
        cells = [row["case"]]
        for name in names:
            ours, theirs = row["ours"][name], row["paper"].get(name)
            cell = f"{ours:.4g} / {'–' if theirs is None else f'{theirs:.4g}'}"
            cells.append(f"**{cell}**" if (row["case"], name) in far else cell)
        lines.append(cells)
    return table(["ours / paper", *(COLUMNS.get(n, n) for n in names)], lines)


def runs_table(
    cases: Mapping[str, Mapping[str, Any]], row: str, names: tuple[str, ...], paper: bool = True
) -> list[str]:
    """One row of a table under several changes."""
    lines = [[label, *(f"{found[row][n]:.4g}" for n in names)] for label, found in cases.items()]
    if paper:
        theirs = study.PAPER_3.get(row) or study.PAPER_2[float(row.split()[0])]
        lines.append(["paper", *(f"{theirs[n]:.4g}" if n in theirs else "–" for n in names)])
    return table([row, *(COLUMNS.get(n, n) for n in names)], lines)


# --- the wing's L/D


def pressure_alone(wing: Aircraft, alpha: float) -> tuple[float, float]:
    """CL and CD of pressures on the panels alone: no suction at the leading edge, no friction."""
    at = arrays.grids(wing)[0]
    surface = arrays.surfaces(wing, [at])[0]
    mesh = surface_mesh(surface.sections, surface.grid, arrays.model(wing, False).shape)
    cells = np.asarray(pressure_cells(mesh, surface.grid.rear))
    area = np.cross(cells[1:, 1:] - cells[:-1, :-1], cells[:-1, 1:] - cells[1:, :-1]) / 2.0
    found = panel_pressures(wing, wing, {"alpha": alpha})[0]
    force = 2.0 * np.einsum("ij,ijk->k", np.asarray(found["pressure"]), area) / float(arrays.reference(wing)[0])
    c, s = np.cos(alpha * RAD), np.sin(alpha * RAD)
    return float(force[2] * c - force[0] * s), float(force[0] * c + force[2] * s)


def lift_over_drag(runs: Runs) -> list[str]:
    """L/D of the wing alone: full suction, none, and the parabola through the paper's first two."""
    wing, rows, points = runs.cases[study.WING], [], []
    for a in ALPHAS:
        state = runs.found[study.WING][a]
        CL, CD = pressure_alone(wing, a)
        theirs = study.PAPER_2[a]["L_over_D isolated"]
        points.append((state["CL"], state["CL"] / theirs))
        none = CL / (CD + state["CD_profile"])
        rows.append([f"{a:g}", f"{state['CL']:.3f}", f"{state['CDi']:.4f}", f"{state['CD_profile']:.4f}"])
        rows[-1] += [f"{state['L_over_D']:.2f}", f"{none:.2f}", f"{theirs:.2f}"]
    (l0, d0), (l5, d5), (l10, d10) = points
    k = (d5 - d0) / (l5**2 - l0**2)
    base = d0 - k * l0**2
    whole: Any = runs.cases[study.FULL].reference
    ours = [runs.found[study.WING][a] for a in ALPHAS]
    constant = l5 / (ours[1]["CD"] + d0 - ours[0]["CD"])
    head = ["α [deg]", "CL", "CDi", "CD profile", "L/D", "L/D without suction", "L/D paper"]
    text = SUCTION.format(
        base=base,
        k=k,
        e=whole.S_m2 / (np.pi * whole.b_m**2 * k),
        at_10=l10 / (base + k * l10**2),
        paper_10=l10 / d10,
        constant=constant,
    )
    return [*table(head, rows), text]


# --- the page


def causes(runs: Runs) -> list[str]:
    """Every run that isolates a cause."""
    base, both = pick(runs.found), (study.FULL, study.WING_DISKS)
    ratio = base[study.CLEAN]["Cm_tail_alpha"] / base[study.CLEAN]["CZ_tail_alpha"]
    theirs = study.PAPER_3[study.CLEAN]
    arm = theirs["Cm_tail_alpha"] / theirs["CZ_tail_alpha"] / ratio
    whole: Any = runs.cases[study.FULL]
    S, c, scale = whole.reference.S_m2, whole.reference.c_m, whole.htail.scale

    def shorter(case):
        return part(case, "reference", c_m=c / arm)

    def incompressible(case):
        state = runs.found[study.FULL][0.0]
        return part(case, "flight", speed_m_s=state["speed"], density_kg_m3=state["density"], mach=0.0)

    def smaller_wing(k):
        return lambda case: part(part(case, "reference", S_m2=k * S, c_m=c / arm), "htail", scale=scale * k**0.5)

    def tail_at(z):
        return lambda case: part(case, "htail", z_m=z)

    def pitched(by):
        return lambda case: each_rotor(case, beta75_deg=lambda v: v + by)

    three = tuple(study.PAPER_3)
    heights = {f"tail at z = {z:g} m": pick(runs.changed(tail_at(z), (study.FULL, study.CLEAN))) for z in TAIL_HEIGHTS}
    mach0 = pick(runs.changed(incompressible, three))
    k = mach0[study.CLEAN]["CZ_alpha"] / theirs["CZ_alpha"]
    scaled = pick(runs.changed(shorter, three))
    small = pick(runs.changed(smaller_wing(k), three))
    rotors = (*both, study.DISKS)
    pitches = {f"blade pitch {by:+g} deg": pick(runs.changed(pitched(by), rotors)) for by in (-2.0, 2.0, 4.0)}
    thrusts = {label: found["0 deg"]["thrust"] for label, found in pitches.items()}
    pitches = {f"{label}, thrust {thrusts[label] / 1000:.1f} kN": found for label, found in pitches.items()}
    switches = {
        "no slipstream at surfaces (`SLIPSTREAM = 0`)": runs.switched(both, SLIPSTREAM=0.0),
        "no upwash at disks (`UPWASH = 0`)": runs.switched(both, UPWASH=0.0),
        "no flow of thickness (`THICKNESS = 0`)": runs.switched(both, THICKNESS=0.0),
        "edges of the jets without answer (`FINITE_JET = 0`)": runs.switched(both, FINITE_JET=0.0),
        "no turn by forces across the shaft (`TURN = 0`)": runs.switched(both, TURN=0.0),
        "slipstream without swirl": runs.switched(both, mean_slipstreams=without_swirl),
        "outboard-up": runs.changed(lambda case: each_rotor(case, sense="outboard-up"), both),
    }
    on = {"as it is": base} | {label: pick(found) for label, found in switches.items()}
    two, three_names = ("L_over_D", "L_over_D change", "thrust change"), ("CZ_alpha change", "Cm_alpha change")
    tail = ("CZ_tail_alpha change", "Cm_tail_alpha change")
    moments = ("Cm_alpha", "Cm_alpha change", "Cm_tail_alpha", "Cm_tail_alpha change")
    forces = ("CZ_alpha", "CZ_alpha change", "CZ_tail_alpha", "CZ_tail_alpha change")
    page = ["## Causes", "", "### L/D of the wing alone", "", *lift_over_drag(runs)]
    page += ["### Changes by installation, Table 2, and by rotors, Table 3", "", INSTALLED]
    for a in ("0 deg", "5 deg"):
        page += runs_table(on | pitches, a, two)
    page += runs_table(on | pitches, study.FULL, (*three_names, *tail))
    page += hub_share(runs)
    page += [
        "### Reference chord and area",
        "",
        "Tail moment over tail force is the tail's arm over the reference chord: ",
    ]
    page[-1] += f"{-ratio:.2f} here, {-arm * ratio:.2f} in the paper. With the chord divided by {arm:.3f}:"
    page += ["", *(line for n in study.PAPER_3 for line in runs_table({"as it is": base, "chord": scaled}, n, moments))]
    back = (theirs["Cm_alpha"] - scaled[study.CLEAN]["Cm_alpha"]) / scaled[study.CLEAN]["CZ_alpha"]
    page += [CENTRE.format(back=back)]
    cases = {"chord": scaled, "chord, point of moments": moved(scaled, back)}
    page += [line for n in study.PAPER_3 for line in runs_table(cases, n, moments)]
    page += [AREA.format(k=k)]
    cases = {"as it is": base, "Mach 0": mach0, "area, tail, chord": small}
    page += [line for n in study.PAPER_3 for line in runs_table(cases, n, (*forces, *moments[:2]))]
    page += ["### Height of the tail", "", TAIL.format(z=whole.htail.z_m, wing=whole.wing.z_root_m)]
    page += runs_table({"as it is": base} | heights, study.FULL, (*forces[2:], *moments[1:]))
    return page


def moved(found: Mapping[str, Mapping[str, Any]], back: float) -> dict[str, dict[str, Any]]:
    """Slopes of moments about a point so much of the reference chord farther aft, and their changes."""
    rows = {n: dict(found[n]) for n in study.PAPER_3}
    for name in ("Cm", "Cm_tail"):
        force = name.replace("Cm", "CZ")
        for row in rows.values():
            row[f"{name}_alpha"] += back * row[f"{force}_alpha"]
        clean = rows[study.CLEAN][f"{name}_alpha"]
        for row in rows.values():
            row[f"{name}_alpha change"] = study.change(row[f"{name}_alpha"], clean)
    return rows


def hub_share(runs: Runs) -> list[str]:
    """What rotors change in slopes, by part, per degree between 0 and 5 degrees, and in percent of the whole."""
    rows, whole = [], {k: study.slopes(runs.found[study.CLEAN], ALPHAS[:2])[f"{k}_alpha"] for k in ("CZ", "Cm")}
    shares = [study.split(runs.found, a) for a in ALPHAS[:2]]
    parts = {n: [s["slipstream"][n] for s in shares] for n in ("wing", "htail", "fuselage")}
    parts["rotors"] = [s["rotors"] for s in shares]
    for name, (first, last) in parts.items():
        by = {k: (last[k] - first[k]) / (ALPHAS[1] - ALPHAS[0]) for k in whole}
        cells = [f"{by[k]:+.5f} ({100 * by[k] / abs(whole[k]):+.2f} %)" for k in whole]
        rows.append([f"{name}{', forces at the hubs' if name == 'rotors' else ', slipstream'}", *cells])
    return ["What rotors add to the slopes, by part:", "", *table(["", "CZ_α [1/deg]", "Cm_α [1/deg]"], rows)]


def parts_tables(found: Found) -> list[str]:
    """Coefficients and derivatives by part at both incidences, per radian."""
    names = ("CX", "CZ", "Cm", "CX_alpha", "CZ_alpha", "Cm_alpha")
    lines = [
        "## Split by part",
        "",
        "Exact derivatives, per radian; the slipstream's share is power-on less power-off.",
        "",
    ]
    for a in ALPHAS[:2]:
        state = study.split(found, a)
        for key in ("power_off", "power_on", "slipstream"):
            rows = [[part_, *(f"{v[n]:+.5f}" for n in names)] for part_, v in state[key].items() if part_ != "vtail"]
            lines += table([f"{key.replace('_', '-')}, {a:g} deg", *names], rows)
    return lines


def propeller(folder: Path) -> Path:
    """NACA 5868-9 over the advance ratio, by the functions of its test."""
    path = ROOT / "tests" / "physics" / "test_rotor_measured.py"
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    test: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(test)
    blade, run = test.naca_propeller(test.NACA_NACELLE)
    cases = []
    for angle in (25, 35):
        data = test.read(f"prop_naca5868_9_beta{angle}.csv")
        J = np.linspace(0.05, data[-1, 0], 45)
        rpm = np.interp(J, data[:, 0], data[:, 4])
        speed = J * rpm / 60.0 * 2.0 * test.NACA_RADIUS
        found = np.array([run(blade, v, w * np.pi / 30.0, np.radians(angle)) for v, w in zip(speed, rpm, strict=True)])
        eta = np.where(found[:, 0] > 0.0, J * found[:, 0] / found[:, 1], np.nan)
        case = {"label": f"{angle}° at 75 % radius", "J": J, "CT": found[:, 0], "CP": found[:, 1], "eta": eta}
        cases.append(case | {f"{k}_data": data[:, i] for i, k in enumerate(("J", "eta", "CT", "CP"))})
    title = "NACA propeller 5868-9, three blades, Report 658"
    return save(plot_propeller(cases, title), folder / "propeller_5868_9.png")


CAPTIONS = {
    "loads_over_incidence": "Vertical force, pitching moment and tail loads over incidence (paper: Figs. 8, 14).",
    "span_load": "Load along the wing with and without rotors; disks in grey (paper: Fig. 11).",
    "leading_edge_velocity": "Induced velocity a tenth of the chord ahead of the leading edge, without that of "
    "thickness (paper: Fig. 10).",
    "blade_load_over_azimuth": "Blade load at 75 % radius around the disks (paper: Fig. 9).",
    "propeller_5868_9": "Thrust, power and efficiency of a measured propeller.",
}


def main() -> None:
    """Write page and pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "interaction.md")
    args = parser.parse_args()
    folder = args.out.parent / "interaction"
    folder.mkdir(exist_ok=True)
    aircraft = load_aircraft("hera_like")
    paths = [*write_figures(study.interact(aircraft), folder), propeller(folder)]
    runs = Runs(aircraft)
    second, third = study.table2(runs.found, ALPHAS), study.table3(runs.found, ALPHAS[:2])
    page = [
        HEAD,
        "## Table 2",
        "",
        *compared(second, ("L_over_D isolated", "L_over_D", "L_over_D change", "thrust change")),
    ]
    changes = tuple(f"{s} change" for s in study.SLOPES)
    page += ["## Table 3", "", *compared(third, study.SLOPES), *compared(third[1:], changes), *parts_tables(runs.found)]
    page += causes(runs)
    page += ["## Pictures", ""]
    for path in paths:
        page += [f"![{CAPTIONS[path.stem]}]({folder.name}/{path.name})", "", CAPTIONS[path.stem], ""]
    args.out.write_text("\n".join(page), encoding="utf-8")
    print(f"{args.out} written")


if __name__ == "__main__":
    main()
