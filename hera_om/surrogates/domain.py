"""The box of inputs in which a surrogate was trained: scaling to [0, 1], and who lies outside."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hera_om.core.errors import Problem

TOLERANCE = 1e-9
"""Share of an input's range by which a value may pass its bound: rounding of a unit conversion, no more."""


class Outside(NamedTuple):
    """One input that lies outside the box of the training samples."""

    name: str
    value: float
    lower: float
    upper: float


def bounds_problems(
    source: str, lower: Float[np.ndarray, "..."], upper: Float[np.ndarray, "..."], names: Sequence[str] = ()
) -> list[Problem]:
    """What keeps two arrays from being the bounds of a box, each fault named by its input (or its index)."""
    if lower.ndim != 1 or lower.shape != upper.shape or lower.size == 0:
        shapes = f"shapes {lower.shape} and {upper.shape}"
        return [Problem(source, "lower, upper", shapes, "two lists of numbers of the same length")]
    bad = np.flatnonzero(~(np.isfinite(lower) & np.isfinite(upper) & (lower < upper)))
    return [
        Problem(
            source,
            f"bounds of {names[i] if names else i}",
            (float(lower[i]), float(upper[i])),
            "two finite numbers, the lower one first",
        )
        for i in map(int, bad)
    ]


def to_unit(
    x: Float[np.ndarray, "*n d"], lower: Float[np.ndarray, " d"], upper: Float[np.ndarray, " d"]
) -> Float[np.ndarray, "*n d"]:
    """Inputs scaled so that the box becomes the unit cube."""
    return (x - lower) / (upper - lower)


def outside(
    names: Sequence[str],
    x: Float[np.ndarray, " d"],
    lower: Float[np.ndarray, " d"],
    upper: Float[np.ndarray, " d"],
) -> list[Outside]:
    """Every input of one point that lies outside its bounds, or is not a number.

    A Kriging model falls back to its mean outside the samples and an RBF model to its linear trend, both
    without a sign of it, so whoever evaluates a surrogate asks here and says so.
    """
    margin = TOLERANCE * (upper - lower)
    inside = (x >= lower - margin) & (x <= upper + margin)
    return [Outside(names[i], float(x[i]), float(lower[i]), float(upper[i])) for i in map(int, np.flatnonzero(~inside))]
