"""R2, Re and RMSE against numbers worked by hand, and how they change with units."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.surrogates.quality import RE_FLOOR, Quality, measure

ACTUAL = np.array([[1.0], [2.0], [3.0], [4.0]])
PREDICTED = np.array([[1.1], [1.9], [3.2], [3.8]])
TRAINED_ON = np.array([[0.0], [5.0], [2.0]])


def test_measures_by_hand():
    """Errors 0.1, -0.1, 0.2, -0.2: sum of squares 0.1, of deviations from 2.5 it is 5."""
    quality = measure(PREDICTED, ACTUAL, TRAINED_ON)
    assert quality.r2 == pytest.approx(1 - 0.1 / 5)
    assert quality.re == pytest.approx(100 * (0.1 / 1 + 0.1 / 2 + 0.2 / 3 + 0.2 / 4) / 4)
    assert quality.rmse_units == pytest.approx(np.sqrt(0.1 / 4))
    assert quality.rmse == pytest.approx(np.sqrt(0.1 / 4) / 5)


@given(factor=st.floats(1e-6, 1e6), offset=st.floats(-10, 10))
def test_units_change_only_the_error_in_units(factor, offset):
    plain, other = (measure(f * PREDICTED, f * ACTUAL, f * TRAINED_ON) for f in (1.0, factor))
    assert other[:3] == pytest.approx(plain[:3], rel=1e-9)
    assert other.rmse_units == pytest.approx(factor * plain.rmse_units)
    shifted = measure(PREDICTED + offset, ACTUAL + offset, TRAINED_ON + offset)
    assert (shifted.r2, shifted.rmse) == pytest.approx((plain.r2, plain.rmse), rel=1e-6)


def test_relative_error_is_guarded_where_the_output_passes_through_zero():
    actual, trained_on = np.array([[0.0], [2.0]]), np.array([[-2.0], [2.0]])
    quality = measure(actual + 0.01, actual, trained_on)
    assert quality.re == pytest.approx(100 * (0.01 / (RE_FLOOR * 2) + 0.01 / 2) / 2)


def test_array_is_pooled_with_the_mean_of_each_entry():
    """Entries of different level: between them there is variation that no model has to explain."""
    actual = np.column_stack([ACTUAL, ACTUAL + 100])
    predicted = np.column_stack([PREDICTED, PREDICTED + 100])
    assert measure(predicted, actual, actual).r2 == pytest.approx(1 - 0.1 / 5)


@pytest.mark.parametrize(("error", "r2"), [(0.0, 1.0), (1e-3, 0.0)])
def test_output_that_does_not_vary_over_the_unseen_points(error, r2):
    constant = np.full((4, 1), 7.0)
    assert measure(constant + error, constant, constant).r2 == r2


def test_all_zero_output_predicted_exactly():
    zero = np.zeros((4, 1))
    assert measure(zero, zero, zero) == Quality(1.0, 0.0, 0.0, 0.0)


def test_normalisation_explains_the_papers_own_figures():
    """Table 5 (R2, RMSE of CL, CD, Cm): the deviation they imply is that of outputs scaled to [0, 1]."""
    for r2, rmse in ((0.9993, 0.0070), (0.9757, 0.0389), (0.9979, 0.0051)):
        deviation = rmse / np.sqrt(1 - r2)
        assert 0.1 < deviation < 1 / np.sqrt(12)


@pytest.mark.parametrize(
    ("quality", "missed"),
    [
        (Quality(0.91, 9.9, 0.09, 1.0), []),
        (Quality(0.90, 9.9, 0.09, 1.0), ["R2"]),
        (Quality(0.91, 10.0, 0.09, 1.0), ["Re"]),
        (Quality(0.91, 9.9, 0.1, 1.0), ["RMSE"]),
        (Quality(-1.0, 50.0, 0.5, 1.0), ["R2", "Re", "RMSE"]),
        (Quality(float("nan"), float("nan"), float("nan"), 1.0), ["R2", "Re", "RMSE"]),
    ],
)
def test_thresholds_of_the_paper(quality, missed):
    assert [text.split()[0] for text in quality.shortfalls()] == missed
