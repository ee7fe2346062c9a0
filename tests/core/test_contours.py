"""Tables of contours against the NACA formulas and against coordinates that they were made into."""

import numpy as np
import pytest

from hera_om.core.contours import POINTS, contour_table
from hera_om.core.mean_lines import contour, naca_line

T = np.linspace(0.0, np.pi, POINTS)
X = (1 - np.cos(T)) / 2


def abbott(x):
    """Half thickness per unit thickness ratio, Abbott & von Doenhoff eq. 6.2."""
    return 5 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)


def test_names_give_the_formulas_and_their_rates():
    height, rate, half, half_rate = contour_table("NACA 43018")
    np.testing.assert_allclose(height, naca_line("NACA 43018", X)[0], atol=1e-15)
    np.testing.assert_allclose(half, abbott(X), atol=1e-15)
    step = 1e-6
    for value, found in ((abbott, half_rate), (lambda x: naca_line("NACA 43018", x)[0], rate)):
        central = (value((1 - np.cos(T + step)) / 2) - value((1 - np.cos(T - step)) / 2)) / (2 * step)
        np.testing.assert_allclose(found[1:-1], central[1:-1], atol=1e-8)


def test_coordinates_give_their_form_whatever_their_thickness():
    thin, thick = (contour_table(contour(lambda x: naca_line("NACA 4412", x)[0], r)) for r in (0.12, 0.24))
    np.testing.assert_allclose(thin[2], thick[2], atol=2e-5)
    np.testing.assert_allclose(thin[2], abbott(X), atol=3e-4)  # what the spline's smoothing costs
    np.testing.assert_allclose(thin[0], naca_line("NACA 4412", X)[0], atol=3e-4)


@pytest.mark.parametrize("airfoil", ["flat", ([0.0, 0.25, 0.5, 0.75, 1.0], [0.0, 0.02, 0.03, 0.02, 0.0])])
def test_lines_without_thickness_have_the_naca_form(airfoil):
    np.testing.assert_allclose(contour_table(airfoil)[2], abbott(X), atol=1e-15)
