"""What all figures share: colours, sizes, labels that keep clear of each other, and units fit to be read."""

import io
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, TypeVar

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, GRID = "#222222", "#DDDDDD"
BASELINE, OPTIMUM, VIOLATED = "#767676", "#0072B2", "#C8321E"
COLOURS = {"baseline": BASELINE, "optimum": OPTIMUM}
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#8A6D00", "#56B4E9", "#5B3A8C", "#444444")
"""Okabe and Ito's colours, told apart with every kind of colour blindness; the yellow is darkened."""

WIDTH = 7.2
"""Width of every figure in inches: the text column of the page, so that type has one size."""

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.edgecolor": "#888888",
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "legend.fontsize": 9,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.8,
    "svg.fonttype": "path",
    "svg.hashsalt": "hera_om",
}
_Function = TypeVar("_Function", bound=Callable[..., Figure])
_READABLE = {"W": (1e-3, "kW"), "rad": (57.29577951308232, "deg"), "m/J": (3600.0, "km/kWh")}


def styled(function: _Function) -> _Function:
    """Draw a figure in the house style; matplotlib's own settings are as before afterwards."""

    @wraps(function)
    def draw(*args: Any, **kwargs: Any) -> Figure:
        with matplotlib.rc_context(_RC):
            return function(*args, **kwargs)

    return draw  # type: ignore[return-value]


class Picture(Figure):
    """A figure that a notebook shows although pyplot, which would arrange for that, is not in use."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=120)
        return buffer.getvalue()


def new_figure(height: float) -> Figure:
    """An empty figure that belongs to no window and to no global list."""
    figure = Picture(figsize=(WIDTH, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def readable(units: str | None, size: float = 1.0) -> tuple[float, str]:
    """Factor and unit in which a number is shown; an area below 0.05 m2 in cm2."""
    if units == "m**2" and 0.0 < abs(size) < 0.05:
        return 1e4, "cm²"
    factor, shown = _READABLE.get(units or "", (1.0, units or ""))
    return factor, shown.replace("**2", "²").replace("**3", "³").replace("*", "·")


def with_units(text: str, units: str) -> str:
    """An axis label."""
    return f"{text} [{units}]" if units else text


def number(value: float | None, digits: int = 4) -> str:
    """A number for people: significant digits, no exponent in the usual range, a true minus sign."""
    if value is None or value != value:
        return "–"
    size = abs(value)
    if size != 0.0 and not 1e-4 <= size < 1e7:
        text = f"{value:.{digits - 1}e}"
    elif size >= 10 ** (digits - 1):
        text = f"{value:,.0f}".replace(",", "\N{THIN SPACE}")
    else:
        text = f"{value:#.{digits}g}".rstrip(".") if size else "0"
    return text.replace("-", "−")


def label_ends(axes: Axes, entries: Sequence[tuple[float, str, str]], gap: float = 12.0) -> None:
    """Name curves at the right edge of the axes; texts are spread to be apart.

    Args:
        axes: with final limits of its vertical axis.
        entries: height in data, text and colour, one a curve.
        gap: least distance of two texts in points.
    """
    height = axes.get_position().height * axes.figure.get_size_inches()[1] * 72.0  # type: ignore[union-attr]
    least = gap / max(height, 1.0)
    wanted = sorted(
        (float(axes.transAxes.inverted().transform(axes.transData.transform((0.0, y)))[1]), text, colour)
        for y, text, colour in entries
    )
    places = _spread([w[0] for w in wanted], least)
    for place, (at, text, colour) in zip(places, wanted, strict=True):
        axes.annotate(
            text,
            xy=(1.0, at),
            xytext=(1.035, place),
            xycoords="axes fraction",
            textcoords="axes fraction",
            color=colour,
            va="center",
            fontsize=9,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1, "shrinkB": 0},
        )


def _spread(wanted: Sequence[float], least: float) -> list[float]:
    """Ascending places at least so far apart, near those wanted and as far as possible within 0..1."""
    places: list[float] = []
    for w in wanted:
        places.append(max(w, places[-1] + least) if places else w)
    excess = max(places[-1] - 1.0, 0.0) if places else 0.0
    limit = 1.0
    for i in range(len(places) - 1, -1, -1):
        if excess and places[i] > limit:
            places[i] = limit
        limit = places[i] - least
    return places


def no_data(figure: Figure, why: str) -> Figure:
    """A low figure that says why it is empty."""
    figure.set_size_inches(WIDTH, 0.8)
    figure.text(0.5, 0.5, why, ha="center", va="center", color="#666666")
    return figure
