"""Figures of what things add up to: drag, masses, and the gain by cause."""

import math

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hera_om.post import tables
from hera_om.post.read import as_run
from hera_om.post.style import COLOURS, INK, OPTIMUM, VIOLATED, new_figure, no_data, number, readable, styled, with_units
from hera_om.post.tables import DESIGNS, Source


@styled
def plot_drag(source: Source) -> Figure:
    """Drag by part in counts, both designs."""
    frame = tables.drag(source)
    figure = new_figure(1.6 + 0.5 * max(len(frame) - 1, 2))
    if frame.empty:
        return no_data(figure, "no snapshot with a drag breakdown was recorded")
    axes = figure.subplots()
    _bars(axes, frame, "counts")
    axes.set_xlabel("drag coefficient [counts, 0.0001]")
    return figure


@styled
def plot_masses(source: Source) -> Figure:
    """Mass items of the aircraft and parts of the wing, both designs."""
    frame = tables.masses(source)
    groups = [g for g in ("aircraft", "wing") if g in frame.index.get_level_values("group")]
    if not groups:
        return no_data(new_figure(2.0), "no snapshot with masses was recorded")
    parts = [frame.loc[g] for g in groups]
    heights = [max(len(p) - 1, 2) for p in parts]
    figure = new_figure(1.2 * len(parts) + 0.36 * sum(heights))
    for axes, part, group in zip(figure.subplots(len(parts), 1, height_ratios=heights, squeeze=False)[:, 0], parts, groups, strict=True):
        rest = part.drop("total", errors="ignore").sort_values("baseline", ascending=False, kind="stable")
        ordered = pd.concat([rest, part.loc[part.index == "total"]])
        _bars(axes, ordered, "kg", title="Items of the aircraft" if group == "aircraft" else "Parts of the wing")
        axes.set_xlabel("mass [kg]")
    return figure


def _bars(axes: Axes, frame: pd.DataFrame, units: str, title: str = "") -> None:
    """Two bars an item with the change beside them; the total stands in the title, it would dwarf the parts."""
    total = frame.loc["total"] if "total" in frame.index else None
    parts = frame.drop("total", errors="ignore")
    shown = [d for d in DESIGNS if parts[d].notna().any()]
    height = 0.8 / max(len(shown), 1)
    for i, design in enumerate(shown):
        places = [p + (i - 0.5 * (len(shown) - 1)) * height for p in range(len(parts))]
        axes.barh(places, parts[design].fillna(0.0), height=0.92 * height, color=COLOURS[design], label=design)
    for place, (_, row) in enumerate(parts.iterrows()):
        reach = max(0.0, *(row[d] for d in shown if not math.isnan(row[d])))
        axes.annotate(_change(row, shown), (reach, place), xytext=(5, 0), textcoords="offset points", va="center", fontsize=9)
    axes.set_yticks(range(len(parts)), list(parts.index))
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(parts) - 0.45, -0.55)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.margins(x=0.24)
    if parts[shown].min().min() >= 0.0:
        axes.set_xlim(left=0.0)
    axes.set_title(_title(title, total, shown, units))
    axes.legend(loc="lower right")


def _change(row: pd.Series, shown: list[str]) -> str:
    """The last value and, where it moved, by how much."""
    text = number(row[shown[-1]])
    change = row["change"]
    if math.isnan(change) or abs(change) < 1e-3 * max(abs(row["baseline"]), 1e-9):
        return text
    return f"{text}  ({'+' if change > 0 else ''}{number(change, 3)})"


def _title(title: str, total: pd.Series | None, shown: list[str], units: str) -> str:
    """Title with the totals."""
    if total is None:
        return title
    sums = " → ".join(number(total[d]) for d in shown)
    return f"{title + ': total' if title else 'Total'} {sums} {units}"


@styled
def plot_gain(source: Source) -> Figure:
    """The way from the baseline's objective to the optimum's, cause by cause."""
    run = as_run(source)
    split = tables.gain(run)
    figure = new_figure(1.5 + 0.42 * max(len(split) + 2, 3))
    if split.empty or run.objective is None:
        return no_data(figure, "the run did not split its gain")
    factor, shown = readable(run.objective.units)
    start = factor * tables.comparison(run)["baseline"].get(run.objective.name, math.nan)
    start = 0.0 if math.isnan(start) else start
    axes = figure.subplots()
    better = 1.0 if run.objective.sense == "max" else -1.0
    at, ends = start, [start]
    for place, step in enumerate(factor * split, start=1):
        axes.barh(place, step, left=at, height=0.6, color=OPTIMUM if better * step >= 0.0 else VIOLATED)
        edge = max(at, at + step)
        text = f"{'+' if step > 0 else ''}{number(step, 3)}"
        axes.annotate(text, (edge, place), xytext=(5, 0), textcoords="offset points", va="center", fontsize=9)
        at += step
        axes.plot([at, at], [place - 0.3, place + 1.3], color="#999999", linewidth=0.8)
        ends.append(at)
    _waterfall_frame(axes, ends, [*split.index], with_units(run.objective.name, shown))
    return figure


def _waterfall_frame(axes: Axes, ends: list[float], causes: list[str], label: str) -> None:
    """Both totals as bars, limits around the steps, since the totals would dwarf them."""
    low, high = min(ends), max(ends)
    room = max(high - low, 1e-9)
    axes.set_xlim(low - 0.35 * room, high + 0.35 * room)
    left = axes.get_xlim()[0]
    for place, value, design in ((0, ends[0], "baseline"), (len(causes) + 1, ends[-1], "optimum")):
        axes.barh(place, value - left, left=left, height=0.6, color=COLOURS[design])
        axes.annotate(number(value), (value, place), xytext=(5, 0), textcoords="offset points", va="center", fontsize=9)
    names = ["baseline", *(c.replace("_", " ") for c in causes), "optimum"]
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlabel(f"{label}; the axis does not begin at zero")
