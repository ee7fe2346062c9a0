"""Kriging: trained by SMT one output at a time, kept as arrays, predicted in JAX."""

import contextlib
import io
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.core.errors import AnalysisFailure

NUGGET = 1e-9
"""Added to the diagonal of the correlation matrix, of variance 1.

SMT's default, 2e-14, lets the weights of a smooth output grow past 1e6 and their rounding errors into the
derivatives. With 1e-9 the predictions of the test functions keep errors below 1e-3 of the output's standard
deviation where the samples allow it, and rounding stays near 1e-9 of it."""

THETA_START = 0.1
"""Where the search of the correlation parameters starts, for standardised inputs.

Those of smooth functions end between 1e-5 and 10. From SMT's own 0.01 the search ends, on Forrester's
function, in the region where the correlation matrix is singular and the likelihood flat."""


class KrigingModel(NamedTuple):
    """Ordinary Kriging of m outputs on n points of the unit cube, squared-exponential correlation."""

    points: Float[np.ndarray, "n d"]
    theta: Float[np.ndarray, "m d"]
    weights: Float[np.ndarray, "n m"]
    mean: Float[np.ndarray, " m"]


def train(
    unit: Float[np.ndarray, "n d"],
    y: Float[np.ndarray, "n m"],
    seed: int,
    *,
    labels: Sequence[str],
    progress: Callable[[int, int, str], None] | None = None,
) -> KrigingModel:
    """Kriging of each column of y by maximum likelihood.

    One process an output: a shared one would share its correlation lengths. COBYLA searches them, because
    SMT's default (TNC) is several times slower. Squared exponential, because the outputs are smooth and the
    model then has all its derivatives everywhere; Matern 5/2 was no more accurate on smooth functions.

    Args:
        unit: training points, scaled to the unit cube; no two alike.
        y: outputs at the points; none constant.
        seed: seed of the second start of the likelihood search.
        labels: name of each column, for messages.
        progress: called with (columns done, columns, name of the last) after each.

    Returns:
        The model of all columns.

    Raises:
        AnalysisFailure: the likelihood search found no correlation matrix that can be factorised.
    """
    columns = []
    for j, label in enumerate(labels):
        try:
            columns.append(_train_one(unit, y[:, [j]], seed))
        except (ValueError, RuntimeError, np.linalg.LinAlgError) as error:
            raise AnalysisFailure(f"Kriging was not trained: {error}", where=label) from error
        if progress:
            progress(j + 1, len(labels), label)
    return KrigingModel(
        points=unit,
        theta=np.array([theta for theta, _, _ in columns]).reshape(-1, unit.shape[1]),
        weights=np.array([weights for _, weights, _ in columns]).reshape(-1, unit.shape[0]).T.copy(),
        mean=np.array([mean for _, _, mean in columns], dtype=float),
    )


def predict(model: KrigingModel, u: Float[Array, " d"]) -> Float[Array, " m"]:
    """Best linear unbiased prediction: y_j = mean_j + sum_i weights_ij exp(-sum_k theta_jk (u_k - U_ik)^2).

    Source: Sacks, Welch, Mitchell and Wynn, Statistical Science 4 (1989), Eq. 7, with SMT's parameters.

    Args:
        model: the arrays of ``train``.
        u: point of the unit cube; a point outside is computed too and tends to the mean.

    Returns:
        The m outputs.
    """
    correlation = jnp.exp(-((u - model.points) ** 2) @ jnp.asarray(model.theta).T)
    return jnp.asarray(model.mean) + jnp.sum(correlation * model.weights, axis=0)


def select(model: KrigingModel, outputs: Sequence[int]) -> KrigingModel:
    """The model of some of the outputs only."""
    chosen = np.asarray(outputs, dtype=int)
    return KrigingModel(model.points, model.theta[chosen], model.weights[:, chosen], model.mean[chosen])


def fit_smt(unit: Float[np.ndarray, "n d"], y: Float[np.ndarray, "n 1"], seed: int) -> Any:
    """SMT's own trained model of one output (its prints swallowed: they go to standard output)."""
    from smt.surrogate_models import KRG

    model = KRG(
        print_global=False,
        corr="squar_exp",
        poly="constant",
        hyper_opt="Cobyla",
        n_start=1,
        theta0=[THETA_START],
        nugget=NUGGET,
        seed=seed,
    )
    with contextlib.redirect_stdout(io.StringIO()):
        model.set_training_values(unit, y)
        model.train()
    return model


def _train_one(
    unit: Float[np.ndarray, "n d"], y: Float[np.ndarray, "n 1"], seed: int
) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " n"], float]:
    """Correlation parameters, weights and mean of one output, with SMT's own scaling folded in."""
    smt = fit_smt(unit, y, seed)
    theta = np.ravel(smt.optimal_theta) / np.ravel(smt.X_scale) ** 2
    weights = np.ravel(smt.optimal_par["gamma"]) * np.ravel(smt.y_std)[0]
    mean = np.ravel(smt.y_mean)[0] + np.ravel(smt.y_std)[0] * np.ravel(smt.optimal_par["beta"])[0]
    return theta, weights, float(mean)
