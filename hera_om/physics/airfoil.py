"""Camber lines of the NACA four- and five-digit families and of coordinates."""

from typing import Any

import numpy as np

from hera_om.core.mean_lines import mean_line


def camber_line(airfoil: Any, x) -> tuple[np.ndarray, np.ndarray]:
    """Height and slope of a camber line at chord fractions ``x``.

    Equations: Abbott & von Doenhoff, Theory of Wing Sections, eqs. 6.4 (four digits) and 6.6 (five digits,
    simple mean line); coordinates by a least-squares spline, see `core.mean_lines.fitted_line`.

    Args:
        airfoil: ``"NACA 2412"``, ``"NACA 43018"`` or ``"flat"``, or a pair ``(x, z)`` of coordinates over the
            chord: a contour from trailing edge to trailing edge, or a mean line with rising x.
        x: chord fractions in [0, 1], any shape.

    Returns:
        ``(z / c, dz / dx)``, each of the shape of ``x``.

    Raises:
        ValueError: for any other name, reflexed five-digit lines included.
    """
    return mean_line(airfoil, x)
