"""Figures of the two designs: planform and rotors, load along the span, wing box along the span."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from hera_om.aircraft.body import Fuselage
from hera_om.core.errors import RecordError
from hera_om.post.database import Run, Snapshot, as_run
from hera_om.post.style import BASELINE, COLOURS, CYCLE, VIOLATED, new_figure, no_data, number, styled
from hera_om.post.tables import DESIGNS, Source

REQUIRED_RESERVE = 1.5
"""Ultimate over limit load, CS 25.303: what a reserve factor by limit load must reach."""

_RESERVE_TICKS = (0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0)


def designs(run: Run) -> list[tuple[str, Snapshot]]:
    """The snapshots that a run has, by name."""
    return [(d, shot) for d in DESIGNS if (shot := getattr(run, d)) is not None]


@styled
def plot_planform(source: Source) -> Figure:
    """Wing, tail and rotors from above: the baseline to port, the optimum to starboard."""
    run = as_run(source)
    shots = [(d, s) for d, s in designs(run) if s.arrays.get("wing_outline") or s.arrays.get("rotors")]
    if not shots:
        return no_data(new_figure(2.0), "no snapshot with a planform was recorded")
    figure = new_figure(6.9)
    axes = figure.subplots()
    _fuselage(axes, run)
    ghost = {
        "linestyle": (0, (4, 3)),
        "linewidth": 1.0,
        "facecolor": "none",
        "edgecolor": BASELINE,
        "zorder": 2,
    }
    for side, (name, shot) in zip((-1.0, 1.0), shots if len(shots) > 1 else shots * 2, strict=True):
        solid = {"facecolor": COLOURS[name] + "30", "edgecolor": COLOURS[name], "linewidth": 1.6, "zorder": 3}
        _half(axes, shot, side, solid)
    if len(shots) > 1:
        _half(axes, shots[0][1], 1.0, ghost)
    axes.set_aspect("equal")
    axes.invert_yaxis()
    axes.axvline(0.0, color="#999999", linewidth=0.8, linestyle=(0, (8, 3, 1, 3)))
    axes.set_xlabel("y [m], to starboard")
    axes.set_ylabel("x [m], aft of the nose")
    _planform_legend(axes, [name for name, _ in shots])
    return figure


def _half(axes: Axes, shot: Snapshot, side: float, style: dict[str, Any]) -> None:
    """Draw one half of the aircraft."""
    for key in ("wing_outline", "htail_outline"):
        outline = np.asarray(shot.arrays.get(key) or np.empty((0, 2)), float)
        if len(outline):
            axes.fill(side * outline[:, 1], outline[:, 0], closed=True, **style)
    for x, y, _, radius in shot.arrays.get("rotors") or ():
        ends = [side * (y - radius), side * (y + radius)]
        width = 3.2 if style["facecolor"] != "none" else 1.2
        colour = style["edgecolor"]
        order = style["zorder"] + 1
        axes.plot(ends, [x, x], color=colour, linewidth=width, linestyle=style.get("linestyle", "-"), zorder=order)
        if width > 2.0:
            axes.plot([side * y, side * y], [x, x + 0.6 * radius], color=colour, linewidth=1.2, zorder=order)


def _fuselage(axes: Axes, run: Run) -> None:
    """The fuselage from the definition, as context; without it where the definition does not load."""
    try:
        body = run.aircraft.fuselage
    except RecordError:
        return
    if body is not None:
        x, half = fuselage_outline(body)
        axes.fill(np.r_[half, -half[::-1]], np.r_[x, x[::-1]], color="#EFEFEF", edgecolor="#BBBBBB", zorder=1)


def fuselage_outline(body: Fuselage) -> tuple[np.ndarray, np.ndarray]:
    """Stations and half widths of a sketch: an elliptic nose, a cylinder, a parabolic tail."""
    s = np.linspace(0.0, 1.0, 30)
    nose, aft = body.nose_length_m, body.length_m - body.tail_length_m
    x = np.r_[nose * s, aft + body.tail_length_m * s]
    share = np.r_[np.sqrt(1.0 - (1.0 - s) ** 2), 1.0 - s**2]
    return x, 0.5 * body.width_m * share


def _planform_legend(axes: Axes, names: list[str]) -> None:
    """Say which side is which."""
    handles = [Line2D([], [], color=COLOURS[n], linewidth=6, alpha=0.6, label=n) for n in names]
    if len(names) > 1:
        handles[0].set_label("baseline (port; dashed to starboard)")
        handles[1].set_label("optimum (starboard)")
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)


@styled
def plot_span_load(source: Source) -> Figure:
    """Section lift coefficient and loading cl c over the half span, with the slipstreams and without."""
    run = as_run(source)
    shots = [(d, s) for d, s in designs(run) if s.arrays.get("cl_span")]
    figure = new_figure(5.8)
    if not shots:
        return no_data(figure, "no snapshot with a span load was recorded")
    upper, lower = figure.subplots(2, 1, sharex=True)
    for name, shot in shots:
        y = np.asarray(shot.arrays["y_span"], float)
        chord = np.asarray(shot.arrays["chord_span"], float)
        for key, dash, label in (
            ("cl_span", "-", "with rotors"),
            ("cl_span_off", (0, (4, 2)), "slipstream off"),
        ):
            if shot.arrays.get(key):
                cl = np.asarray(shot.arrays[key], float)
                style = {"color": COLOURS[name], "linestyle": dash, "label": f"{name}, {label}"}
                upper.plot(y, cl, **style)
                lower.plot(y, cl * chord, **style)
    upper.set_ylabel("section cl [-]")
    lower.set_ylabel("loading cl c [m]")
    lower.set_xlabel("y [m], to starboard")
    for axes in (upper, lower):
        axes.set_ylim(bottom=min(0.0, 1.05 * axes.dataLim.ymin))
        axes.set_xlim(left=0.0)
    _disks(lower, shots)
    handles, _ = upper.get_legend_handles_labels()
    handles.append(Line2D([], [], color=COLOURS[shots[-1][0]], linewidth=3.5, alpha=0.75, label="rotor disks"))
    upper.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
    return figure


def _disks(axes: Axes, shots: list[tuple[str, Snapshot]]) -> None:
    """Where the disks stand, as bars just above the axis."""
    for i, (name, shot) in enumerate(shots):
        for _, y, _, radius in shot.arrays.get("rotors") or ():
            place = 0.035 + 0.045 * i
            axes.plot(
                [y - radius, y + radius],
                [place, place],
                transform=axes.get_xaxis_transform(),
                color=COLOURS[name],
                linewidth=3.5,
                alpha=0.75,
                solid_capstyle="butt",
            )


@styled
def plot_box(source: Source) -> Figure:
    """Sized thicknesses of the wing box and its reserve factors along the semispan."""
    run = as_run(source)
    shots = [(d, s) for d, s in designs(run) if s.arrays.get("box")]
    figure = new_figure(6.2)
    if not shots:
        return no_data(figure, "no snapshot with a wing box was recorded")
    upper, lower = figure.subplots(2, 1, sharex=True)
    thick = {
        "t_skin_upper": "upper skin",
        "t_skin_lower": "lower skin",
        "t_web_front": "front web",
        "t_web_rear": "rear web",
    }
    reserve = {"RFC_span": "RFC, compression", "RFT_span": "RFT, tension"}
    _along(upper, shots, thick, 1e3)
    upper.set_ylabel("thickness [mm]")
    upper.set_ylim(bottom=0.0)
    upper.set_title("Sized: skins and webs")
    _along(lower, shots, reserve, 1.0)
    _reserve_axis(lower)
    return figure


def _along(axes: Axes, shots: list[tuple[str, Snapshot]], wanted: dict[str, str], factor: float) -> None:
    """Curves over the semispan: colour by quantity, the baseline dashed."""
    handles = []
    for (key, label), colour in zip(wanted.items(), CYCLE, strict=False):
        for name, shot in shots:
            box = shot.arrays["box"]
            if box.get(key) is not None:
                x = np.asarray(box["eta"], float)
                y = factor * np.asarray(box[key], float)
                first = name == shots[-1][0]
                style = "-" if first else (0, (4, 2))
                axes.plot(x[: len(y)], y, color=colour, linestyle=style, linewidth=1.8 if first else 1.2)
        handles.append(Line2D([], [], color=colour, label=label))
    if len(shots) > 1:
        handles += [
            Line2D([], [], color="#555555", label="optimum"),
            Line2D([], [], color="#555555", linestyle=(0, (4, 2)), linewidth=1.2, label="baseline"),
        ]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0))


def _reserve_axis(axes: Axes) -> None:
    """A logarithmic axis around the required reserve; the light tip, far above, is cut off."""
    axes.set_yscale("log")
    axes.set_ylim(min(0.9, 0.9 * axes.get_ylim()[0]), 10.0)
    axes.yaxis.set_major_locator(FixedLocator(_RESERVE_TICKS))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.axhline(REQUIRED_RESERVE, color=VIOLATED, linewidth=1.2)
    text = f"required {number(REQUIRED_RESERVE, 2)}"
    axes.text(
        0.01,
        REQUIRED_RESERVE * 0.97,
        text,
        transform=axes.get_yaxis_transform(),
        va="top",
        color=VIOLATED,
        fontsize=9,
    )
    axes.set_ylabel("allowable / limit stress [-]")
    axes.set_xlabel("y / semispan [-]")
    axes.set_xlim(0.0, 1.0)
    axes.set_title("Checked: caps and stringers")
