"""Figure of the pressure difference over the lifting surfaces, from above and, for fins, from the side."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from hera_om.post.database import Snapshot, as_run
from hera_om.post.figures_shape import designs
from hera_om.post.style import INK, new_figure, no_data, styled
from hera_om.post.tables import Source

SHARE = 0.98
"""Share of the panels whose pressure the colours resolve: those at a leading edge peak without bound."""


@styled
def plot_pressure(source: Source) -> Figure:
    """Pressure below less above over dynamic pressure, on panels from above: baseline to port, optimum to starboard.

    Fins, which stand upright, are not seen from above and have no load in mirrored flow.
    """
    shots = [(d, s) for d, s in designs(as_run(source)) if s.arrays.get("pressure")]
    if not shots:
        return no_data(new_figure(2.0), "no snapshot with pressures was recorded")
    figure = new_figure(5.4)
    axes = figure.subplots()
    seen = [_panels(shot) for _, shot in shots]
    every = np.concatenate([value for _, value in seen])
    norm = _colours(every)
    for side, (corners, value) in zip((-1.0, 1.0), seen if len(seen) > 1 else seen * 2, strict=True):
        _half(axes, corners, value, side, norm)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.axvline(0.0, color="#999999", linewidth=0.8, linestyle=(0, (8, 3, 1, 3)))
    axes.set_xlabel("y [m], to starboard")
    axes.set_ylabel("x [m], aft of the nose")
    if len(shots) > 1:
        axes.set_title("baseline to port   |   optimum to starboard", loc="center")
    end = "both" if every.min() < norm.vmin else "max"
    bar = figure.colorbar(axes.collections[0], ax=axes, orientation="horizontal", shrink=0.7, aspect=32, extend=end)
    bar.set_label("pressure below less above over dynamic pressure, ΔCp [-]")
    return figure


def _panels(shot: Snapshot) -> tuple[np.ndarray, np.ndarray]:
    """Outlines [n, 4, 2] (y, x) and values [n] of the panels that are seen from above."""
    outlines, values = [], []
    for surface in shot.arrays["pressure"]:
        corners, value = np.asarray(surface["corners"], float), np.asarray(surface["pressure"], float)
        if np.ptp(corners[..., 1]) < np.ptp(corners[..., 2]):
            continue
        around = [corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]]
        outlines.append(np.stack(around, axis=2)[..., [1, 0]].reshape(-1, 4, 2))
        values.append(value.ravel())
    return np.concatenate(outlines), np.concatenate(values)


def _colours(values: np.ndarray) -> TwoSlopeNorm:
    """White at no load; as far as most panels go."""
    top = max(float(np.quantile(values, SHARE)), 1e-3)
    return TwoSlopeNorm(0.0, vmin=min(float(np.quantile(values, 1.0 - SHARE)), -0.2 * top), vmax=top)


def _half(axes: Axes, corners: np.ndarray, values: np.ndarray, side: float, norm: TwoSlopeNorm) -> None:
    """Draw one half of the aircraft."""
    style: dict[str, Any] = {"cmap": "RdBu_r", "norm": norm, "edgecolors": INK, "linewidths": 0.15}
    axes.add_collection(PolyCollection(list(corners * np.array([side, 1.0])), array=values, **style))
