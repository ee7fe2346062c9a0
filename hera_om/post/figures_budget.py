"""Figures of what things add up to: drag, masses, and the gain by cause."""

import math

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hera_om.post import tables
from hera_om.post.database import Run, as_run
from hera_om.post.style import (
    COLOURS,
    INK,
    OPTIMUM,
    VIOLATED,
    new_figure,
    no_data,
    number,
    readable,
    styled,
    with_units,
)
from hera_om.post.tables import DESIGNS, Row, Source


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
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper right", ncols=2)
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
    panels = figure.subplots(len(parts), 1, height_ratios=heights, squeeze=False)[:, 0]
    for axes, part, group in zip(panels, parts, groups, strict=True):
        _bars(
            axes,
            _by_size(part),
            "kg",
            title="Items of the aircraft" if group == "aircraft" else "Parts of the wing",
        )
        axes.set_xlabel("mass [kg]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return figure


def _by_size(part: pd.DataFrame) -> pd.DataFrame:
    """Largest first; what is not itemised and the total last."""
    last = [n for n in ("not itemised", "total") if n in part.index]
    first = part.drop(last)
    order = first.max(axis=1).sort_values(ascending=False, kind="stable").index
    return pd.concat([first.loc[order], part.loc[last]])


def _bars(axes: Axes, frame: pd.DataFrame, units: str, title: str = "") -> None:
    """Two bars an item with the change beside them; the total, which would dwarf them, is in the title."""
    lines = tables.rows(frame)
    total = next((r for r in lines if r["item"] == "total"), None)
    parts = [r for r in lines if r is not total]
    shown = [d for d in DESIGNS if any(not math.isnan(r[d]) for r in parts)]
    height = 0.8 / max(len(shown), 1)
    for i, design in enumerate(shown):
        places = [p + (i - 0.5 * (len(shown) - 1)) * height for p in range(len(parts))]
        sizes = [0.0 if math.isnan(r[design]) else r[design] for r in parts]
        axes.barh(places, sizes, height=0.92 * height, color=COLOURS[design], label=design)
    for place, row in enumerate(parts):
        reach = max([0.0, *(row[d] for d in shown if not math.isnan(row[d]))])
        axes.annotate(
            _change(row, shown),
            (reach, place),
            xytext=(5, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
        )
    axes.set_yticks(range(len(parts)), [r["item"] for r in parts])
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(parts) - 0.45, -0.55)
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.margins(x=0.24)
    if all(not r[d] < 0.0 for r in parts for d in shown):
        axes.set_xlim(left=0.0)
    axes.set_title(_title(title, total, shown, units))


def _change(row: Row, shown: list[str]) -> str:
    """The last value and, where it moved, by how much."""
    text = number(row[shown[-1]])
    change = row["change"]
    if math.isnan(change) or abs(change) < 1e-3 * max(abs(row["baseline"]), 1e-9):
        return text
    return f"{text}  ({'+' if change > 0 else ''}{number(change, 3)})"


def _title(title: str, total: Row | None, shown: list[str], units: str) -> str:
    """Title with the totals."""
    if total is None:
        return title
    sums = " → ".join(number(total[d]) for d in shown)
    return f"{title + ': total' if title else 'Total'} {sums} {units}"


@styled
def plot_gain(source: Source) -> Figure:
    """The objective's change from the baseline to the optimum, cause by cause."""
    run = as_run(source)
    split = tables.gain(run)
    figure = new_figure(1.4 + 0.4 * max(len(split) + 1, 3))
    if split.empty or run.objective is None:
        return no_data(figure, "the run did not split its gain")
    factor, shown = readable(run.objective.units)
    better = 1.0 if run.objective.sense == "max" else -1.0
    axes = figure.subplots()
    at = 0.0
    for place, step in enumerate(factor * split):
        _step(axes, place, at, step, OPTIMUM if better * step >= 0.0 else VIOLATED)
        at += step
        axes.plot([at, at], [place - 0.3, place + 1.3], color="#999999", linewidth=0.8)
    _step(axes, len(split), 0.0, at, "#444444")
    names = [*(str(c).replace("_", " ") for c in split.index), "in all"]
    axes.set_yticks(range(len(names)), names)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.use_sticky_edges = False  # else bars would touch the frame
    axes.margins(x=0.12)
    axes.axvline(0.0, color=INK, linewidth=1.0)
    axes.set_xlabel(with_units(f"change of {run.objective.name}", shown))
    axes.set_title(_totals(run, factor, shown))
    return figure


def _step(axes: Axes, place: int, start: float, step: float, colour: str) -> None:
    """One bar of the cascade with its size."""
    axes.barh(place, step, left=start, height=0.6, color=colour)
    text = f"{'+' if step > 0 else ''}{number(step, 3)}"
    edge = (max(start, start + step, 0.0), place)
    axes.annotate(text, edge, xytext=(5, 0), textcoords="offset points", va="center", fontsize=9)


def _totals(run: Run, factor: float, shown: str) -> str:
    """Both values of the objective and the change in percent."""
    name = run.objective.name if run.objective else ""
    row = next((r for r in tables.rows(tables.comparison(run)) if r["name"] == name), None)
    if row is None:
        return ""
    sign = "+" if row["change"] > 0 else ""
    change = f"{sign}{row['change_percent']:.1f} %".replace("-", "−")
    return f"{number(factor * row['baseline'])} → {number(factor * row['optimum'])} {shown} ({change})"
