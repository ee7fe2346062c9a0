"""Numbers of section polar tables: CSV text to arrays, and NeuralFoil's answers to CSV text."""

import math
from collections.abc import Callable, Iterator
from functools import lru_cache
from typing import Any, NamedTuple

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
FULL_REACH_DEG = 180.0
"""The same of the table of a blade, which may meet the air from any side."""
LEAST_END_DEG, LARGEST_END_DEG = 1.0, 90.0
"""Where a table may end for `physics.polar_extension.full_incidence` to go on."""
MACH_NUMBERS = (0.0, 0.2, 0.4, 0.5, 0.6, 0.7)
"""To which a table of Mach 0 alone is continued by the rule of Prandtl and Glauert (choice)."""
PERIODIC = 1e-6
"""Largest difference of coefficients at -180 and 180 degrees, as in `physics.blade_polar`."""


class PolarArrays(NamedTuple):
    """A polar table as arrays: increasing axes and values over them [na, nr, nm]."""

    alpha_deg: np.ndarray
    reynolds: np.ndarray
    mach: np.ndarray
    cl: np.ndarray
    cd: np.ndarray
    cm: np.ndarray


@lru_cache(maxsize=64)
def polar_arrays(text: str, label: str = "polar table", reach: float = MAX_REACH_DEG) -> PolarArrays:
    """A table from CSV text: a header, then one line a point, in any order, that fill a tensor grid.

    Args:
        text: CSV with the columns alpha_deg, reynolds, mach, cl, cd and, if wanted, cm; ``#`` opens a comment.
        label: what a report calls the table.
        reach: largest incidence that makes sense, deg.

    Raises:
        InputError: header, numbers, gaps, repeated points, ranges, too few rows, or a column without zero lift.
    """
    rows = _rows(text, label)
    axes, places = zip(*(_axis(rows[:, i]) for i in range(3)), strict=True)
    problems = [*_range_faults(axes, rows, label, reach), *_grid_faults(axes, places, label)]
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


def blade_arrays(csv: str, label: str = "polar table") -> PolarArrays:
    """`polar_arrays` of a blade."""
    return polar_arrays(csv, label, FULL_REACH_DEG)


def extends(text: str, label: str, raw: dict[str, Any], *, key: tuple[str, str]) -> bool:
    """Check the table of a blade; whether it ends short of 180 degrees and is to be extended.

    Args:
        text: CSV.
        label: what a report calls the table.
        raw: the raw polar table of the definition.
        key: file and path of the latter.

    Raises:
        InputError: the faults of `polar_arrays`; a table that ends short of 180 degrees where it must not be
            extended or cannot be; one that differs between -180 and 180 degrees.
    """
    arrays = blade_arrays(text, label)
    if _is_full(arrays):
        gaps = [(n, float(np.max(np.abs(v[0] - v[-1])))) for n, v in (("cl", arrays.cl), ("cd", arrays.cd))]
        at = "the value at alpha_deg = -180 again at 180, not"
        _raise_any([Problem(label, n, "differs", f"{at} {gap:g} from it") for n, gap in gaps if gap > PERIODIC])
        return False
    covered = f"{arrays.alpha_deg[0]:g} to {arrays.alpha_deg[-1]:g}"
    if raw.get("extend") is False:
        expected = f"true, or a table from -180 to 180 degrees, which a blade needs: {label} covers {covered}"
        raise InputError([Problem(key[0], f"{key[1]}.extend", False, expected)])
    kept = arrays.alpha_deg if raw.get("compressible") is False else _kept(arrays)
    ends = (-kept[0], kept[-1]) if len(kept) else (0.0, 0.0)
    if not all(LEAST_END_DEG < end < LARGEST_END_DEG for end in ends):
        expected = f"ends between {LEAST_END_DEG:g} and {LARGEST_END_DEG:g} degrees on either side of zero"
        shrunk = "" if kept is arrays.alpha_deg else f", also {_factor():.3g} times nearer to zero lift (compressible)"
        raise InputError([Problem(label, "alpha_deg", covered, f"{expected}{shrunk}, or -180 to 180 degrees")])
    return True


def mach_numbers(csv: str, compressible: bool) -> tuple[float, ...]:
    """Mach numbers of the table of a blade, with those that the rule of Prandtl and Glauert brings in."""
    arrays = blade_arrays(csv)
    return MACH_NUMBERS if compressible and _is_continued(arrays) else tuple(arrays.mach)


def blade_axes(csv: str, compressible: bool) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Reynolds and Mach numbers of the table of a blade."""
    return tuple(blade_arrays(csv).reynolds), mach_numbers(csv, compressible)


def aspect_ratio(r: Any, c: Any) -> float | None:
    """Tip radius over the chord at 75 % of it, of raw stations; None where these are faulty."""
    try:
        chord = float(np.interp(0.75, np.asarray(r, float), np.asarray(c, float)))
    except (TypeError, ValueError):
        return None
    return 1.0 / chord if math.isfinite(chord) and chord > 0.0 else None


def _raise_any(problems: list[Problem]) -> None:
    """Raise what there is."""
    if problems:
        raise InputError(problems)


def _is_full(arrays: PolarArrays) -> bool:
    """Whether a table covers the full circle."""
    return arrays.alpha_deg[0] <= PERIODIC - FULL_REACH_DEG and arrays.alpha_deg[-1] >= FULL_REACH_DEG - PERIODIC


def _is_continued(arrays: PolarArrays) -> bool:
    """Whether the rule of Prandtl and Glauert may continue a table: attached flow at Mach 0."""
    return not _is_full(arrays) and len(arrays.mach) == 1 and float(arrays.mach[0]) == 0.0


def _factor() -> float:
    """Prandtl's and Glauert's factor at the largest Mach number of a continued table."""
    return 1.0 / math.sqrt(1.0 - MACH_NUMBERS[-1] ** 2)


def _kept(arrays: PolarArrays) -> np.ndarray:
    """Incidences that a table reaches at every Mach number, see `physics.polar_extension.with_mach_numbers`."""
    if not _is_continued(arrays):
        return arrays.alpha_deg
    ends = []
    for lift in arrays.cl[:, :, 0].T:
        i = int(np.flatnonzero((lift[:-1] <= 0.0) & (lift[1:] > 0.0))[0])
        zero = float(np.interp(0.0, lift[i : i + 2], arrays.alpha_deg[i : i + 2]))
        ends.append([zero + (end - zero) / _factor() for end in arrays.alpha_deg[[0, -1]]])
    low, high = np.max(ends, axis=0)[0], np.min(ends, axis=0)[1]
    return arrays.alpha_deg[(arrays.alpha_deg >= low) & (arrays.alpha_deg <= high)]


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


def _range_faults(axes, rows: np.ndarray, label: str, reach: float) -> Iterator[Problem]:
    """Values that no polar has."""
    tests: list[tuple[str, float, Callable[[float], bool], str]] = [
        (
            "alpha_deg",
            float(np.max(np.abs(axes[0]))),
            lambda v: v <= reach,
            f"-{reach:g} to {reach:g} degrees",
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
