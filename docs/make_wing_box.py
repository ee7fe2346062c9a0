"""Pictures of the sized wing box and a table of its masses.

python docs/make_wing_box.py [AIRCRAFT] [--out FOLDER]
"""

import argparse
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from hera_om.aircraft import load_aircraft
from hera_om.aircraft.paths import variable_box
from hera_om.components.wingbox import PARTS
from hera_om.models.problems import build_aircraft
from hera_om.physics.load_cases import CASES, UNIT_LOADS
from hera_om.physics.wingbox_types import CRITERIA, PANELS

SHEETS = ("t_skin_upper", "t_skin_lower", "t_web_front", "t_web_rear")
AREAS = {"A_cap_root", "A_stringer_root"}
REQUIRED = 1.5
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red")


def main() -> None:
    """Trim, size, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("aircraft", nargs="?", default="hera_like")
    parser.add_argument("--out", type=Path, default=Path("runs/wing_box"))
    options = parser.parse_args()
    aircraft = load_aircraft(options.aircraft)
    assert aircraft.mission is not None
    problem = build_aircraft(aircraft)
    problem.run_model()
    box: dict[str, Any] = problem.model.wing_box.last
    options.out.mkdir(parents=True, exist_ok=True)
    factor = aircraft.mission.limit_load_factor
    drawings = {
        "sizing": draw_sizing(box),
        "loads": draw_loads(box, factor),
        "deflection": draw_deflection(box, factor),
    }
    if AREAS <= set(problem.model.wing_box.paths):
        drawings["reserves"] = draw_reserves(problem.model.wing_box, variable_box(aircraft))
    for name, figure in drawings.items():
        figure.savefig(options.out / f"{options.aircraft}_{name}.png", dpi=110)
    print("\n".join(table(box)))


def draw_sizing(box: dict[str, Any]):
    """Thickness, stress, reserve factor, active criterion and sizing case along the span."""
    y = np.asarray(box["box_y"])
    figure, axes = plt.subplots(5, 1, figsize=(9, 14), sharex=True, layout="constrained")
    for i, (sheet, colour) in enumerate(zip(SHEETS, COLOURS, strict=True)):
        axes[0].plot(y, 1e3 * np.asarray(box[sheet]), color=colour, label=PANELS[i])
        axes[0].step(y, 1e3 * np.asarray(getattr(box["bought"], sheet)), color=colour, lw=0.6, where="mid")
    axes[0].plot(y, 1e3 * np.asarray(box["t_rib"]), "k:", label="ribs")
    axes[0].plot(y, 1e3 * np.asarray(box["leading_edge"].t), "k--", lw=0.8, label="leading edge")
    axes[0].set_ylabel("thickness [mm]\n(thin: bought)")
    stress = np.asarray(box["stress"]) / 1e6
    for i in range(2):
        axes[1].fill_between(
            y, stress[i].min(axis=(0, 1)), stress[i].max(axis=(0, 1)), alpha=0.4, color=COLOURS[i], label=PANELS[i]
        )
    axes[1].set_ylabel("direct stress over\nall cases [MPa]")
    axes[2].semilogy(y, box["RFC_span"], label="RFC")
    axes[2].semilogy(y, box["RFT_span"], label="RFT")
    axes[2].axhline(1.5, color="k", lw=0.8)
    axes[2].set_ylim(1.0, 30.0)
    axes[2].set_ylabel("reserve factor of\ncaps and stringers")
    for axis, values, names in ((axes[3], box["sizing_criterion"], CRITERIA), (axes[4], box["sizing_case"], CASES)):
        for i, colour in enumerate(COLOURS):
            axis.plot(y, np.asarray(values)[i] + 0.12 * (i - 1.5), "s", ms=5, color=colour, label=PANELS[i])
        axis.set_yticks(range(len(names)), names)
        axis.set_ylim(-0.6, len(names) - 0.4)
        axis.grid(axis="y", lw=0.3)
    axes[3].set_title("what sizes each sheet", fontsize=9)
    axes[4].set_title("case that asks most of it", fontsize=9)
    axes[4].set_xlabel("y [m]")
    for axis in axes[:3]:
        axis.legend(fontsize=8, ncols=3)
        axis.grid(lw=0.3)
    return figure


def draw_loads(box: dict[str, Any], factor: float):
    """Shear, bending, torsion: the pull-up with each relief, and all cases."""
    y, unit, cases = np.asarray(box["box_y"]), box["unit_loads"], box["case_loads"]
    scale = {"V": ("shear [kN]", 1e-3), "M": ("bending [kN m]", 1e-3), "T": ("torsion [kN m]", 1e-3)}
    figure, axes = plt.subplots(3, 2, figsize=(12, 10), sharex=True, layout="constrained")
    for (left, right), (name, (label, size)) in zip(axes, scale.items(), strict=True):
        running = np.asarray(getattr(unit[UNIT_LOADS.index("pull-up")], name))
        left.plot(y, size * running, label="air and rotors")
        for part in ("structure", "fuel", "motors"):
            running = running + factor * np.asarray(getattr(unit[UNIT_LOADS.index(part)], name))
            left.plot(y, size * running, label=f"and {part}")
        for case, values in zip(CASES, np.asarray(getattr(cases, name)), strict=True):
            right.plot(y, size * values, label=case, lw=1.0)
        left.set_ylabel(label)
        for axis in (left, right):
            axis.axhline(0.0, color="k", lw=0.5)
            axis.grid(lw=0.3)
    axes[0, 0].set_title(f"pull-up of {factor:g} g, reliefs one after the other")
    axes[0, 1].set_title("limit loads of all cases")
    axes[0, 0].legend(fontsize=8)
    axes[0, 1].legend(fontsize=7, ncols=2)
    axes[2, 0].set_xlabel("y [m]")
    axes[2, 1].set_xlabel("y [m]")
    return figure


def draw_deflection(box: dict[str, Any], factor: float):
    """The half wing seen from ahead, bent by the pull-up, and its twist."""
    y, bent = np.asarray(box["box_y"]), box["bent"]
    figure, (above, below) = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
    above.plot(y, 0.0 * y, "k--", lw=0.8, label="at rest")
    above.plot(y, np.asarray(bent.w), label=f"{factor:g} g, limit load")
    above.set_aspect("equal", adjustable="datalim")
    above.set_ylabel("deflection [m]")
    above.legend(fontsize=8)
    below.plot(y, np.rad2deg(np.asarray(bent.twist)))
    below.set_ylabel("twist, nose up [deg]")
    below.set_xlabel("y [m]")
    for axis in (above, below):
        axis.grid(lw=0.3)
    hertz = [float(box[f"omega_{name}"]) / (2 * np.pi) for name in ("bending", "torsion")]
    above.set_title(f"first frequencies with full tanks: bending {hertz[0]:.2f} Hz, torsion {hertz[1]:.2f} Hz")
    return figure


def draw_reserves(component, bounds):
    """RFC and RFT over both areas inside their bounds, at the loads of the baseline; red where less than asked."""
    evaluate, values = component.call()[0], component.values(component._inputs)
    fixed = component.structure, component.statics, tuple(component.paths.items()), component.base, component.constants
    names = sorted(AREAS)
    places = [bounds.names.index(name) for name in names]
    caps, stringers = (np.linspace(bounds.lower[p], bounds.upper[p], 13) for p in places)

    def at(cap: float, stringer: float):
        given = {name: np.asarray(area) for name, area in zip(names, (cap, stringer), strict=True)}
        return evaluate(*fixed, values | given)

    found = [[at(cap, stringer) for cap in caps] for stringer in stringers]
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.6), sharey=True, layout="constrained")
    for axis, reserve in zip(axes, ("RFC", "RFT"), strict=True):
        value = np.array([[float(f[reserve]) for f in row] for row in found])
        axis.contourf(1e4 * caps, 1e4 * stringers, value, [0.0, REQUIRED], colors=["tab:red"], alpha=0.25)
        lines = axis.contour(1e4 * caps, 1e4 * stringers, value, np.arange(0.4, 3.0, 0.2), colors="0.5", linewidths=0.8)
        axis.clabel(lines, fmt="%.1f")
        limit = axis.contour(1e4 * caps, 1e4 * stringers, value, [REQUIRED], colors="tab:red", linewidths=2)
        axis.clabel(limit, fmt="%.1f")
        axis.plot(*(1e4 * bounds.baseline[p] for p in places), "k*", ms=11, label="baseline")
        axis.set_title(f"{reserve}, {'compression' if reserve == 'RFC' else 'tension'}; at least {REQUIRED} asked")
        axis.set_xlabel("A_cap_root [cm2]")
    axes[0].set_ylabel("A_stringer_root [cm2]")
    axes[0].legend(loc="lower right")
    return figure


def table(box: dict[str, Any]) -> list[str]:
    """Masses, reserve factors, centre and inertia."""
    lines = [f"{part.replace('_', ' '):24}{float(box[f'm_{part}']):10.1f} kg" for part in PARTS]
    names = ("m_primary", "m_penalties", "m_secondary", "m_leading_edge", "m_remainder", "m_wing", "m_wing_rounded")
    lines += [f"{name:24}{float(box[name]):10.1f} kg" for name in names]
    lines += [f"{name:24}{float(box[name]):10.3f}" for name in ("RFC", "RFT", "RF_yield", "RFC_rounded", "RFT_rounded")]
    lines.append(f"{'centre of one half':24}" + " ".join(f"{float(v):9.3f}" for v in box["cg"]) + " m")
    lines.append(f"{'inertia Ixx Iyy Izz':24}" + " ".join(f"{float(v):9.0f}" for v in box["inertia"]) + " kg m2")
    return lines


if __name__ == "__main__":
    main()
