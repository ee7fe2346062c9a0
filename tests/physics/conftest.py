"""The derivative check that every physics test applies."""

import jax
import numpy as np
import pytest


def _richardson(function, x, steps):
    """Fourth-order central differences by every entry of a vector: the columns of the Jacobian."""
    columns = []
    for i, step in enumerate(steps):
        direction = np.zeros_like(x)
        direction[i] = step
        wide = (np.asarray(function(x + direction)) - np.asarray(function(x - direction))) / (2.0 * step)
        half = direction / 2.0
        narrow = (np.asarray(function(x + half)) - np.asarray(function(x - half))) / step
        columns.append((4.0 * narrow - wide) / 3.0)
    return np.stack(columns, axis=-1)


@pytest.fixture(scope="session")
def check_derivatives():
    """First derivatives in both modes and the second against differences, relative to the largest entry.

    The function maps a vector to a vector; scale its arguments so that one is a natural size for each.
    """

    def check(function, x, rtol=1e-6, relative_step=1e-3):
        x = np.asarray(x, dtype=float)
        steps = relative_step * np.maximum(np.abs(x), 1e-2)
        jacobian = jax.jit(jax.jacfwd(function))
        first = np.asarray(jacobian(x))
        assert np.all(np.isfinite(first)) and np.max(np.abs(first)) > 0.0
        expected = _richardson(jax.jit(function), x, steps)
        np.testing.assert_allclose(first, expected, rtol=0, atol=rtol * np.max(np.abs(expected)))
        np.testing.assert_allclose(jax.jit(jax.jacrev(function))(x), first, rtol=0, atol=1e-12 * np.max(np.abs(first)))
        second = np.asarray(jax.jit(jax.jacfwd(jax.jacfwd(function)))(x))
        expected = _richardson(jacobian, x, steps)
        np.testing.assert_allclose(second, expected, rtol=0, atol=rtol * max(np.max(np.abs(expected)), 1e-12))

    return check
