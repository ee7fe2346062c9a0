"""The samples that a surrogate is trained and judged on, checked before anything is trained."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from hera_om.core.errors import Problem
from hera_om.surrogates.domain import outside, to_unit

SAME_POINT = 1e-12
"""Distance in the unit cube below which two samples are the same point."""

SAME_VALUE = 1e-9
"""Difference, relative to an output's largest magnitude, below which two values are the same."""

CONSTANT = 1e-12
"""An output whose range is below this part of max(1, its largest magnitude) is kept as a constant.

Lateral coefficients of a symmetric flow are rounding errors, and a model of those would be noise."""


class Samples(NamedTuple):
    """Inputs and outputs of the training samples and of the unseen ones, one sample a row."""

    x: Float[np.ndarray, "n d"]
    y: Float[np.ndarray, "n m"]
    x_test: Float[np.ndarray, "k d"]
    y_test: Float[np.ndarray, "k m"]


def shape_problems(samples: Samples, inputs: int, outputs: int) -> list[Problem]:
    """Tables that are not tables, or whose rows and columns do not fit each other and the names."""
    problems = []
    for name, table, columns in zip(samples._fields, samples, (inputs, outputs, inputs, outputs), strict=True):
        if table.ndim != 2 or table.shape[1] != columns:
            problems.append(Problem(name, "shape", table.shape, f"a table of {columns} columns"))
    least = {"x": 2 * (inputs + 1), "x_test": 2}
    if not problems:
        for name, table, values in (("x", samples.x, samples.y), ("x_test", samples.x_test, samples.y_test)):
            if table.shape[0] != values.shape[0]:
                rows = f"as many as rows of outputs: {values.shape[0]}"
                problems.append(Problem(name, "number of rows", table.shape[0], rows))
            if table.shape[0] < least[name]:
                expected = f"at least {least[name]}, for {inputs} inputs"
                problems.append(Problem(name, "number of rows", table.shape[0], expected))
    return problems


def value_problems(
    samples: Samples,
    input_names: Sequence[str],
    columns: Sequence[str],
    lower: Float[np.ndarray, " d"],
    upper: Float[np.ndarray, " d"],
) -> list[Problem]:
    """Numbers that are not finite, inputs outside the bounds, inputs that never vary, by name and row."""
    problems = []
    labels = (input_names, columns, input_names, columns)
    for name, table, label in zip(samples._fields, samples, labels, strict=True):
        for row, column in np.argwhere(~np.isfinite(table)):
            value = float(table[row, column])
            problems.append(Problem(name, f"{label[column]}, row {row}", value, "a finite number"))
    for name, table in (("x", samples.x), ("x_test", samples.x_test)):
        for row, point in enumerate(table):
            for i in outside(input_names, point, lower, upper):
                if np.isfinite(i.value):
                    expected = f"a value between {i.lower:g} and {i.upper:g}"
                    problems.append(Problem(name, f"{i.name}, row {row}", i.value, expected))
    for column in map(int, np.flatnonzero(np.ptp(samples.x, axis=0) == 0.0)):
        found = float(samples.x[0, column])
        problems.append(Problem("x", input_names[column], found, "more than one value among the samples"))
    return problems


def without_twins(
    samples: Samples,
    columns: Sequence[str],
    lower: Float[np.ndarray, " d"],
    upper: Float[np.ndarray, " d"],
) -> tuple[Samples, list[Problem]]:
    """Training samples without repeated points, and the points that no surrogate could honour.

    A repeated point teaches nothing and makes the equations of an interpolation singular, so the first of
    equal ones stays. Two values at one point, and an unseen point that was trained on, are faults of the
    caller.
    """
    unit, unit_test = to_unit(samples.x, lower, upper), to_unit(samples.x_test, lower, upper)
    scale = np.max(np.abs(samples.y), axis=0)
    keep, problems = np.ones(len(unit), dtype=bool), []
    for row in range(1, len(unit)):
        first = np.flatnonzero(keep[:row] & (np.max(np.abs(unit[:row] - unit[row]), axis=1) <= SAME_POINT))
        if first.size:
            keep[row] = False
            different = np.abs(samples.y[row] - samples.y[first[0]]) > SAME_VALUE * scale
            for column in map(int, np.flatnonzero(different)):
                key = f"{columns[column]}, rows {first[0]} and {row}"
                values = (float(samples.y[first[0], column]), float(samples.y[row, column]))
                problems.append(Problem("y", key, values, "one value at one point"))
    for row, point in enumerate(unit_test):
        if np.any(np.max(np.abs(unit - point), axis=1) <= SAME_POINT):
            problems.append(Problem("x_test", f"row {row}", "a training point", "a point not trained on"))
    return samples._replace(x=samples.x[keep], y=samples.y[keep]), problems


def is_constant(y: Float[np.ndarray, "n s"]) -> bool:
    """Whether an output does not vary over the samples."""
    return float(np.max(np.ptp(y, axis=0))) <= CONSTANT * max(1.0, float(np.max(np.abs(y))))
