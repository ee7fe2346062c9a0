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
