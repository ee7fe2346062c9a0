"""Contours of airfoils as tables in the angle of the chord fraction, from which physics interpolates."""

from typing import Any

import numpy as np

from hera_om.core.mean_lines import fitted_half, is_mean_line, mean_line, naca_half

POINTS = 65  # of a table: cubics through values and rates are then within 1e-7 of the chord from the NACA forms


def contour_table(airfoil: Any) -> np.ndarray:
    """Mean line and half thickness of an airfoil at equal steps of t, chord fraction (1 - cos t) / 2.

    The half thickness is laid along z, as `core.mean_lines` has it, and divided by its largest thickness: of a
    section whose thickness ratio is a number of its own, the contour gives the form. Names of the NACA families,
    ``"flat"`` and mean lines without thickness have the four-digit form.

    Args:
        airfoil: a name, or a pair ``(x, z)`` of coordinates over the chord.

    Returns:
        [4, POINTS]: height over chord and its rate by t, half thickness per unit thickness ratio and its rate.
    """
    t = np.linspace(0.0, np.pi, POINTS)
    height, slope = mean_line(airfoil, (1 - np.cos(t)) / 2)
    if isinstance(airfoil, str) or is_mean_line(airfoil[0]):
        half, rate = naca_half(t)
    else:
        x, z = airfoil
        fine, _ = fitted_half(x, z, np.linspace(0.0, np.pi, 2001))
        half, rate = (v / (2 * fine.max()) for v in fitted_half(x, z, t))
    return np.stack([height, slope * np.sin(t) / 2, half, rate])
