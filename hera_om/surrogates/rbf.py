"""Gaussian radial basis functions with a linear trend: trained by SMT, kept as arrays, predicted in JAX."""

import contextlib
import io
from collections.abc import Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

WIDTHS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)
"""Widths d0 that cross-validation chooses from, in edges of the unit cube.

Below 0.1 a basis function no longer reaches its neighbour; above 8 nothing is gained on ten inputs, and the
weights grow until their rounding errors show in the derivatives."""

REGULARISATION = 1e-9
"""Added to the diagonal of the matrix of basis functions, as Kriging's nugget and for the same reason."""

FOLDS = 5
"""Parts of the training samples of which each is predicted once from the others."""


class RbfModel(NamedTuple):
    """Radial basis functions of m outputs on the same n points of the unit cube, with a linear trend."""

    points: Float[np.ndarray, "n d"]
    width: Float[np.ndarray, " m"]
    weights: Float[np.ndarray, "n m"]
    constant: Float[np.ndarray, " m"]
    slope: Float[np.ndarray, "d m"]


def train(unit: Float[np.ndarray, "n d"], y: Float[np.ndarray, "n m"], seed: int) -> RbfModel:
    """Interpolation of each column of y, with the width that predicts left-out training points best.

    Args:
        unit: training points, scaled to the unit cube. SMT does not scale, and one width serves all inputs,
            so on unscaled inputs the model is useless.
        y: outputs at the points.
        seed: seed of the partition into folds.

    Returns:
        The model of all columns, each with its own width.
    """
    width = choose_width(unit, y, seed)
    n, d = unit.shape
    solution = np.zeros((n + 1 + d, y.shape[1]))
    for d0 in np.unique(width):
        alike = width == d0
        solution[:, alike] = fit_smt(unit, y[:, alike], float(d0)).sol
    return RbfModel(unit, width, solution[:n].copy(), solution[n].copy(), solution[n + 1 :].copy())


def predict(model: RbfModel, u: Float[Array, " d"]) -> Float[Array, " m"]:
    """Trend and basis functions: y_j = a_j + b_j . u + sum_i w_ij exp(-|u - U_i|^2 / d0_j^2).

    Source: Powell, "The theory of radial basis function approximation in 1990" (1992), as in SMT's ``RBF``.

    Args:
        model: the arrays of ``train``.
        u: point of the unit cube; a point far outside is computed too and tends to the trend.

    Returns:
        The m outputs.
    """
    distance2 = jnp.sum((u - model.points) ** 2, axis=1, keepdims=True)
    basis = jnp.exp(-distance2 / model.width**2)
    return jnp.asarray(model.constant) + u @ jnp.asarray(model.slope) + jnp.sum(basis * model.weights, axis=0)


def select(model: RbfModel, outputs: Sequence[int]) -> RbfModel:
    """The model of some of the outputs only."""
    chosen = np.asarray(outputs, dtype=int)
    per_output = (model.weights[:, chosen], model.constant[chosen], model.slope[:, chosen])
    return RbfModel(model.points, model.width[chosen], *per_output)


def choose_width(unit: Float[np.ndarray, "n d"], y: Float[np.ndarray, "n m"], seed: int) -> Float[np.ndarray, " m"]:
    """The width of least squared error in FOLDS-fold cross-validation, for each column of y."""
    fold = np.random.default_rng(seed).permutation(unit.shape[0]) % FOLDS
    errors = np.zeros((len(WIDTHS), y.shape[1]))
    for i, d0 in enumerate(WIDTHS):
        for k in range(FOLDS):
            held = fold == k
            smt = fit_smt(unit[~held], y[~held], d0)
            errors[i] += np.sum((smt.predict_values(unit[held]) - y[held]) ** 2, axis=0)
    return np.asarray(WIDTHS)[np.argmin(errors, axis=0)]


def fit_smt(unit: Float[np.ndarray, "n d"], y: Float[np.ndarray, "n m"], d0: float) -> Any:
    """SMT's own trained model (its prints swallowed: they go to standard output)."""
    from smt.surrogate_models import RBF

    model = RBF(print_global=False, d0=d0, poly_degree=1, reg=REGULARISATION)
    with contextlib.redirect_stdout(io.StringIO()):
        model.set_training_values(unit, y)
        model.train()
    return model
