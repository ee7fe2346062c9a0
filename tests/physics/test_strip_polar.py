"""Strip polars: the spline against SciPy, exact polars read back, the parabola as before, the guard."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from hera_om.physics import strip_polar
from hera_om.physics.profile_drag import section_profile_drag
from hera_om.physics.strip_polar import (
    StripPolar,
    StripTable,
    make_table,
    spline_cells,
    stall_guard,
    strip_state,
    strip_states,
)

ALPHA = np.deg2rad(np.array([-12.0, -9, -6, -4, -2, 0, 1, 2, 4, 6, 8, 10, 12, 14, 16, 18]))
REYNOLDS = np.array([1e6, 3e6, 6e6, 1.5e7])
MACH = np.array([0.0, 0.3, 0.5])
ZERO_LIFT = np.deg2rad(-2.0)
PARABOLA = StripPolar(0.0068, 0.30, 0.0060, 1.0e7, 1.6)


def section(alpha, log_re, mach):
    """A made-up smooth section that stalls at 14 degrees and a little more by Reynolds number."""
    stall = np.deg2rad(14.0) + 0.02 * (log_re - np.log(6e6))
    beta = np.sqrt(1 - mach**2)
    arc = (alpha - ZERO_LIFT) / (stall - ZERO_LIFT)
    cl = 2 * np.pi / beta * (stall - ZERO_LIFT) * np.sin(np.pi / 2 * arc) * 0.63
    cd = 0.006 * (1.0 - 0.1 * (log_re - np.log(6e6))) + 0.05 * (alpha - 0.03) ** 2 + 3.0 * alpha**4 + 0.002 * mach**2
    return cl, cd, -0.05 - 0.02 * alpha + 0.0 * cd


@pytest.fixture(scope="module")
def table():
    cl, cd, cm = section(ALPHA[:, None, None], np.log(REYNOLDS)[:, None], MACH)
    return make_table(ALPHA, REYNOLDS, MACH, cl=cl, cd=cd, cm=cm)


def incidence_to_cl(alpha, mach):
    return (alpha - ZERO_LIFT) * 2 * np.pi / np.sqrt(1 - mach**2)


@pytest.mark.parametrize("x", [[0.0, 1.0, 3.0, 3.5, 6.0], [0.0, 2.0], [0.0, 1.0, 3.0]])
def test_spline_is_scipys_natural_spline_with_straight_ends(x):
    values = np.array([1.0, -2.0, 0.5, 3.0, 1.0])[: len(x)]
    cells = spline_cells(x) @ values
    spline = CubicSpline(x, values, bc_type="natural")
    for t in (*np.linspace(x[0], x[-1], 41)[:-1], x[-1]):
        i = np.searchsorted(x, t, side="right")
        np.testing.assert_allclose(np.polyval(cells[i][::-1], t - x[i - 1]), spline(t), atol=1e-12)
    np.testing.assert_allclose(cells[0], [values[0], spline(x[0], 1), 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(cells[-1], [values[-1], spline(x[-1], 1), 0.0, 0.0], atol=1e-12)


def test_table_is_the_tensor_product_of_splines(table):
    rng = np.random.default_rng(3)
    alpha, reynolds, mach = rng.uniform(-0.15, 0.28, 20), np.exp(rng.uniform(14.0, 16.4, 20)), 0.2
    _, cd, cm = section(ALPHA[:, None, None], np.log(REYNOLDS)[:, None], MACH)
    state = strip_state(table, jnp.asarray(incidence_to_cl(alpha, mach)), jnp.asarray(reynolds), mach=mach)
    np.testing.assert_allclose(state.alpha, alpha, atol=2e-5)  # zero lift is found on a straight line
    for got, values in ((state.cd, cd), (state.cm, cm)):
        by_mach = CubicSpline(MACH, values, axis=2, bc_type="natural")(mach)
        by_re = CubicSpline(np.log(REYNOLDS), by_mach, axis=1, bc_type="natural")(np.log(reynolds))
        expected = [
            CubicSpline(ALPHA, by_re[:, i], bc_type="natural")(a) for i, a in enumerate(np.asarray(state.alpha))
        ]
        np.testing.assert_allclose(got, expected, rtol=1e-12)


def test_values_between_the_points_are_those_of_the_section(table):
    # halfway between the points; the interpolation is judged, so on the table's own incidence
    alpha, reynolds = (ALPHA[3:-4] + ALPHA[4:-3]) / 2, np.full(9, 4e6)
    state = strip_state(table, jnp.asarray(incidence_to_cl(alpha, 0.4)), jnp.asarray(reynolds), mach=0.4)
    cl, cd, cm = section(alpha, np.log(reynolds), 0.4)
    np.testing.assert_allclose(state.cd, cd, rtol=0.01)
    np.testing.assert_allclose(state.cm, cm, rtol=1e-3)
    np.testing.assert_allclose(state.cl, cl, rtol=0.01, atol=0.003)


def test_interpolation_converges_at_fourth_order_inside():
    def error(n):
        alpha = np.linspace(-0.2, 0.3, n)
        _, cd, _ = section(alpha[:, None, None], np.log(6e6), 0.0)
        cl = np.broadcast_to(6.0 * (alpha - ZERO_LIFT)[:, None, None], cd.shape)
        t = make_table(alpha, [6e6], [0.0], cl=cl, cd=cd)
        at = np.linspace(-0.05, 0.15, 101)
        got = strip_state(t, jnp.asarray(2 * np.pi * (at - ZERO_LIFT)), jnp.full(101, 6e6), mach=0.0)
        return np.max(np.abs(got.cd - section(at, np.log(6e6), 0.0)[1]))

    assert np.log2(error(21) / error(41)) > 3.7


def test_prandtl_glauert_stands_in_the_effective_incidence(table):
    still = strip_state(table, jnp.asarray([0.5]), jnp.asarray([5e6]), mach=0.0)
    fast = strip_state(table, jnp.asarray([0.5]), jnp.asarray([5e6]), mach=0.5)
    np.testing.assert_allclose((fast.alpha - ZERO_LIFT) / (still.alpha - ZERO_LIFT), np.sqrt(0.75), rtol=1e-4)
    np.testing.assert_allclose(still.alpha - ZERO_LIFT, 0.5 / (2 * np.pi), rtol=1e-3)


def test_continuation_is_linear_twice_differentiable_and_reported(table):
    def drag(alpha):
        cl = (alpha - ZERO_LIFT) * 2 * jnp.pi
        return strip_state(table, cl[None], jnp.asarray([6e6]), mach=0.0).cd[0]

    last = float(ALPHA[-1])
    far = jnp.stack([drag(jnp.asarray(last + d)) for d in (0.1, 0.2, 0.3)])
    np.testing.assert_allclose(far[2] - far[1], far[1] - far[0], rtol=1e-9)
    bend = jax.jit(jax.grad(jax.grad(drag)))
    # just before and behind the last point: the curvature passes through zero
    assert abs(bend(last + 1e-3)) < 1e-9 and abs(bend(last - 1e-5)) < 1e-3 * abs(bend(last - 0.05))
    state = strip_state(table, jnp.asarray([0.4, 3.0]), jnp.asarray([6e6, 6e6]), mach=0.0)
    assert state.outside[0] == 0.0
    np.testing.assert_allclose(state.outside[1], (state.alpha[1] - last) / (last - ALPHA[0]), rtol=1e-12)
    state = strip_state(table, jnp.asarray([0.4]), jnp.asarray([6e7]), mach=0.0)
    np.testing.assert_allclose(state.outside, np.log(4.0) / np.log(15.0), rtol=1e-12)


def test_margin_to_the_largest_and_the_least_lift(table):
    cl, reynolds = jnp.asarray([0.5, -0.9, 1.5]), jnp.full(3, 6e6)
    state = strip_state(table, cl, reynolds, mach=0.0)
    top = section(np.deg2rad(14.0), np.log(6e6), 0.0)[0]
    bottom = section(ALPHA[0], np.log(6e6), 0.0)[0]  # no stall there: the table ends
    np.testing.assert_allclose(state.margin, [top - 0.5, -0.9 - bottom, top - 1.5], atol=2e-3)
    assert state.margin[2] < 0.0
    # at a lower Reynolds number the section stalls earlier
    assert strip_state(table, cl, jnp.full(3, 1.5e6), mach=0.0).margin[0] < state.margin[0]


def test_parabola_is_as_before_to_the_last_digit():
    cl, reynolds = jnp.asarray([0.3, -0.5, 1.7]), jnp.asarray([1e7, 5e6, 2e7])
    state = strip_state(PARABOLA, cl, reynolds, mach=0.5)
    old = section_profile_drag(cl, reynolds, cd_min=0.0068, cl_at_cd_min=0.30, k=0.0060, re_ref=1.0e7)
    np.testing.assert_array_equal(state.cd, old)
    np.testing.assert_allclose(state.margin, [1.3, 1.1, -0.1], rtol=1e-12)
    np.testing.assert_array_equal(state.outside, 0.0)


def test_table_of_the_parabola_gives_the_parabola():
    # the same section by two ways: cl of a thin section, cd of the parabola
    alpha = np.linspace(-0.2, 0.25, 46)
    cl = np.broadcast_to((2 * np.pi * alpha)[:, None, None], (46, 5, 1))
    reynolds = np.geomspace(2e6, 3e7, 5)
    polar = dict(cd_min=0.0068, cl_at_cd_min=0.3, k=0.006, re_ref=1e7)
    cd = np.asarray(section_profile_drag(jnp.asarray(cl[..., 0]), jnp.asarray(reynolds), **polar))[..., None]
    table = make_table(alpha, reynolds, [0.0], cl=cl, cd=cd)
    at, re = jnp.linspace(-0.6, 1.2, 10), jnp.full(10, 8e6)
    state = strip_state(table, at, re, mach=0.0)
    np.testing.assert_allclose(state.cd, strip_state(PARABOLA, at, re, mach=0.0).cd, rtol=2e-4)


def test_surfaces_side_by_side_and_the_guard(table):
    cl = jnp.asarray([0.3, 0.6, 0.9, 0.2, -0.1])
    reynolds, y = jnp.full(5, 6e6), jnp.asarray([1.0, 5.0, 9.0, 1.0, 2.0])
    state = strip_states([table, PARABOLA._replace(cl_max=0.15)], (3, 2), cl, reynolds=reynolds, mach=0.0)
    np.testing.assert_array_equal(state.cd[:3], strip_state(table, cl[:3], reynolds[:3], mach=0.0).cd)
    guard = stall_guard(state.margin, (3, 2), y)
    worst = int(np.argmin(np.asarray(state.margin)))
    assert (int(guard.index), int(guard.surface), int(guard.strip), float(guard.y)) == (worst, 1, 0, 1.0)
    np.testing.assert_allclose(guard.least, -0.05, rtol=1e-12)
    assert guard.least - np.log(5) / strip_polar.GUARD_SHARPNESS <= guard.smooth <= guard.least
    even = stall_guard(jnp.full(5, 0.2), (3, 2), y)
    np.testing.assert_allclose(even.least - even.smooth, np.log(5) / strip_polar.GUARD_SHARPNESS, rtol=1e-12)


def test_derivatives(table, check_derivatives):
    def outputs(x):
        cl = jnp.stack([0.4 * x[0], 0.9, -0.2 * x[0]])
        state = strip_state(table, cl, 5e6 * jnp.stack([x[1], 1.0, 3.5 * x[1]]), mach=0.4 * x[2])
        return jnp.concatenate([10 * state.cd, state.cm, state.cl, stall_guard(state.margin, (3,), cl).smooth[None]])

    check_derivatives(outputs, np.ones(3), relative_step=1e-3)


def test_a_table_can_be_an_argument_of_a_compiled_function(table):
    cl, reynolds = jnp.asarray([0.3, 0.6]), jnp.full(2, 5e6)
    compiled = jax.jit(lambda t: strip_state(t, cl, reynolds, mach=0.1))
    traced = compiled(StripTable(*map(jnp.asarray, table)))
    direct = strip_state(table, cl, reynolds, mach=0.1)
    for got, expected in itertools.zip_longest(traced, direct):
        np.testing.assert_allclose(got, expected, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"alpha": ALPHA[::-1]}, "alpha must be"),
        ({"reynolds": [1e6, 1e6, 2e6, 3e6]}, "Reynolds number must be"),
        ({"mach": [0.0, np.nan, 0.5]}, "mach must be"),
        ({"cl": np.zeros((2, 4, 3))}, "cl must be finite and of shape"),
        ({"cl": np.ones((16, 4, 3))}, "rise through zero"),
    ],
)
def test_what_makes_no_table(change, text):
    cl, cd, _ = section(ALPHA[:, None, None], np.log(REYNOLDS)[:, None], MACH)
    given = {"alpha": ALPHA, "reynolds": REYNOLDS, "mach": MACH, "cl": cl, "cd": cd} | change
    with pytest.raises(ValueError, match=text):
        make_table(given.pop("alpha"), given.pop("reynolds"), given.pop("mach"), **given)
