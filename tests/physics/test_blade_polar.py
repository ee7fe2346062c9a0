"""Tabulated blade polars: values, full incidence, stall delay, derivatives, refusals."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import blade_polar as bp
from hera_om.physics import polar_extension as pe
from hera_om.physics import stall_delay as sd
from hera_om.physics.section_polar import SectionPolar, section_coefficients

REFERENCE = Path(__file__).parents[1] / "reference"
SECTION = SectionPolar(5.9, np.radians(-2.0), 0.010, 0.35, 0.008, 1.4, 1.0)
ALPHA = np.radians(np.linspace(-180.0, 180.0, 181))
REYNOLDS, MACH = np.array([2e5, 1e6, 5e6]), np.array([0.0, 0.2, 0.4, 0.6])


def drag_factor(reynolds):
    return (reynolds / 1e6) ** -0.2


def analytic(alpha, reynolds, mach):
    """Lift and drag of the seven numbers, with a drag that falls with the Reynolds number."""
    cl, cd = section_coefficients(SECTION, jnp.asarray(alpha), jnp.asarray(mach))
    return cl, cd * drag_factor(reynolds)


def sampled():
    grid = np.meshgrid(ALPHA, REYNOLDS, MACH, indexing="ij")
    cl, cd = (np.array(v) for v in analytic(*grid))
    cl[[0, -1]], cd[[0, -1]] = cl[:1], cd[:1]
    return bp.make_blade_table(ALPHA, REYNOLDS, MACH, cl=cl, cd=cd)


TABLE = sampled()


@jax.jit
def look_up(alpha, reynolds, mach):
    """Coefficients of a list of points, as one row of elements."""
    polar = bp.at_elements(TABLE, jnp.ones(1))
    flow = bp.polar_in_flow(polar, mach[None], reynolds[None])
    return jnp.stack(bp.flow_coefficients(flow, alpha[None]))[:, 0]


def test_table_returns_what_it_was_made_of():
    alpha, reynolds, mach = (v.ravel() for v in np.meshgrid(ALPHA[:-1:5], REYNOLDS, MACH, indexing="ij"))
    cl, cd = analytic(alpha, reynolds, mach)
    np.testing.assert_allclose(look_up(alpha, reynolds, mach), [cl, cd], atol=1e-9)


def test_table_between_its_points():
    """Smooth functions to the order of the spline: 2 degrees, and a third of the Reynolds number's decades."""
    generator = np.random.default_rng(1)
    alpha = np.radians(generator.uniform(-8.0, 8.0, 40))
    reynolds, mach = np.exp(generator.uniform(np.log(2e5), np.log(5e6), 40)), generator.uniform(0.0, 0.6, 40)
    cl, cd = analytic(alpha, reynolds, mach)
    found = look_up(alpha, reynolds, mach)
    np.testing.assert_allclose(found[0], cl, atol=0.02)
    np.testing.assert_allclose(found[1], cd, atol=6e-4)


def test_table_is_periodic_and_levels_off():
    alpha = jnp.radians(jnp.array([-170.0, -3.0, 4.0, 120.0]))
    reynolds, mach = jnp.full(4, 1e6), jnp.full(4, 0.3)
    here = look_up(alpha, reynolds, mach)
    for turn in (-2.0 * np.pi, 2.0 * np.pi):
        np.testing.assert_allclose(look_up(alpha + turn, reynolds, mach), here, atol=1e-12)
    np.testing.assert_allclose(look_up(alpha, jnp.full(4, 1e-3), mach), look_up(alpha, jnp.full(4, 1e2), mach))
    np.testing.assert_allclose(look_up(alpha, reynolds, jnp.full(4, 3.0)), look_up(alpha, reynolds, jnp.full(4, 2.0)))


def test_table_derivatives(check_derivatives):
    """Across knots, the ends of the circle and of the axes."""

    def both(x):
        return look_up(x[:4], 1e6 * x[4:8], x[8:]).ravel()

    alpha = np.radians([-179.99, 2.01, 13.3, 95.0])
    check_derivatives(both, np.concatenate([alpha, [0.21, 1.0, 4.9, 7.0], [0.01, 0.2, 0.45, 0.62]]), relative_step=1e-4)


def test_sections_blend_along_the_blade():
    cl = np.stack([np.sin(ALPHA), 3.0 * np.sin(ALPHA)])[..., None, None]
    table = bp.make_blade_table(ALPHA, [1.0], [0.0], cl=cl, cd=np.full_like(cl, 0.01), r=(0.2, 1.0))
    x = jnp.array([0.1, 0.4, 1.0])
    flow = bp.polar_in_flow(bp.at_elements(table, x), jnp.zeros((3, 1)), None)
    found, _ = bp.flow_coefficients(flow, jnp.full((3, 1), 0.3))
    np.testing.assert_allclose(found[:, 0], np.sin(0.3) * np.array([1.0, 1.5, 3.0]), rtol=1e-5)
    slope, zero = bp.lift_line(flow)
    np.testing.assert_allclose(slope[:, 0], [1.0, 1.5, 3.0], rtol=2e-3)
    np.testing.assert_allclose(zero, 0.0, atol=1e-9)


def test_viterna_of_a_table_by_hand():
    """Equations 1-5 of the report at 45 and 90 degrees for a stall at 16 degrees, aspect ratio 10."""
    alpha = np.radians([-12.0, -6.0, 0.0, 8.0, 16.0])
    cl, cd = np.array([-0.9, -0.5, 0.2, 1.0, 1.3]), np.array([0.05, 0.012, 0.008, 0.015, 0.06])
    whole, lift, drag = pe.full_incidence(alpha, cl, cd, aspect_ratio=10.0)
    at = int(np.argmin(np.abs(whole - np.radians(45.0))))
    np.testing.assert_allclose(whole[at], np.radians(45.0))
    # cd_max 1.29; A = (1.3 - 1.29 x 0.264960) x 0.275637 / 0.924025; B = (0.06 - 1.29 x 0.075976) / 0.961262
    np.testing.assert_allclose(lift[at], 0.645 + 0.285830 * 0.707107, rtol=1e-5)
    np.testing.assert_allclose(drag[at], 0.645 - 0.039541 * 0.707107, rtol=1e-4)
    np.testing.assert_allclose(np.interp(0.5 * np.pi, whole, drag), 1.29, rtol=1e-9)
    np.testing.assert_allclose(np.interp(0.5 * np.pi, whole, lift), 0.0, atol=1e-12)
    np.testing.assert_allclose([whole[0], whole[-1]], [-np.pi, np.pi])
    np.testing.assert_allclose([lift[0], lift[-1], drag[0] - drag[-1]], 0.0, atol=1e-12)
    assert np.min(drag) == 0.008
    kept = np.isin(whole, alpha)
    np.testing.assert_allclose(lift[kept], cl)


def test_mach_numbers_by_prandtl_and_glauert():
    alpha = np.radians(np.arange(-14.0, 15.0))
    alpha, cl, _ = pe.with_mach_numbers(alpha, 6.0 * (alpha + 0.05)[:, None], np.full((29, 1), 0.01), [0.0, 0.6])
    np.testing.assert_allclose(cl[:, 0, 1], 6.0 / 0.8 * (alpha + 0.05), rtol=1e-9)
    np.testing.assert_allclose(cl[:, 0, 0], 6.0 * (alpha + 0.05), rtol=1e-9)
    assert np.max(alpha) <= -0.05 + (np.radians(14.0) + 0.05) * 0.8


def test_stall_delay_by_hand():
    """Du and Selig's factor at c/r = 0.5, r/R = 0.3, Lambda = 0.9: q = 0.5^3.7037, f = 0.7020 of the missing lift."""
    q = 0.5 ** (1.0 / 0.27)
    factor = (1.6 * 0.5 / 0.1267 * (1.0 - q) / (1.0 + q) - 1.0) / (2.0 * np.pi)
    np.testing.assert_allclose(sd.delay_factor(0.5, 0.3, 0.9), factor, rtol=1e-12)
    case = dict(lift_line=(6.0, -0.05), chord_ratio=0.5, radius_ratio=0.3, speed_ratio=0.9)
    alpha = 0.35
    cl, cd = sd.delayed(1.0, 0.2, alpha=alpha, **case)
    gain = factor * (6.0 * (alpha + 0.05) - 1.0)
    np.testing.assert_allclose(cl, 1.0 + gain, rtol=1e-12)
    np.testing.assert_allclose(
        cd, 0.2 + gain * (np.sin(0.35) - 0.12 * np.cos(0.35)) / (np.cos(0.35) + 0.12 * np.sin(0.35))
    )
    attached = sd.delayed(0.6, 0.01, alpha=0.05, **case)
    np.testing.assert_allclose(attached, [0.6, 0.01], rtol=1e-12)
    square = sd.delayed(0.0, 1.9, alpha=0.5 * np.pi, **case)
    np.testing.assert_allclose(square, [0.0, 1.9])
    np.testing.assert_allclose(sd.delay_factor(0.5, 0.3, 0.0), 0.702, atol=0.2)
    assert sd.delay_factor(0.05, 0.9, 0.9) == 0.0


SHORT = np.radians(np.linspace(-10.0, 15.0, 6))


@pytest.mark.parametrize(
    ("how", "words"),
    [
        (dict(aspect_ratio=10.0, extend=False), "-10 to 15 deg, a blade needs -180 to 180 deg, and it is not to be"),
        (dict(), "the aspect ratio of the blade is needed"),
        (dict(alpha=np.abs(SHORT) + 0.1 * SHORT, aspect_ratio=10.0), "ends between 1 and 90 deg"),
    ],
)
def test_extension_refuses(how, words):
    alpha = how.pop("alpha", SHORT)
    with pytest.raises(ValueError, match=words):
        pe.full_incidence(alpha, np.linspace(-1.0, 1.3, 6), np.full(6, 0.01), **how)


def test_table_refuses():
    values = np.sin(ALPHA)[:, None, None]
    make = bp.make_blade_table
    with pytest.raises(ValueError, match="-10 to 15 deg does not cover"):
        make(SHORT, [1.0], [0.0], cl=np.ones((6, 1, 1)), cd=np.ones((6, 1, 1)))
    with pytest.raises(ValueError, match="cd of a blade polar must be positive"):
        make(ALPHA, [1.0], [0.0], cl=values, cd=0.0 * values)
    with pytest.raises(ValueError, match="mach of a blade polar must be finite and increasing"):
        make(ALPHA, [1.0], [0.1, 0.0], cl=np.repeat(values, 2, 2), cd=np.ones((181, 1, 2)))
    with pytest.raises(ValueError, match="cl of a blade polar must be finite and of shape"):
        make(ALPHA, [1.0], [0.0], cl=values[1:], cd=np.ones_like(values))
    with pytest.raises(ValueError, match="the same at -180 and at 180 deg"):
        make(ALPHA, [1.0], [0.0], cl=ALPHA[:, None, None], cd=np.ones_like(values))
    with pytest.raises(ValueError, match="must rise through zero"):
        make(ALPHA, [1.0], [0.0], cl=2.0 + values * 0.0, cd=np.ones_like(values))
    with pytest.raises(ValueError, match="needs the viscosity"):
        bp.polar_in_flow(bp.at_elements(TABLE, jnp.ones(1)), jnp.zeros((1, 3)), None)
