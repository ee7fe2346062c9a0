"""A trained set: values, derivatives, one compilation for all, and who lies outside the box."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om import surrogates
from hera_om.surrogates import surrogate_set

X = np.array([1.7, -6.0])


def test_values_are_those_of_the_discipline(small):
    alpha, delta = np.deg2rad(X)
    cl = 0.2 + 5.5 * alpha + 0.4 * delta
    y = np.asarray(small.evaluate(X))
    assert y.shape == (11,)
    assert y[small.slices["CD"]] == pytest.approx(0.02 + cl**2 / 30, rel=1e-3)
    assert y[small.slices["Cm"]] == pytest.approx(0.05 - 1.1 * alpha - 1.5 * delta + alpha**2, abs=1e-4)
    assert y[small.slices["CY"]] == 0.0
    assert y[small.slices["CT"]] == pytest.approx(0.1 * np.sin(0.8 * X[0]) + 1e-4 * X[1], abs=1e-4)
    station = np.linspace(0, 1, 7)
    load = cl * np.sqrt(1 - station**2) + np.sin(3 * alpha) * station * (1 - station)
    assert y[small.slices["cl_span"]] == pytest.approx(load, abs=1e-3)


def test_jacobian_is_that_of_central_differences(small):
    """Richardson's extrapolation, relative to the largest entry of each output."""
    exact = np.asarray(small.jacobian(X))
    width, columns = small.upper - small.lower, []
    for k in range(2):
        step = np.zeros(2)
        step[k] = 2e-3 * width[k]
        near, far = (
            (np.asarray(small.evaluate(X + f * step)) - np.asarray(small.evaluate(X - f * step))) / (2 * f * step[k])
            for f in (1, 2)
        )
        columns.append((4 * near - far) / 3)
    differences = np.column_stack(columns)
    assert exact.shape == (11, 2)
    for where in small.slices.values():
        largest = np.max(np.abs(exact[where]))
        assert np.max(np.abs(exact - differences)[where]) <= 1e-7 * max(largest, 1e-3)


def test_derivatives_are_those_of_the_discipline(small):
    alpha, _ = np.deg2rad(X)
    expected = np.deg2rad([-1.1 + 2 * alpha, -1.5])
    assert np.asarray(small.jacobian(X))[1] == pytest.approx(expected, rel=1e-3)


def test_second_derivatives_exist_in_both_modes(small):
    drag = lambda x: surrogates.predict(small.predictor, x)[0]  # noqa: E731
    forward = np.asarray(jax.jit(jax.jacfwd(jax.jacfwd(drag)))(X))
    assert np.asarray(jax.jit(jax.jacfwd(jax.jacrev(drag)))(X)) == pytest.approx(forward, rel=1e-6, abs=1e-9)
    curvature = 2 * np.deg2rad(1) ** 2 / 30 * np.outer([5.5, 0.4], [5.5, 0.4])
    assert forward == pytest.approx(curvature, abs=0.05 * curvature[0, 0])


def test_many_points_agree_with_one_at_a_time(small):
    points = surrogates.latin_hypercube(surrogate_set.BATCH + 3, small.lower, small.upper, 9)
    many = np.asarray(small.evaluate_many(points))
    assert many == pytest.approx(np.array([small.evaluate(point) for point in points]), abs=1e-9)


def test_first_call_may_happen_inside_a_trace(case):
    fresh = surrogates.train(**case())
    inside = jax.jit(lambda x: jnp.sum(fresh.evaluate(x)))
    slope = jax.grad(inside)(jnp.asarray(X))
    assert np.asarray(slope) == pytest.approx(np.sum(np.asarray(fresh.jacobian(X)), axis=0))


def test_two_sets_of_one_shape_share_a_compilation(small, case, monkeypatch):
    traces = []
    predict = surrogate_set.predict

    def counted(predictor, x):
        traces.append(1)
        return predict(predictor, x)

    monkeypatch.setattr(surrogate_set, "_evaluate", jax.jit(counted))
    other = surrogates.train(**case(definition_hash="other"))
    for x in (X, list(X), X.astype(np.float32), jnp.asarray(X)):
        small.evaluate(x)
        other.evaluate(x)
    assert len(traces) == 1


def test_outside_names_each_input_with_its_bounds(small):
    assert surrogates.outside(small, X) == []
    assert surrogates.outside(small, small.upper) == [] == surrogates.outside(small, small.lower)
    assert surrogates.outside(small, [10.5, -21.0]) == [
        ("alpha", 10.5, -4.0, 10.0),
        ("delta_e", -21.0, -20.0, 20.0),
    ]
    (found,) = surrogates.outside(small, [np.nan, 0.0])
    assert found.name == "alpha"


def test_nothing_is_clipped_outside(small):
    edge, beyond = small.evaluate([10.0, 0.0]), small.evaluate([12.0, 0.0])
    assert abs(float(beyond[1] - edge[1])) > 1e-2


def test_arrays_are_of_double_precision(small):
    assert small.evaluate(X).dtype == jnp.float64
