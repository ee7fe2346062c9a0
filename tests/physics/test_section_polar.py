"""Section polar: linear law, full incidence, Mach number, derivatives."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics import section_polar as sp

REFERENCE = Path(__file__).parents[1] / "reference"
CLARK_Y = sp.SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 1.0)
coefficients = jax.jit(sp.section_coefficients)


def test_attached_range_of_the_reference_polar():
    """CCBlade's polar is 5.9 (alpha + 2 deg), 0.010 + 0.008 (cl - 0.35)^2 where attached; its stall starts
    at 7 deg."""
    table = np.loadtxt(REFERENCE / "atr_like" / "prop_polar.csv", delimiter=",", skiprows=1)
    table = table[np.abs(table[:, 0]) <= 5.0]
    polar = sp.SectionPolar(5.9, np.radians(-2.0), 0.010, 0.35, 0.008, 1.4, 0.0)
    cl, cd = coefficients(polar, jnp.radians(table[:, 0]), jnp.zeros(len(table)))
    np.testing.assert_allclose(cl, table[:, 1], atol=3e-4)  # the table rounds off at its stall, 1e-4 at 5 degrees
    np.testing.assert_allclose(cd, table[:, 2], atol=1e-4)


@pytest.mark.parametrize("mach", [0.0, 0.5, 0.67])
def test_prandtl_glauert_is_exact_below_its_limit(mach):
    alpha = jnp.radians(jnp.array([-6.0, -3.0, 0.0, 3.0]))
    cl, _ = coefficients(CLARK_Y, alpha, jnp.full(4, mach))
    np.testing.assert_allclose(cl, 6.0 * (alpha + np.radians(3.0)) / np.sqrt(1.0 - mach**2), rtol=1e-12, atol=1e-14)


def test_prandtl_glauert_stays_finite_and_rises_through_mach_one():
    factor = sp.prandtl_glauert(jnp.linspace(0.0, 1.5, 301))
    assert jnp.all(jnp.diff(factor) >= 0.0)
    np.testing.assert_allclose(factor[-1], 1.0 / np.sqrt(1.0 - sp.MACH_CAP**2))


def test_huge_cl_max_gives_a_linear_section_at_any_incidence():
    polar = sp.SectionPolar(6.2, 0.0, 0.007775, 0.15, 0.01, 1e9, 0.0)
    alpha = jnp.linspace(-1.5, 1.5, 31)
    cl, cd = coefficients(polar, alpha, jnp.zeros(31))
    np.testing.assert_allclose(cl, 6.2 * alpha, rtol=1e-14)
    np.testing.assert_allclose(cd, 0.008 - 0.003 * cl + 0.01 * cl**2, rtol=1e-12)


def test_flat_plate_normal_to_the_flow():
    for alpha in (0.5 * np.pi, -0.5 * np.pi):
        cl, cd = coefficients(CLARK_Y, jnp.asarray(alpha), jnp.asarray(0.1))
        np.testing.assert_allclose(cl, 0.0, atol=1e-12)
        np.testing.assert_allclose(cd, 1.98 + 0.008, rtol=1e-12)


def test_lift_saturates_at_cl_max():
    cl, _ = coefficients(CLARK_Y, jnp.radians(jnp.linspace(-180.0, 180.0, 721)), jnp.zeros(721))
    assert 1.3 < float(jnp.max(cl)) <= 1.4
    assert -1.4 <= float(jnp.min(cl)) < -1.3


@settings(deadline=None, max_examples=50)
@given(alpha=st.floats(-np.pi, np.pi), mach=st.floats(0.0, 1.2))
def test_symmetric_section_is_odd_and_drag_is_positive(alpha, mach):
    polar = sp.SectionPolar(6.0, 0.0, 0.008, 0.0, 0.010, 1.2, 1.0)
    cl, cd = coefficients(polar, jnp.array([alpha, -alpha]), jnp.array([mach, mach]))
    np.testing.assert_allclose(cl[0], -cl[1], atol=1e-12)
    np.testing.assert_allclose(cd[0], cd[1], atol=1e-12)
    assert float(cd[0]) > 0.0


def test_derivatives_at_every_incidence():
    """First and second derivatives by incidence against central differences, across all joints."""
    alpha = jnp.linspace(-3.1, 3.1, 249)
    mach = jnp.full(249, 0.75)

    def both(a):
        return jnp.stack(coefficients(CLARK_Y, a, mach))

    def slope(a):
        return jax.jvp(both, (a,), (jnp.ones_like(a),))[1]

    h = 1e-5
    for function, derivative in (
        (both, slope(alpha)),
        (slope, jax.jvp(slope, (alpha,), (jnp.ones_like(alpha),))[1]),
    ):
        coarse = (function(alpha + 2 * h) - function(alpha - 2 * h)) / (4 * h)
        fine = (function(alpha + h) - function(alpha - h)) / (2 * h)
        np.testing.assert_allclose(derivative, (4 * fine - coarse) / 3, atol=1e-6 * float(jnp.max(jnp.abs(derivative))))
