"""Camber lines: printed ordinates, thin-airfoil theory, the slope, refused names."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics.airfoil import camber_line


def thin_airfoil(name):
    """Zero-lift angle (deg) and quarter-chord moment by Glauert's integrals over the slope."""
    theta = (np.arange(20000) + 0.5) * np.pi / 20000
    slope = camber_line(name, (1 - np.cos(theta)) / 2)[1]
    mean = [np.mean(slope * np.cos(k * theta)) for k in (0, 1, 2)]
    return np.degrees(mean[0] - mean[1]), np.pi / 2 * (mean[2] - mean[1])


def test_four_digits_by_their_meaning():
    """NACA 2412: 2 % camber at 40 % chord; zero-lift angle -2.077 deg and Cm -0.053 of thin-airfoil theory.

    The integrals are worked out in Bertin & Cummings, Aerodynamics for Engineers, example 6.2.
    """
    z, slope = camber_line("NACA 2412", [0.0, 0.4, 1.0])
    np.testing.assert_allclose(z, [0.0, 0.02, 0.0], atol=1e-15)
    np.testing.assert_allclose(slope, [0.1, 0.0, -2 * 0.02 / 0.6], atol=1e-15)
    zero_lift, moment = thin_airfoil("NACA 2412")
    assert zero_lift == pytest.approx(-2.077, abs=1e-3) and moment == pytest.approx(-0.0531, abs=1e-4)


def test_five_digits_against_a_worked_example():
    """NACA 23012: -1.09 deg and -0.0127, Anderson, Fundamentals of Aerodynamics, example 4.6."""
    zero_lift, moment = thin_airfoil("NACA 23012")
    assert zero_lift == pytest.approx(-1.09, abs=0.006) and moment == pytest.approx(-0.0127, abs=2e-4)
    # NACA Report 537: the 230 line has its largest ordinate, 1.84 % of the chord, at 15 %
    x = np.linspace(0.0, 1.0, 2001)
    z = camber_line("NACA 23012", x)[0]
    assert x[np.argmax(z)] == pytest.approx(0.15, abs=1e-3)
    assert np.max(z) == pytest.approx(0.0184, abs=1e-4)


def test_the_first_digit_of_five_scales_the_line():
    x = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(camber_line("43018", x), 2 * np.asarray(camber_line("NACA 23012", x)), rtol=1e-14)


@pytest.mark.parametrize("name", ["flat", "Flat", "NACA 0012"])
def test_symmetric_sections_have_no_camber(name):
    assert not np.any(camber_line(name, np.linspace(0.0, 1.0, 5)))


@given(
    st.sampled_from(["NACA 2412", "NACA 6309", "NACA 23012", "NACA 44018"]),
    st.floats(0.01, 0.99),
)
def test_the_slope_is_the_derivative_of_the_line(name, x):
    h = 1e-6
    z, slope = camber_line(name, np.array([x - h, x, x + h]))
    # across a joint of the pieces the third derivative (at most k1, 362) jumps
    assert slope[1] == pytest.approx((z[2] - z[0]) / (2 * h), abs=1e-6)


@pytest.mark.parametrize("name", ["NACA 23112", "NACA 2x12", "NACA 26012", "clark-y", "NACA 241", ""])
def test_other_names_are_refused(name):
    with pytest.raises(ValueError, match="unknown airfoil"):
        camber_line(name, 0.5)


# --- coordinates


def contour(name, thickness, points=61, digits=None, across=True):
    """Coordinates by Abbott & von Doenhoff, eqs. 6.1 and 6.2: thickness laid off across the mean line, or along z."""
    x = (1 - np.cos(np.linspace(0.0, np.pi, points))) / 2
    z, slope = camber_line(name, x)
    poly = 0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
    half, angle = thickness / 0.2 * poly, np.arctan(slope) if across else np.zeros_like(x)
    upper = x - half * np.sin(angle), z + half * np.cos(angle)
    lower = x + half * np.sin(angle), z - half * np.cos(angle)
    both = [np.concatenate([u[::-1], low[1:]]) for u, low in zip(upper, lower, strict=True)]
    return both if digits is None else [np.round(v, digits) for v in both]


AT = np.linspace(0.0, 1.0, 41)


@pytest.mark.parametrize("name", ["NACA 2412", "NACA 6309", "NACA 23012"])
@pytest.mark.parametrize("points", [41, 81])
def test_the_line_of_a_contour_with_thickness_along_z_is_the_formula(name, points):
    """The spline rounds off the kink of the curvature where the pieces of the formula meet, nothing else."""
    z, slope = camber_line(contour(name, 0.12, points, across=False), AT)
    z0, slope0 = camber_line(name, AT)
    np.testing.assert_allclose(z, z0, atol=1e-4)
    np.testing.assert_allclose(slope[1:], slope0[1:], atol=8e-3)
    inside = np.abs(AT - {"NACA 2412": 0.4, "NACA 6309": 0.3, "NACA 23012": 0.2025}[name]) > 0.1
    np.testing.assert_allclose(slope[inside][1:], slope0[inside][1:], atol=2e-3)


def test_the_line_of_naca_2412_by_its_published_construction():
    """Halfway along z is not quite the line that the thickness was laid off from: 0.045 deg of zero lift."""
    found = thin_airfoil(contour("NACA 2412", 0.12))
    assert found[0] == pytest.approx(-2.077, abs=0.05) and found[1] == pytest.approx(-0.0531, abs=5e-4)


def test_coordinates_that_are_rounded_to_four_digits():
    z, slope = camber_line(contour("NACA 2412", 0.12, 61, digits=4), AT)
    z0, slope0 = camber_line(contour("NACA 2412", 0.12, 61), AT)
    np.testing.assert_allclose(z, z0, atol=4e-4)
    np.testing.assert_allclose(slope[2:], slope0[2:], atol=0.015)


def test_a_mean_line_by_points_and_a_contour_read_backwards():
    x = (1 - np.cos(np.linspace(0.0, np.pi, 25))) / 2
    line = camber_line((x, camber_line("NACA 2412", x)[0]), AT)
    np.testing.assert_allclose(line[1], camber_line("NACA 2412", AT)[1], atol=2e-3)
    points = contour("NACA 4412", 0.12)
    for got, expected in zip(camber_line([v[::-1] for v in points], AT), camber_line(points, AT), strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-10)


def test_a_contour_of_other_size_and_place_has_the_same_line():
    x, z = contour("NACA 2412", 0.12)
    moved = camber_line((0.02 + 0.95 * x, 0.1 + 0.95 * z), AT)
    for got, expected in zip(moved, camber_line((x, z), AT), strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-10)


def test_a_turned_contour_keeps_its_incidence():
    """As in AVL: a file whose trailing edge lies below the nose has a mean line that falls."""
    x, z = contour("NACA 0012", 0.12)
    np.testing.assert_allclose(camber_line((x, z - 0.05 * x), AT)[1], -0.05, atol=1e-4)


@given(st.floats(-2.0, 2.0))
def test_the_line_is_linear_in_the_ordinates(factor):
    x, z = contour("NACA 4412", 0.12, 31, across=False)
    for got, once in zip(camber_line((x, factor * z), AT), camber_line((x, z), AT), strict=True):
        np.testing.assert_allclose(got, factor * once, atol=1e-10)
