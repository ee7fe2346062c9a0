"""The short-period thumbprint with the way of an optimisation over it."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from hera_om.post.database import Run, as_run
from hera_om.post.style import BASELINE, INK, OPTIMUM, new_figure, no_data, number, styled
from hera_om.post.tables import Source

TABLE_7_OMEGA, TABLE_7_ZETA = (2.3, 3.5), (0.2, 1.4)
"""Short period in cruise, rad/s and -: Granata et al. 2026, doi 10.1016/j.ast.2026.112734, Table 7."""

MIL_ZETA = (0.30, 2.0)
"""MIL-F-8785C, 3.2.2.1.2, damping, Level 1, Category B."""

MIL_CAP = (0.085, 3.6)
"""MIL-F-8785C, 3.2.2.1.1, Level 1, Category B: omega_sp^2 / (n/alpha) in rad^2/s^2 per g."""


class Path(NamedTuple):
    """Points that a run visited, in order."""

    zeta: np.ndarray
    omega: np.ndarray


@styled
def plot_thumbprint(source: Source) -> Figure:
    """The driver's way in the plane of short-period damping and frequency, with the limits of two sources."""
    run = as_run(source)
    path = _short_period(run)
    figure = new_figure(4.6)
    if not len(path.zeta):
        return no_data(figure, "neither history nor snapshots hold omega_sp and zeta_sp")
    panels = figure.subplots(1, 2, width_ratios=(1.25, 1.0)) if len(path.zeta) > 1 else [figure.subplots()]
    whole = panels[0]
    _whole_limits(whole, path)
    for axes in panels[1:]:
        _near_limits(axes, path)
        axes.set_title("The path, enlarged")
    for axes in panels:
        _mil_limits(axes, run)
        _box(axes)
        if len(path.zeta) > 1:
            style = {"color": INK, "linewidth": 0.9, "marker": ".", "markersize": 5, "label": "path"}
            axes.plot(path.zeta, path.omega, **style)
        _ends(axes, path, run)
        axes.set_xlabel(r"damping ratio $\zeta_{sp}$ [-]")
    whole.set_ylabel(r"undamped frequency $\omega_{sp}$ [rad/s]")
    whole.set_title("Short period")
    handles, labels = whole.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, columnspacing=1.2)
    return figure


def _short_period(run: Run) -> Path:
    """Damping and frequency of the baseline, the evaluations and the optimum, as far as recorded."""
    found = [run.baseline.values] if run.baseline else []
    found += [row.get("outputs", {}) | row.get("constraints", {}) for row in run.history]
    found += [run.optimum.values] if run.optimum else []
    pairs = [(v.get("zeta_sp"), v.get("omega_sp")) for v in found]
    kept = [(z, w) for z, w in pairs if z is not None and w is not None and z > 0.0 and math.isfinite(w)]
    table = np.array(kept, float).reshape(-1, 2)
    return Path(table[:, 0], table[:, 1])


def _whole_limits(axes: Axes, path: Path) -> None:
    """Logarithmic damping, with room for the path and for both boxes; ticks in plain numbers."""
    axes.set_xscale("log")
    low, high = min(0.15, 0.9 * float(path.zeta.min())), max(2.6, 1.1 * float(path.zeta.max()))
    axes.set_xlim(low, high)
    axes.set_ylim(min(0.8, 0.85 * float(path.omega.min())), max(4.5, 1.1 * float(path.omega.max())))
    ticks = [t for t in (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0) if low <= t <= high]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def _near_limits(axes: Axes, path: Path) -> None:
    """The path alone, linear."""
    for setter, values, least in ((axes.set_xlim, path.zeta, 0.02), (axes.set_ylim, path.omega, 0.05)):
        low, high = float(values.min()), float(values.max())
        room = 0.15 * max(high - low, least)
        setter(low - room, high + room)
    axes.xaxis.set_major_locator(MaxNLocator(5))


def _box(axes: Axes) -> None:
    """The box of the optimisation problem, as face and edge: only the edge hides the grid."""
    (left, right), (bottom, top) = TABLE_7_ZETA, TABLE_7_OMEGA
    corner, width, height = (left, bottom), right - left, top - bottom
    face = {"facecolor": "#56B4E9", "alpha": 0.25, "edgecolor": "none", "zorder": 0.6}
    edge = {"fill": False, "edgecolor": OPTIMUM, "linewidth": 1.3, "zorder": 1.5}
    axes.add_patch(Rectangle(corner, width, height, **face))
    axes.add_patch(Rectangle(corner, width, height, label="Table 7 of the paper", **edge))


def _mil_limits(axes: Axes, run: Run) -> None:
    """MIL-F-8785C: damping, and frequency where n/alpha of the optimum, else of the baseline, is recorded."""
    low, high = MIL_ZETA
    style = {"color": "#8A6D00", "linestyle": (0, (5, 3)), "linewidth": 1.2, "zorder": 1.4}
    omega = _mil_omega(run)
    limits = axes.get_xlim(), axes.get_ylim()
    w0, w1 = omega or limits[1]
    axes.plot([low, low], [w0, w1], label="MIL-F-8785C, Level 1, Cat. B", **style)
    axes.plot([high, high], [w0, w1], **style)
    for w in omega or ():
        axes.plot([low, high], [w, w], **style)
    axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])


def _mil_omega(run: Run) -> tuple[float, float] | None:
    """Frequencies at the bounds of CAP: n/alpha is omega_sp^2 / CAP of a snapshot."""
    for shot in (run.optimum, run.baseline):
        values = shot.values if shot else {}
        if values.get("CAP", 0.0) > 0.0 and "omega_sp" in values:
            slope = values["omega_sp"] ** 2 / values["CAP"]
            return math.sqrt(MIL_CAP[0] * slope), math.sqrt(MIL_CAP[1] * slope)
    return None


def _ends(axes: Axes, path: Path, run: Run) -> None:
    """Mark where the run began and ended, or the one point that there is."""
    last = "end" if run.optimum is not None else "latest"
    marks = [(0, "o", 9, BASELINE, "start"), (-1, "*", 15, OPTIMUM, last)]
    for i, marker, size, colour, label in marks if len(path.zeta) > 1 else [(0, "o", 9, BASELINE, "baseline")]:
        zeta, omega = float(path.zeta[i]), float(path.omega[i])
        text = rf"{label}: $\zeta$ {number(zeta, 3)}, $\omega$ {number(omega, 3)} rad/s"
        style = {"markeredgecolor": "white", "linestyle": "none", "zorder": 5}
        axes.plot(zeta, omega, marker=marker, markersize=size, color=colour, label=text, **style)
