"""Factors in double precision and refined single ones against known solutions."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import refined_lu

SIZE, COLUMNS = 60, 7
RANDOM = np.random.default_rng(1)


@pytest.fixture(params=["single", "double"])
def precision(request, monkeypatch):
    """Either kind of factors for small matrices."""
    monkeypatch.setattr(refined_lu, "SINGLE_FROM", 0 if request.param == "single" else 10**9)
    return request.param


def matrix_of(condition):
    """A matrix of random singular vectors with singular values from 1 down to 1 / condition."""
    left, right = (np.linalg.qr(RANDOM.normal(size=(SIZE, SIZE)))[0] for _ in range(2))
    return left @ np.diag(np.geomspace(1.0, 1.0 / condition, SIZE)) @ right


@pytest.mark.parametrize("transpose", [False, True])
@pytest.mark.parametrize("condition", [1e2, 1e4])
def test_as_accurate_as_factors_in_double_precision(condition, transpose, precision):
    matrix = matrix_of(condition)
    truth = RANDOM.normal(size=(SIZE, COLUMNS)) * np.geomspace(1e-9, 1e9, COLUMNS)
    used = matrix.T if transpose else matrix
    padded = jnp.asarray(np.vstack([matrix, matrix[:5]]))  # rows beyond the last have no part
    lu = refined_lu.factorise(padded)
    assert lu.factors.triangles.dtype == {"single": jnp.float32, "double": jnp.float64}[precision]
    x = refined_lu.solve(lu, jnp.asarray(used @ truth), transpose=transpose)
    residual = np.max(np.abs(used @ x - used @ truth), axis=0) / np.max(np.abs(x), axis=0)
    assert np.max(residual) < 1e-14
    error = np.max(np.abs(x - truth), axis=0) / np.max(np.abs(truth), axis=0)
    assert np.max(error) < 1e-15 * condition


def test_right_hand_sides_in_batches_and_of_zero(precision):
    lu = refined_lu.factorise(jnp.asarray(matrix_of(1e2)))
    rhs = jnp.asarray(RANDOM.normal(size=(3, SIZE, 2))).at[1].set(0.0)
    batch = jax.vmap(lambda b: refined_lu.solve(lu, b, transpose=True))(rhs)
    for one, b in zip(batch, rhs, strict=True):
        np.testing.assert_allclose(one, refined_lu.solve(lu, b, transpose=True), rtol=0, atol=1e-14 * 1e2 * 4)
    assert not np.any(batch[1])


def test_a_matrix_beyond_single_precision_gives_no_number(monkeypatch):
    monkeypatch.setattr(refined_lu, "SINGLE_FROM", 0)
    matrix = matrix_of(1e12)
    x = refined_lu.solve(refined_lu.factorise(jnp.asarray(matrix)), jnp.asarray(RANDOM.normal(size=(SIZE, 1))))
    assert np.all(np.isnan(x))
