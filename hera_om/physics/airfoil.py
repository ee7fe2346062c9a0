"""Camber lines and thickness of the NACA four- and five-digit families and of coordinates."""

from typing import Any

import numpy as np

from hera_om.core.contours import POINTS, contour_table
from hera_om.core.mean_lines import mean_line

_COUNT = 8  # of the stations of thickness; they are nodes of a contour's table
_NODES = np.arange((POINTS - 1) // _COUNT // 2, POINTS - 1, (POINTS - 1) // _COUNT)
_ANGLE = np.linspace(0.0, np.pi, POINTS)[_NODES]
STATIONS = (1.0 - np.cos(_ANGLE)) / 2.0
"""Chord fractions of the stations of thickness, at the middles of equal steps of their angle: a round nose is no
singularity there."""


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


def thickness_growth(airfoil: Any) -> np.ndarray:
    """Growth of thickness at the `STATIONS`, over chord and per unit thickness ratio; a trailing edge is closed.

    Args:
        airfoil: as for `camber_line`; a mean line has the thickness of the NACA four-digit form.

    Returns:
        Steps of the thickness, zero in all.
    """
    rate = 2.0 * np.pi / _COUNT * contour_table(airfoil)[3][_NODES]
    return rate - rate.sum() * np.sin(_ANGLE) / np.sin(_ANGLE).sum()
