"""Sampling plans: strata, space filling, determinism, refusals."""

import numpy as np
import pytest
from scipy.stats import qmc

from hera_om.core.errors import InputError
from hera_om.surrogates.sampling import PLANS, latin_hypercube, sobol

LOWER, UPPER = np.array([-4.0, 0.0, 1e3]), np.array([10.0, 1e-3, 8e3])


@pytest.mark.parametrize(("n", "seed"), [(1, 0), (2, 5), (13, 2**31)])
def test_latin_hypercube_has_one_sample_in_each_stratum(n, seed):
    unit = (latin_hypercube(n, LOWER, UPPER, seed) - LOWER) / (UPPER - LOWER)
    for column in unit.T:
        assert sorted(np.floor(column * n).astype(int)) == list(range(n))


def test_latin_hypercube_fills_space_better_than_a_random_one():
    lower, upper = np.zeros(3), np.ones(3)
    plain = np.mean([qmc.discrepancy(qmc.LatinHypercube(3, rng=s).random(40)) for s in range(20)])
    assert qmc.discrepancy(latin_hypercube(40, lower, upper, 0)) < 0.8 * plain


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_plan_is_determined_by_its_seed_and_lies_in_the_box(plan):
    first = plan(33, LOWER, UPPER, 5)
    assert first.shape == (33, 3)
    assert np.array_equal(first, plan(33, LOWER, UPPER, 5))
    assert not np.array_equal(first, plan(33, LOWER, UPPER, 6))
    assert np.all((first >= LOWER) & (first <= UPPER))


def test_longer_sobol_plan_begins_with_the_shorter_one():
    assert np.array_equal(sobol(100, LOWER, UPPER, 5)[:33], sobol(33, LOWER, UPPER, 5))


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
@pytest.mark.parametrize(
    ("n", "lower", "upper", "seed", "key"),
    [
        (0, [0.0], [1.0], 1, "n"),
        (2.5, [0.0], [1.0], 1, "n"),
        (True, [0.0], [1.0], 1, "n"),
        (4, [0.0], [1.0], -1, "seed"),
        (4, [0.0], [1.0], None, "seed"),
        (4, [0.0, 1.0], [1.0, 1.0], 1, "bounds of 1"),
        (4, [0.0], [np.inf], 1, "bounds of 0"),
        (4, [np.nan], [1.0], 1, "bounds of 0"),
        (4, [0.0], [1.0, 2.0], 1, "lower, upper"),
        (4, [], [], 1, "lower, upper"),
        (4, 0.0, 1.0, 1, "lower, upper"),
    ],
)
def test_senseless_arguments_are_named(plan, n, lower, upper, seed, key):
    with pytest.raises(InputError) as caught:
        plan(n, lower, upper, seed)
    assert [problem.key for problem in caught.value.problems] == [key]


def test_every_fault_is_reported_at_once():
    with pytest.raises(InputError) as caught:
        latin_hypercube(-1, [1.0], [0.0], -1)
    assert [problem.key for problem in caught.value.problems] == ["bounds of 0", "n", "seed"]
