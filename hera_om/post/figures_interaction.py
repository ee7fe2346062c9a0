"""Figures of what rotors, wing and tail do to each other, from the plain result of `studies.interact`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from hera_om.post.style import BASELINE, CYCLE, INK, new_figure, styled

Result = Mapping[str, Any]
DOTS_PER_INCH = 150
DASHED = (0, (4, 2))


def write_figures(result: Result, folder: Path) -> list[Path]:
    """All figures of a result as PNG files in a folder; their paths."""
    figures = {
        "loads_over_incidence": plot_loads(result),
        "span_load": plot_span(result),
        "leading_edge_velocity": plot_leading_edge(result),
        "blade_load_over_azimuth": plot_blades(result),
    }
    return [save(figure, folder / f"{name}.png") for name, figure in figures.items()]


def save(figure: Figure, path: Path) -> Path:
    """Write a figure."""
    figure.savefig(path, dpi=DOTS_PER_INCH)
    return path


@styled
def plot_loads(result: Result) -> Figure:
    """Vertical force, pitching moment and the tail's share of both over incidence, three configurations."""
    figure = new_figure(5.8)
    panels = {
        "CZ": "vertical force CZ [-]",
        "Cm": "pitching moment Cm [-]",
        "CZ_tail": "CZ of the tail [-]",
        "Cm_tail": "Cm of the tail [-]",
    }
    axes = figure.subplots(2, 2, sharex=True)
    marks = ("o", "s", "^")
    for place, (key, label) in zip(axes.flat, panels.items(), strict=True):
        for (name, curve), colour, mark in zip(result["curves"].items(), CYCLE, marks, strict=False):
            place.plot(curve["alpha"], curve[key], color=colour, marker=mark, markersize=4, label=name)
        place.axhline(0.0, color=INK, linewidth=0.8)
        place.set_ylabel(label)
        place.xaxis.set_major_locator(MultipleLocator(2.0))
    for place in axes[1]:
        place.set_xlabel("angle of attack [deg]")
    figure.legend(handles=axes[0, 0].get_lines()[:3], loc="outside upper left", ncols=3)
    return figure


@styled
def plot_span(result: Result) -> Figure:
    """Vertical and axial force of the wing's strips along the semispan, with rotors and without."""
    figure = new_figure(5.8)
    axes = figure.subplots(2, 1, sharex=True)
    for place, key, label in ((axes[0], "cz_c", "vertical load cz c [m]"), (axes[1], "cx_c", "axial load cx c [m]")):
        for row, colour in zip(result["span"], CYCLE, strict=False):
            for case, dash in (("on", "-"), ("off", DASHED)):
                place.plot(row["y"], row[f"{key}_{case}"], color=colour, linestyle=dash)
        place.set_ylabel(label)
        place.set_xlim(left=0.0)
    _shade(axes, result)
    axes[1].set_xlabel("y [m], to starboard")
    handles = _incidences(result["span"])
    handles += [Line2D([], [], color=INK, label="with rotors"), _dashed("without rotors")]
    figure.legend(handles=handles, loc="outside upper left", ncols=4)
    return figure


@styled
def plot_leading_edge(result: Result) -> Figure:
    """Velocity that wing and rotors induce just ahead of the leading edge, up and aft."""
    rows = result["leading_edge"]
    figure = new_figure(5.8)
    grid = figure.subplots(2, len(rows), sharex=True, sharey="row", squeeze=False)
    kinds = (("both", "wing and rotors", CYCLE[0], "-"), ("wing", "wing alone", BASELINE, DASHED))
    kinds += (("rotors", "rotors alone", CYCLE[1], "-"),)
    for column, row in zip(grid.T, rows, strict=True):
        for place, axis in zip(column, (2, 0), strict=True):
            for key, label, colour, dash in kinds:
                velocity = np.asarray(row[key])[:, axis]
                place.plot(row["y"], velocity, color=colour, linestyle=dash, linewidth=1.5, label=label)
            place.axhline(0.0, color=INK, linewidth=0.8)
            place.set_xlim(left=0.0)
            place.xaxis.set_major_locator(MultipleLocator(5.0))
        column[0].set_title(f"α = {row['alpha']:g}°")
        column[1].set_xlabel("y [m], to starboard")
    grid[0, 0].set_ylabel("upward velocity w / V [-]")
    grid[1, 0].set_ylabel("axial velocity u / V [-]")
    _shade(grid.flat, result)
    figure.legend(handles=grid[0, 0].get_lines()[:3], loc="outside upper left", ncols=3)
    return figure


@styled
def plot_blades(result: Result) -> Figure:
    """Thrust of a blade's section at 75 % radius around the disk, with the wing and without."""
    rows = result["blades"]
    names = list(dict.fromkeys(row["rotor"] for row in rows))
    figure = new_figure(3.2)
    grid = figure.subplots(1, len(names), sharex=True, sharey=True, squeeze=False)
    alphas = list(dict.fromkeys(row["alpha"] for row in rows))
    for place, name in zip(grid.flat, names, strict=True):
        for row in (r for r in rows if r["rotor"] == name):
            colour = CYCLE[alphas.index(row["alpha"])]
            angle = [*row["azimuth_deg"], 360.0]
            for case, dash in (("both", "-"), ("rotors", DASHED)):
                place.plot(angle, [*row[case], row[case][0]], color=colour, linestyle=dash, linewidth=1.5)
        place.set_title(name.replace("_", " "))
        place.axhline(0.0, color=INK, linewidth=0.8)
        place.set_xlabel("azimuth [deg]")
        place.set_xlim(0.0, 360.0)
        place.xaxis.set_major_locator(MultipleLocator(90.0))
    grid[0, 0].set_ylabel("dT/dr / (ρ n² D³) [-]")
    handles = _incidences([{"alpha": a} for a in alphas])
    handles += [Line2D([], [], color=INK, label="with wing"), _dashed("rotors alone")]
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    figure.supxlabel("azimuth of a starboard rotor: 0 towards the wing tip, 90 up", fontsize=9)
    return figure


@styled
def plot_propeller(cases: Sequence[Mapping[str, Any]], title: str) -> Figure:
    """Thrust, power and efficiency of a propeller over the advance ratio, computed and measured.

    Args:
        cases: by pitch, ``label``; ``J``, ``CT``, ``CP``, ``eta`` computed; ``J_data``, ``CT_data``, ``CP_data``,
            ``eta_data`` measured.
        title: name of the propeller and the source of the data.
    """
    figure = new_figure(6.8)
    axes = figure.subplots(3, 1, sharex=True)
    for place, key, label in zip(axes, ("CT", "CP", "eta"), ("CT [-]", "CP [-]", "efficiency [-]"), strict=True):
        for case, colour in zip(cases, CYCLE, strict=False):
            place.plot(case["J"], case[key], color=colour, label=case["label"])
            style = {"linestyle": "none", "marker": "o", "markersize": 4, "markerfacecolor": "white"}
            place.plot(case["J_data"], case[f"{key}_data"], color=colour, **style)
        place.set_ylabel(label)
        place.set_ylim(bottom=0.0)
    axes[0].set_title(title)
    axes[-1].set_xlabel("advance ratio J = V / (n D) [-]")
    handles = [Line2D([], [], color=c, label=case["label"]) for case, c in zip(cases, CYCLE, strict=False)]
    handles += [Line2D([], [], color=INK, label="computed")]
    handles += [Line2D([], [], color=INK, linestyle="none", marker="o", markerfacecolor="white", label="measured")]
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    return figure


def _incidences(rows: Sequence[Mapping[str, Any]]) -> list[Line2D]:
    """A mark by colour for each incidence."""
    return [Line2D([], [], color=c, label=f"α = {row['alpha']:g}°") for row, c in zip(rows, CYCLE, strict=False)]


def _dashed(label: str) -> Line2D:
    """A mark for dashed curves."""
    return Line2D([], [], color=INK, linestyle=DASHED, label=label)


def _shade(places: Any, result: Result) -> None:
    """Where the disks stand."""
    for place in places:
        axes: Axes = place
        for y, radius in result["disks"]:
            axes.axvspan(y - radius, y + radius, color="#000000", alpha=0.05, linewidth=0.0)
