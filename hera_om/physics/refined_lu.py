"""Linear systems from factors in double precision or, large ones, from factors in single precision, refined to double.

The factorisation is the only part of a dense solve whose cost grows with the third power, and in single
precision it takes half the time. Its error E = 1 - A M^-1, with M the product of the single factors, is about
the condition number times 6e-8; each refinement x <- x + M^-1 (b - A x), with the residual in double, multiplies
the residual by E (Langou et al., Exploiting the performance of 32 bit floating point arithmetic in obtaining
64 bit accuracy, SC 2006; LAPACK's dsgesv). Influence matrices of lattices have condition numbers of about 100.
"""

from itertools import pairwise
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float, Int32

SINGLE_FROM = 1500
"""Unknowns from which single factors are worth refining: below, the refinements of gradients cost what is saved."""
ENOUGH = 1e-15
"""Error of the refined solution over its largest entry, as two corrections in a row foretell it."""
CONVERGED = 1e-8
"""Last correction over the largest entry above which refinement has failed."""


LEAST_BLOCK, MOST_BLOCKS = 100, 20
"""Rows of a block of a triangle, and how many blocks there are at most."""


class Factors(NamedTuple):
    """Unit lower and upper triangle of the transpose of a matrix, its rows in another order."""

    triangles: Float[Array, "n n"]
    order: Int32[Array, " n"]


class RefinedLU(NamedTuple):
    """A matrix in double precision and its factors, large ones in single precision."""

    rows: Float[Array, "q n"]  # the first n are the matrix
    factors: Factors


def factorise(rows: Float[Array, "q n"]) -> RefinedLU:
    """Factors of a matrix, the first n of the rows, for `solve`.

    Those of the transpose: LAPACK wants columns to lie together, and here rows do.
    """
    n = rows.shape[1]
    triangles, _, order = lax.linalg.lu(rows[:n].astype(jnp.float32 if n >= SINGLE_FROM else rows.dtype).T)
    return RefinedLU(rows, Factors(triangles, order))


def solve(lu: RefinedLU, rhs: Float[Array, "n m"], *, transpose: bool = False) -> Float[Array, "n m"]:
    """Solutions of A x = b, or of its transpose, to the accuracy of factors in double precision.

    Args:
        lu: see `factorise`.
        rhs: right-hand sides b.
        transpose: whether to solve with the transposed matrix.

    Returns:
        Solutions. With single factors refinement ends when the next correction is below rounding or no longer half
        the last one. It converges up to condition numbers of about 1e6; columns for which it does not are NaN, never
        inaccurate.
    """

    def goes_on(now):
        x, dx, last = now
        return jnp.any((_size(dx) ** 2 > ENOUGH * last * _size(x)) & (_size(dx) <= last / 2))

    def refine(now):
        x, dx, _ = now
        x = x + dx
        return x, _by_factors(lu.factors, rhs - _product(lu.rows, x, transpose), transpose), _size(dx)

    rough = _by_factors(lu.factors, rhs, transpose)
    if lu.factors.triangles.dtype == rhs.dtype:
        return rough
    x, dx, _ = lax.while_loop(goes_on, refine, (jnp.zeros_like(rhs), rough, 2.0 * _size(rough)))
    return jnp.where(_size(dx) <= CONVERGED * _size(x), x + dx, jnp.nan)


def _size(x: Float[Array, "n m"]) -> Float[Array, " m"]:
    """Largest entries of columns."""
    return jnp.max(jnp.abs(x), axis=0)


def _product(rows: Float[Array, "q n"], x: Float[Array, "n m"], transpose: bool) -> Float[Array, "n m"]:
    """A x, or the product with the transpose."""
    q, n = rows.shape
    return rows.T @ jnp.pad(x, ((0, q - n), (0, 0))) if transpose else (rows @ x)[:n]


def _by_factors(factors: Factors, rhs: Float[Array, "n m"], transpose: bool) -> Float[Array, "n m"]:
    """Solutions in the precision of the factors."""
    triangles, order = factors

    def triangular(b, lower):
        return _substitution(triangles, b, lower=lower, transpose=not transpose)

    b = rhs.astype(triangles.dtype)
    if transpose:
        return triangular(triangular(b[order], True), False).astype(rhs.dtype)
    x = triangular(triangular(b, False), True)
    return jnp.zeros_like(x).at[order].set(x, unique_indices=True).astype(rhs.dtype)


def _substitution(
    triangles: Float[Array, "n n"], b: Float[Array, "n m"], *, lower: bool, transpose: bool
) -> Float[Array, "n m"]:
    """Solution of a triangular system by block rows: a product with what is known, then a small triangle.

    LAPACK's routine packs the whole triangle again for a few columns, which takes five times as long.
    """
    n = b.shape[0]
    ends = np.linspace(0, n, max(1, min(MOST_BLOCKS, n // LEAST_BLOCK)) + 1).astype(int)
    forward = lower != transpose
    x = b[:0]
    for start, stop in list(pairwise(ends))[:: 1 if forward else -1]:
        own, known = slice(start, stop), slice(0, start) if forward else slice(stop, n)
        left = triangles[known, own].T @ x if transpose else triangles[own, known] @ x
        how = {"left_side": True, "lower": lower, "transpose_a": transpose, "unit_diagonal": lower}
        part = lax.linalg.triangular_solve(triangles[own, own], b[own] - left, **how)
        x = jnp.concatenate([x, part] if forward else [part, x])
    return x
