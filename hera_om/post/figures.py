"""Figures of how a run went: its history and its constraints."""

import math

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from hera_om.post import tables
from hera_om.post.database import Constraint, Run, as_run
from hera_om.post.style import (
    CYCLE,
    INK,
    OPTIMUM,
    VIOLATED,
    label_ends,
    new_figure,
    no_data,
    number,
    readable,
    styled,
    with_units,
)
from hera_om.post.tables import Source

FEASIBLE = 1e-4
"""A violation up to this part of the bound counts as none, where the run's own check is not on record."""

Columns = dict[str, np.ndarray]


@styled
def plot_history(source: Source) -> Figure:
    """Objective, worst violation and design variables (share of their box) over the driver's evaluations."""
    run = as_run(source)
    frame = tables.history(run)
    figure = new_figure(6.6)
    columns: Columns = {str(k): v for k, v in frame.reset_index().to_dict("list").items()}
    columns = {k: np.asarray(v) for k, v in columns.items()}
    done = columns["success"].astype(bool)
    if not done.any():
        why = "the analysis failed in every evaluation" if len(done) else "no evaluation was recorded"
        return no_data(figure, why)
    failed, columns = columns["iteration"][~done], {k: v[done] for k, v in columns.items()}
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 0.8, 1.3))
    _objective(top, run, columns)
    if len(failed):
        style = {"linestyle": "none", "marker": "x", "color": VIOLATED, "clip_on": False}
        top.plot(failed, [0.0] * len(failed), transform=top.get_xaxis_transform(), label="analysis failed", **style)
    top.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2, handletextpad=0.2)
    _violation(middle, columns)
    _in_box(bottom, run, columns)
    bottom.set_xlabel("evaluation of the model by the driver")
    bottom.xaxis.set_major_locator(MaxNLocator(integer=True))
    bottom.set_xlim(0.5, len(done) + 0.5)
    figure.align_ylabels()
    return figure


def _objective(axes: Axes, run: Run, columns: Columns) -> None:
    """The objective, feasible evaluations filled."""
    name, units = (run.objective.name, run.objective.units) if run.objective else ("objective", None)
    factor, shown = readable(units)
    count, values = columns["iteration"], factor * columns["objective"]
    feasible = columns["worst_violation"] <= FEASIBLE
    axes.plot(count, values, color=OPTIMUM, linewidth=1.2, zorder=2)
    style = {"linestyle": "none", "marker": "o", "markersize": 5.5, "zorder": 3}
    axes.plot(count[feasible], values[feasible], color=OPTIMUM, label="feasible", **style)
    bad = {"markerfacecolor": "white", "markeredgecolor": VIOLATED, "label": "violates a constraint"}
    axes.plot(count[~feasible], values[~feasible], **bad, **style)
    axes.set_ylabel(with_units(name, shown))
    axes.set_title("Objective")


def _violation(axes: Axes, columns: Columns) -> None:
    """The worst violation on a scale that shows zero as well as small values."""
    values = 100.0 * columns["worst_violation"]
    style = {"color": VIOLATED, "marker": "o", "markersize": 4, "clip_on": False, "zorder": 3}
    axes.plot(columns["iteration"], values, **style)
    least, most = 1e-4, float(np.nanmax(values, initial=0.0))
    if most > 1.0:
        axes.set_yscale("symlog", linthresh=least, linscale=0.5)
        decades = [10.0**k for k in range(-4, 3, 2) if 10.0**k <= 10.0 * most]
        axes.yaxis.set_major_locator(FixedLocator([0.0, *decades]))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("of the bound [%]")
    axes.set_title("Worst violation of a constraint")


def _in_box(axes: Axes, run: Run, columns: Columns) -> None:
    """Each variable between its bounds."""
    ends = []
    axes.set_ylim(-0.04, 1.04)
    for i, v in enumerate(run.variables):
        if v.name not in columns or v.upper <= v.lower:
            continue
        share = (columns[v.name] - v.lower) / (v.upper - v.lower)
        colour = CYCLE[i % len(CYCLE)]
        axes.plot(columns["iteration"], share, color=colour, linestyle="-" if i < len(CYCLE) else "--")
        ends.append((float(share[-1]), v.name, colour))
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["lower", "25 %", "50 %", "75 %", "upper"])
    axes.set_ylabel("place between bounds")
    axes.set_title("Design variables")
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    label_ends(axes, ends)


@styled
def plot_constraints(source: Source) -> Figure:
    """Distance of each constraint to its nearer bound, relative to the bound; violated ones in red."""
    run = as_run(source)
    lines = tables.rows(tables.constraints(run))
    figure = new_figure(1.3 + 0.47 * max(len(lines), 3))
    final = "optimum" if any(not math.isnan(r["optimum"]) for r in lines) else "baseline"
    if all(math.isnan(r[final]) for r in lines):
        return no_data(figure, "the record has no constraints, or no values of them")
    axes = figure.subplots()
    for place, (c, row) in enumerate(zip(run.constraints, lines, strict=True)):
        _margin(axes, place, c, row, final)
    axes.axvline(0.0, color=INK, linewidth=1.0)
    axes.set_yticks(range(len(lines)), [r["name"] for r in lines])
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(lines) - 0.4, -0.6)
    axes.set_xlabel("margin to the nearer bound, relative to it [%]")
    _margin_legend(axes, final)
    return figure


def _margin(axes: Axes, place: int, c: Constraint, row: tables.Row, final: str) -> None:
    """One bar, the baseline's diamond, and the numbers at the right."""
    value = row[final]
    share = 100.0 * c.relative(value)
    violated = row["violated"] if row["violated"] is not None else share < -100.0 * FEASIBLE
    active = row["active"] if row["active"] is not None else abs(share) < 0.1
    axes.barh(place, share, height=0.5, color=VIOLATED if violated else OPTIMUM)
    if final == "optimum" and not math.isnan(row["baseline"]):
        before = 100.0 * c.relative(row["baseline"])
        style = {"markersize": 6, "markerfacecolor": "white", "markeredgecolor": INK, "zorder": 4}
        axes.plot(before, place, marker="D", **style)
    note = f"violated by {number(abs(share), 2)} %" if violated else "active" if active else ""
    text = _bounded(c, value) + (f", {note}" if note else "")
    colour = VIOLATED if violated else INK
    axes.annotate(text, (1.02, place), xycoords=("axes fraction", "data"), va="center", fontsize=9, color=colour)


def _bounded(c: Constraint, value: float) -> str:
    """A value between its bounds."""
    factor, shown = readable(c.units, value)
    text = number(factor * value)
    if c.lower is not None and c.lower == c.upper:
        return f"{text} = {factor * c.lower:g} {shown}".rstrip()
    low = f"{factor * c.lower:g} ≤ " if c.lower is not None else ""
    high = f" ≤ {factor * c.upper:g}" if c.upper is not None else ""
    return f"{low}{text}{high} {shown}".rstrip()


def _margin_legend(axes: Axes, final: str) -> None:
    """Name the marks."""
    handles: list[Artist] = [Rectangle((0, 0), 1, 1, color=OPTIMUM, label=final)]
    if final == "optimum":
        (diamond,) = axes.plot([], [], "D", color=INK, markerfacecolor="white", markersize=6, label="baseline")
        handles.append(diamond)
    handles.append(Rectangle((0, 0), 1, 1, color=VIOLATED, label="violated"))
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)
