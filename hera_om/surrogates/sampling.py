"""Sampling plans: where in the box of the inputs a discipline is run before a surrogate is trained."""

import math

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike
from scipy.stats import qmc

from hera_om.core.errors import InputError, Problem
from hera_om.surrogates.domain import bounds_problems


def latin_hypercube(n: int, lower: ArrayLike, upper: ArrayLike, seed: int) -> Float[np.ndarray, "n d"]:
    """Latin hypercube of low discrepancy: every input has exactly one sample in each of n equal strata.

    Random permutations of coordinates lower the centred discrepancy (``random-cd`` of
    ``scipy.stats.qmc.LatinHypercube``), which spreads the points over pairs and triples of inputs as well
    (Damblin, Couplet and Iooss, Journal of Simulation 7, 2013). The paper samples by Latin hypercube.

    Args:
        n: number of samples, at least 1.
        lower: lower bounds [d], in the units of the inputs.
        upper: upper bounds [d], above the lower ones.
        seed: non-negative integer; the same seed gives the same plan.

    Returns:
        Samples inside the bounds, one a row.

    Raises:
        InputError: n, seed or the bounds make no sense.
    """
    low, high = _checked(n, lower, upper, seed)
    unit = qmc.LatinHypercube(low.size, optimization="random-cd", rng=seed).random(n)
    return low + unit * (high - low)


def sobol(n: int, lower: ArrayLike, upper: ArrayLike, seed: int) -> Float[np.ndarray, "n d"]:
    """Scrambled Sobol' sequence: a longer plan of the same seed begins with the shorter one.

    That makes it the plan to choose where samples are added until a surrogate is good enough. Balance is best
    where n is a power of two (Owen, J. Complexity 14, 1998).

    Args:
        n: number of samples, at least 1.
        lower: lower bounds [d], in the units of the inputs.
        upper: upper bounds [d], above the lower ones.
        seed: non-negative integer; the same seed gives the same plan.

    Returns:
        Samples inside the bounds, one a row.

    Raises:
        InputError: n, seed or the bounds make no sense.
    """
    low, high = _checked(n, lower, upper, seed)
    # A whole power of two is drawn, since SciPy warns of any other length even where only a prefix is wanted.
    unit = qmc.Sobol(low.size, rng=seed).random_base2(math.ceil(math.log2(n)))[:n]
    return low + unit * (high - low)


PLANS = {"lhs": latin_hypercube, "sobol": sobol}
"""Sampling plans by the name that a user gives."""


def _checked(
    n: int, lower: ArrayLike, upper: ArrayLike, seed: int
) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " d"]]:
    """Bounds as arrays, once every argument makes sense."""
    low, high = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    problems = bounds_problems("sampling plan", low, high)
    for key, value, least in (("n", n, 1), ("seed", seed, 0)):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            problems.append(Problem("sampling plan", key, value, f"a whole number of at least {least}"))
    if problems:
        raise InputError(problems)
    return low, high
