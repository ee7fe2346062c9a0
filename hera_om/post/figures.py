"""Figures of how a run went: its history, its constraints, and its way over the short-period thumbprint."""

import math
from dataclasses import dataclass

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from hera_om.post import tables
from hera_om.post.read import Constraint, Run, as_run
from hera_om.post.style import (
    BASELINE,
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

FEASIBLE = 1e-6
"""A relative violation up to this counts as none; drivers stop at about this tolerance."""


@dataclass(frozen=True)
class ShortPeriodBox:
    """Limits of the short period; a bound is None where there is none."""

    label: str
    omega: tuple[float | None, float | None]
    zeta: tuple[float, float]


TABLE_7 = ShortPeriodBox("Table 7 of the paper", (2.3, 3.5), (0.2, 1.4))
"""Granata et al., Aerosp. Sci. Technol. 2026, doi 10.1016/j.ast.2026.112734, Table 7."""

MIL_F_8785C = ShortPeriodBox("MIL-F-8785C, Level 1, Category B", (None, None), (0.30, 2.0))
"""MIL-F-8785C, 3.2.2.1.2, damping; its bounds on the frequency depend on n/alpha, see MIL_CAP."""

MIL_CAP = (0.085, 3.6)
"""MIL-F-8785C, 3.2.2.1.1, Level 1, Category B: omega_sp^2 / (n/alpha) in rad^2/s^2 per g."""


@styled
def plot_history(source: Source) -> Figure:
    """Objective, worst violation and design variables (share of their box) over the driver's evaluations."""
    run = as_run(source)
    frame = tables.history(run)
    figure = new_figure(6.6)
    if frame.empty:
        return no_data(figure, "no evaluation was recorded")
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(1.0, 0.8, 1.3))
    frame = frame[frame["success"]] if frame["success"].any() else frame
    _objective(top, run, frame)
    _violation(middle, frame)
    _in_box(bottom, run, frame)
    bottom.set_xlabel("evaluation of the model by the driver")
    bottom.xaxis.set_major_locator(MaxNLocator(integer=True))
    figure.align_ylabels()
    return figure


def _objective(axes: Axes, run: Run, frame: pd.DataFrame) -> None:
    """The objective, feasible evaluations filled."""
    name, units = (run.objective.name, run.objective.units) if run.objective else ("objective", None)
    factor, shown = readable(units)
    values = factor * frame["objective"]
    feasible = frame["worst_violation"] <= FEASIBLE
    axes.plot(frame.index, values, color=OPTIMUM, linewidth=1.2, zorder=2)
    style = {"linestyle": "none", "marker": "o", "markersize": 5.5, "zorder": 3}
    axes.plot(frame.index[feasible], values[feasible], color=OPTIMUM, label="feasible", **style)
    bad = {"markerfacecolor": "white", "markeredgecolor": VIOLATED, "label": "violates a constraint"}
    axes.plot(frame.index[~feasible], values[~feasible], **bad, **style)
    axes.set_ylabel(with_units(name, shown))
    axes.set_title("Objective")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2, handletextpad=0.2)


def _violation(axes: Axes, frame: pd.DataFrame) -> None:
    """The worst violation on a scale that shows zero as well as small values."""
    values = 100.0 * frame["worst_violation"]
    axes.plot(frame.index, values, color=VIOLATED, marker="o", markersize=4)
    least = 1e-4
    if values.max() > 1.0:
        axes.set_yscale("symlog", linthresh=least, linscale=0.5)
        decades = [10.0**k for k in range(-4, 3, 2) if 10.0**k <= 10.0 * values.max()]
        axes.yaxis.set_major_locator(FixedLocator([0.0, *decades]))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("of the bound [%]")
    axes.set_title("Worst violation of a constraint")


def _in_box(axes: Axes, run: Run, frame: pd.DataFrame) -> None:
    """Each variable between its bounds."""
    ends = []
    axes.set_ylim(-0.04, 1.04)
    for i, v in enumerate(run.variables):
        if v.name not in frame or v.upper <= v.lower:
            continue
        share = (frame[v.name] - v.lower) / (v.upper - v.lower)
        colour = CYCLE[i % len(CYCLE)]
        axes.plot(frame.index, share, color=colour, linestyle="-" if i < len(CYCLE) else "--")
        ends.append((float(share.iloc[-1]), v.name, colour))
    axes.set_yticks([0.0, 0.25, 0.5, 0.75, 1.0], ["lower", "25 %", "50 %", "75 %", "upper"])
    axes.set_ylabel("place between bounds")
    axes.set_title("Design variables")
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    label_ends(axes, ends)


@styled
def plot_constraints(source: Source) -> Figure:
    """Distance of each constraint to its nearer bound, relative to the bound; violated ones in red."""
    run = as_run(source)
    frame = tables.constraints(run)
    figure = new_figure(1.3 + 0.47 * max(len(frame), 3))
    if frame.empty:
        return no_data(figure, "the run has no constraints")
    axes = figure.subplots()
    final = "optimum" if frame["optimum"].notna().any() else "baseline"
    for place, c in enumerate(run.constraints):
        _margin(axes, place, c, frame.loc[c.name], final)
    axes.axvline(0.0, color=INK, linewidth=1.0)
    axes.set_yticks(range(len(frame)), list(frame.index))
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_ylim(len(frame) - 0.4, -0.6)
    axes.set_xlabel("margin to the nearer bound, relative to the larger bound [%]      violated < 0 < satisfied")
    _margin_legend(axes, final)
    return figure


def _margin(axes: Axes, place: int, c: Constraint, row: pd.Series, final: str) -> None:
    """One bar, the baseline's diamond, and the numbers at the right."""
    value = row[final]
    share = 100.0 * c.margin(value) / c.scale
    violated = share < -100.0 * FEASIBLE
    axes.barh(place, share, height=0.5, color=VIOLATED if violated else OPTIMUM)
    if final == "optimum" and not math.isnan(row["baseline"]):
        before = 100.0 * c.margin(row["baseline"]) / c.scale
        axes.plot(before, place, marker="D", markersize=6, markerfacecolor="white", markeredgecolor=INK, zorder=4)
    factor, shown = readable(c.units, value)
    text = " ≤ ".join(
        part
        for part in (
            number(factor * c.lower, 3) if c.lower is not None else "",
            number(factor * value),
            number(factor * c.upper, 3) if c.upper is not None else "",
        )
        if part
    )
    note = "violated" if violated else "active" if abs(share) < 0.1 else ""
    text = f"{text} {shown}".strip() + (f", {note}" if note else "")
    colour = VIOLATED if violated else INK
    axes.annotate(text, (1.02, place), xycoords=("axes fraction", "data"), va="center", fontsize=9, color=colour)


def _margin_legend(axes: Axes, final: str) -> None:
    """Name the marks."""
    handles = [Rectangle((0, 0), 1, 1, color=OPTIMUM, label=final)]
    if final == "optimum":
        (diamond,) = axes.plot([], [], "D", color=INK, markerfacecolor="white", markersize=6, label="baseline")
        handles.append(diamond)
    handles.append(Rectangle((0, 0), 1, 1, color=VIOLATED, label="violated"))
    axes.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, borderaxespad=0.2)


@styled
def plot_thumbprint(source: Source) -> Figure:
    """The driver's way in the plane of short-period damping and frequency, with the limits of both sources."""
    run = as_run(source)
    path = _short_period(run)
    figure = new_figure(4.9)
    if path.empty:
        return no_data(figure, "neither history nor snapshots hold omega_sp and zeta_sp")
    axes = figure.subplots()
    axes.set_xscale("log")
    _limits(axes, path)
    _mil_limits(axes, run)
    _box(axes)
    axes.plot(path["zeta_sp"], path["omega_sp"], color=INK, linewidth=1.0, marker=".", markersize=6, label="path")
    _ends(axes, path)
    axes.set_xlabel("damping ratio ζ_sp [-]")
    axes.set_ylabel("undamped frequency ω_sp [rad/s]")
    axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.16), ncols=2)
    return figure


def _short_period(run: Run) -> pd.DataFrame:
    """Pairs of damping and frequency: baseline, evaluations, optimum, as far as recorded."""
    wanted = ["zeta_sp", "omega_sp"]
    rows = [s.values for s in (run.baseline,) if s is not None]
    frame = tables.history(run)
    rows += frame.to_dict("records") if set(wanted) <= set(frame.columns) else []
    rows += [s.values for s in (run.optimum,) if s is not None]
    pairs = [{k: row.get(k, math.nan) for k in wanted} for row in rows]
    return pd.DataFrame(pairs, columns=wanted, dtype=float).dropna().reset_index(drop=True)


def _limits(axes: Axes, path: pd.DataFrame) -> None:
    """Room for the path and for both boxes, ticks in plain numbers."""
    low, high = min(0.15, 0.9 * path["zeta_sp"].min()), max(2.6, 1.1 * path["zeta_sp"].max())
    axes.set_xlim(low, high)
    axes.set_ylim(min(1.0, 0.85 * path["omega_sp"].min()), max(4.5, 1.1 * path["omega_sp"].max()))
    ticks = [t for t in (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0) if low <= t <= high]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def _box(axes: Axes) -> None:
    """The box of the optimisation problem."""
    (z0, z1), (w0, w1) = TABLE_7.zeta, TABLE_7.omega
    size = {"width": z1 - z0, "height": w1 - w0}
    axes.add_patch(Rectangle((z0, w0), **size, facecolor="#56B4E9", alpha=0.25, edgecolor="none", zorder=0.6))
    axes.add_patch(
        Rectangle((z0, w0), **size, fill=False, edgecolor=OPTIMUM, linewidth=1.3, zorder=1.5, label=TABLE_7.label)
    )


def _mil_limits(axes: Axes, run: Run) -> None:
    """MIL-F-8785C: damping, and the frequency where the optimum's (else the baseline's) n/alpha is recorded."""
    low, high = MIL_F_8785C.zeta
    style = {"color": "#8A6D00", "linestyle": (0, (5, 3)), "linewidth": 1.2, "zorder": 1.4}
    omega = _mil_omega(run)
    w0, w1 = omega or axes.get_ylim()
    top = min(w1, axes.get_ylim()[1])
    axes.plot([low, low], [w0, top], label=MIL_F_8785C.label, **style)
    axes.plot([high, high], [w0, top], **style)
    for w in omega or ():
        axes.plot([low, high], [w, w], **style)
    axes.set_ylim(axes.get_ylim())


def _mil_omega(run: Run) -> tuple[float, float] | None:
    """Frequencies at the bounds of CAP: n/alpha is omega_sp^2 / CAP of a snapshot."""
    for shot in (run.optimum, run.baseline):
        values = shot.values if shot else {}
        if values.get("CAP", 0.0) > 0.0 and "omega_sp" in values:
            slope = values["omega_sp"] ** 2 / values["CAP"]
            return math.sqrt(MIL_CAP[0] * slope), math.sqrt(MIL_CAP[1] * slope)
    return None


def _ends(axes: Axes, path: pd.DataFrame) -> None:
    """Mark where the run began and ended."""
    for row, marker, colour, label in ((path.iloc[0], "o", BASELINE, "start"), (path.iloc[-1], "*", OPTIMUM, "end")):
        zeta, omega = row["zeta_sp"], row["omega_sp"]
        size = 15 if marker == "*" else 9
        text = f"{label}: ζ {number(zeta, 3)}, ω {number(omega, 3)} rad/s"
        style = {"markeredgecolor": "white", "linestyle": "none", "zorder": 5}
        axes.plot(zeta, omega, marker=marker, markersize=size, color=colour, label=text, **style)
