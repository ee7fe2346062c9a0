"""How good a surrogate is on points that it has not seen: R2, Re and RMSE of the paper's Eq. 1."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

R2_LEAST = 0.9
RE_MOST = 10.0
RMSE_MOST = 0.1
"""The paper's requirements: R2 > 0.9, Re < 10 %, RMSE < 0.1 for every output (its section on trim)."""

RE_FLOOR = 0.05
"""Least magnitude that an error is divided by, as a part of the largest magnitude of the output.

Re is infinite where an output passes through zero, as moments do. A point below 5 % of the largest
magnitude is judged as if it stood at 5 %."""

EXACT = 1e-9
"""Error, relative to the output's scale, that counts as none where R2 is undefined because nothing varies."""


class Quality(NamedTuple):
    """Errors of one output, or of one array of like entries pooled, over the unseen points.

    Attributes:
        r2: coefficient of determination; 1 is perfect, 0 is no better than the mean.
        re: mean relative error in percent.
        rmse: root mean square error divided by the range of the training samples.
        rmse_units: root mean square error in the unit of the output.
    """

    r2: float
    re: float
    rmse: float
    rmse_units: float

    def shortfalls(self) -> list[str]:
        """The thresholds that this output misses, in words; empty when it meets all three."""
        checks = (
            (self.r2 > R2_LEAST, f"R2 {self.r2:.4g}, required > {R2_LEAST:g}"),
            (self.re < RE_MOST, f"Re {self.re:.4g} %, required < {RE_MOST:g} %"),
            (self.rmse < RMSE_MOST, f"RMSE {self.rmse:.4g} of the range, required < {RMSE_MOST:g}"),
        )
        return [text for met, text in checks if not met]


def measure(
    predicted: Float[np.ndarray, "n s"],
    actual: Float[np.ndarray, "n s"],
    trained_on: Float[np.ndarray, "k s"],
) -> Quality:
    """Quality of predictions of one output at points that were not trained on.

    With e = predicted - actual, over all points (and entries of an array),

        R2 = 1 - sum e^2 / sum (actual - its mean over the points)^2
        Re = mean(|e| / max(|actual|, RE_FLOOR * scale)), in percent
        RMSE = sqrt(mean e^2), in units, and divided by the range

    where scale (largest magnitude) and range (of the entry that varies most) are those of the training
    samples, so that they do not depend on the few unseen points.

    Source: paper, Eq. 1. It leaves the averaging of Re, the guard at zero and the unit of RMSE open. Its
    Table 5 shows the unit: RMSE / sqrt(1 - R2), the standard deviation of the normalised output, is 0.26,
    0.25, 0.11, 0.38 for CL, CD, Cm and CT, which suits outputs scaled to [0, 1] (0.29 if uniform) and
    neither the raw CD nor outputs of variance 1.

    Args:
        predicted: predictions at n points, s entries each.
        actual: the discipline's own values there.
        trained_on: the k training samples.

    Returns:
        The four measures. R2 of an output that does not vary over the points is 1 if the error is below
        EXACT of the scale and 0 otherwise.
    """
    error = predicted - actual
    scale = float(np.max(np.abs(trained_on)))
    spread = float(np.max(np.ptp(trained_on, axis=0)))
    rmse_units = float(np.sqrt(np.mean(error**2)))
    floor = max(RE_FLOOR * scale, np.finfo(float).tiny)
    variation = float(np.sum((actual - np.mean(actual, axis=0)) ** 2))
    if variation > (EXACT * scale) ** 2 * actual.size:
        r2 = 1.0 - float(np.sum(error**2)) / variation
    else:
        r2 = float(rmse_units <= EXACT * scale)
    return Quality(
        r2=r2,
        re=100.0 * float(np.mean(np.abs(error) / np.maximum(np.abs(actual), floor))),
        rmse=rmse_units / (spread or scale or 1.0),
        rmse_units=rmse_units,
    )
