"""Decomposition of array outputs: rank, tolerance, scaling, constants."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.surrogates.pod import decompose

STATION = np.linspace(0, 1, 12)


def loads(n=40):
    """A mean and three shapes, with amplitudes that fall by a hundred each."""
    a, b, c = np.random.default_rng(1).normal(size=(3, n, 1))
    return 2 + a * np.sin(STATION) + 1e-2 * b * np.cos(3 * STATION) + 1e-4 * c * STATION**2


@pytest.mark.parametrize(("tolerance", "modes"), [(0.5, 1), (1e-3, 2), (1e-8, 3)])
def test_as_many_modes_as_the_tolerance_asks(tolerance, modes):
    y = loads()
    pod, score = decompose(y, tolerance)
    assert pod.modes.shape == (12, modes)
    left_out = y - pod.mean - score @ pod.modes.T
    assert np.sqrt(np.mean(left_out**2)) <= tolerance * np.sqrt(np.mean((y - pod.mean) ** 2))


def test_scores_have_mean_zero_and_variance_one():
    _, score = decompose(loads(), 1e-8)
    assert np.mean(score, axis=0) == pytest.approx(0, abs=1e-8)
    assert score.T @ score / len(score) == pytest.approx(np.eye(3), abs=1e-8)


@given(factor=st.floats(1e-3, 1e3), offset=st.floats(-5, 5))
def test_scalar_is_only_standardised(factor, offset):
    y = offset + factor * np.array([[1.0], [2.0], [6.0]])
    pod, score = decompose(y)
    assert abs(pod.modes[0, 0]) == pytest.approx(np.std(y))
    assert pod.mean + score @ pod.modes.T == pytest.approx(y)


def test_array_that_never_varies_has_no_modes():
    pod, score = decompose(np.ones((5, 3)))
    assert pod.modes.shape == (3, 0) and score.shape == (5, 0)
    assert np.array_equal(pod.mean, np.ones(3))
