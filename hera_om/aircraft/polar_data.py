"""Numbers of section polar tables: CSV text to arrays, and NeuralFoil's answers to CSV text."""

import math
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from hera_om.aircraft.polars import COLUMNS, OPTIONAL, NeuralFoil
from hera_om.core.errors import InputError, Problem

AXES = COLUMNS[:3]
MIN_INCIDENCES = 4
"""Fewer incidences leave a cubic spline nothing to follow (choice)."""
MAX_SAME = 1e-9
"""Relative distance below which two values of an axis are one, written differently."""
MAX_FAULTS = 5
"""Faults of one kind that a report names; a broken table would give thousands."""
MAX_REACH_DEG = 60.0
"""Largest incidence of a table, deg: beyond it a polar of attached flow makes no sense (choice)."""


class PolarArrays(NamedTuple):
    """A polar table as arrays: increasing axes and values over them [na, nr, nm]."""

    alpha_deg: np.ndarray
    reynolds: np.ndarray
    mach: np.ndarray
    cl: np.ndarray
    cd: np.ndarray
    cm: np.ndarray


@lru_cache(maxsize=64)
def polar_arrays(text: str, label: str = "polar table") -> PolarArrays:
    """A table from CSV text: a header, then one line a point, in any order, that fill a tensor grid.

    Args:
        text: CSV with the columns alpha_deg, reynolds, mach, cl, cd and, if wanted, cm; ``#`` opens a comment.
        label: what a report calls the table.

    Raises:
        InputError: header, numbers, gaps, repeated points, ranges, too few rows, or a column without zero lift.
    """
    rows = _rows(text, label)
    axes, places = zip(*(_axis(rows[:, i]) for i in range(3)), strict=True)
    problems = [*_range_faults(axes, rows, label), *_grid_faults(axes, places, label)]
    if problems:
        raise InputError(problems)
    shape = tuple(len(axis) for axis in axes)
    values = np.empty((3, *shape))
    values[(slice(None), *places)] = rows[:, 3:].T
    arrays = PolarArrays(*axes, *values)
    problems = list(_lift_faults(arrays, label))
    if problems:
        raise InputError(problems)
    return arrays


def neuralfoil_table(wanted: NeuralFoil) -> str:
    """CSV text of a polar table by NeuralFoil, at Mach 0: the lattice's own rule brings compressibility in.

    Source: Sharpe and Hansman, NeuralFoil, arXiv 2503.16323 (2025).

    Raises:
        ModuleNotFoundError: the optional extra is not installed.
        ValueError: an unknown airfoil.
    """
    import aerosandbox  # pyright: ignore[reportMissingImports]
    import neuralfoil  # pyright: ignore[reportMissingImports]

    section = aerosandbox.Airfoil(wanted.airfoil.replace(" ", "").lower())
    if section.coordinates is None:
        raise ValueError(f"no coordinates of the airfoil {wanted.airfoil!r}")
    count = round((wanted.alpha_max_deg - wanted.alpha_min_deg) / wanted.alpha_step_deg) + 1
    alpha = np.linspace(wanted.alpha_min_deg, wanted.alpha_max_deg, count)
    lines = [",".join(COLUMNS)]
    for reynolds in wanted.reynolds:
        found = neuralfoil.get_aero_from_airfoil(
            section, alpha=alpha, Re=reynolds, n_crit=wanted.n_crit, model_size=wanted.model
        )
        columns = np.stack([alpha, *(np.broadcast_to(found[k], alpha.shape) for k in ("CL", "CD", "CM"))], axis=-1)
        lines += [f"{a:.6g},{reynolds:.6g},0,{cl:.6g},{cd:.6g},{cm:.6g}" for a, cl, cd, cm in columns]
    return "\n".join(lines) + "\n"


def _rows(text: str, label: str) -> np.ndarray:
    """The numbers of a CSV text [rows, 6], cm zero where it is absent."""
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    records = [line.split(",") for _, line in lines]
    header = [h.strip() for h in records[0]] if records else []
    missing = [c for c in COLUMNS if c not in header and c != OPTIONAL]
    unknown = [h for h in header if h not in COLUMNS]
    if missing or unknown or len(set(header)) < len(header):
        expected = f"a header of {','.join(COLUMNS[:-1])} and, if wanted, cm"
        raise InputError([Problem(label, "header", ",".join(header) or None, expected)])
    rows, problems = [], []
    for (i, line), record in zip(lines[1:], records[1:], strict=True):
        numbers = [_number(cell) for cell in record]
        if len(record) != len(header) or not all(map(math.isfinite, numbers)):
            problems.append(Problem(label, f"line {i}", line, f"{len(header)} finite numbers"))
            continue
        point = dict(zip(header, numbers, strict=True))
        rows.append([point.get(c, 0.0) for c in COLUMNS])
    if problems:
        raise InputError(problems[:MAX_FAULTS])
    if len(rows) < MIN_INCIDENCES:
        raise InputError([Problem(label, "rows", len(rows), f"at least {MIN_INCIDENCES} lines of numbers")])
    return np.array(rows)


def _number(cell: str) -> float:
    """A number, or NaN for what is none."""
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _axis(column: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different values of a column in increasing order, and the place of every row among them."""
    order = np.sort(column)
    scale = max(float(np.max(np.abs(order))), 1e-30)
    new = np.append(True, np.diff(order) > MAX_SAME * scale)
    axis = order[new]
    return axis, np.clip(np.searchsorted(axis, column + MAX_SAME * scale, side="right") - 1, 0, len(axis) - 1)


def _range_faults(axes, rows: np.ndarray, label: str) -> Iterator[Problem]:
    """Values that no polar has."""
    tests: list[tuple[str, float, Callable[[float], bool], str]] = [
        (
            "alpha_deg",
            float(np.max(np.abs(axes[0]))),
            lambda v: v <= MAX_REACH_DEG,
            f"-{MAX_REACH_DEG:g} to 60 degrees",
        ),
        ("reynolds", float(axes[1][0]), lambda v: v >= 1e3, "Reynolds numbers of at least 1000"),
        ("mach", float(axes[2][0]), lambda v: v >= 0.0, "Mach numbers from 0"),
        ("mach", float(axes[2][-1]), lambda v: v < 1.0, "Mach numbers below 1"),
        ("cd", float(np.min(rows[:, 4])), lambda v: v > 0.0, "drag coefficients above 0"),
        ("alpha_deg", len(axes[0]), lambda v: v >= MIN_INCIDENCES, f"at least {MIN_INCIDENCES} incidences"),
    ]
    yield from (Problem(label, key, value, text) for key, value, good, text in tests if not good(value))


def _grid_faults(axes, places, label: str) -> Iterator[Problem]:
    """Points of the tensor grid that have no row, or more than one."""
    shape = tuple(len(a) for a in axes)
    codes, count = np.unique(np.ravel_multi_index(places, shape), return_counts=True)
    candidates = np.arange(min(math.prod(shape), len(codes) + MAX_FAULTS))  # of a sparse grid only the first gaps
    for wrong, value, expected in (
        (np.setdiff1d(candidates, codes), "missing", "a row for each combination of alpha_deg, reynolds and mach"),
        (codes[count > 1], "repeated", "one row for each point"),
    ):
        for where in wrong[:MAX_FAULTS]:
            numbers = zip(AXES, axes, np.unravel_index(where, shape), strict=True)
            at = ", ".join(f"{name} = {axis[i]:g}" for name, axis, i in numbers)
            yield Problem(label, f"point {at}", value, expected)


def _lift_faults(arrays: PolarArrays, label: str) -> Iterator[Problem]:
    """Columns whose lift does not rise through zero: the effective incidence would have no origin."""
    rising = np.any((arrays.cl[:-1] <= 0.0) & (arrays.cl[1:] > 0.0), axis=0)
    for r, m in np.argwhere(~rising)[:MAX_FAULTS]:
        at = f"reynolds = {arrays.reynolds[r]:g}, mach = {arrays.mach[m]:g}"
        yield Problem(label, f"cl at {at}", "no zero", "lift that rises through zero within the incidences")
