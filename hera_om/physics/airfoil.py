"""Camber lines of the NACA four- and five-digit families."""

import numpy as np

# Five-digit mean lines: (position of maximum camber, m, k1) at a design lift coefficient of 0.3.
# Abbott & von Doenhoff, Theory of Wing Sections, section 6.5 (after NACA Report 537, table I).
_FIVE_DIGIT = {
    "10": (0.0580, 361.4),
    "20": (0.1260, 51.64),
    "30": (0.2025, 15.957),
    "40": (0.2900, 6.643),
    "50": (0.3910, 3.230),
}
_DESIGN_CL_PER_DIGIT = 0.15
_TABLE_CL = 0.3


def camber_line(name: str, x) -> tuple[np.ndarray, np.ndarray]:
    """Height and slope of a camber line at chord fractions ``x``.

    Equations: Abbott & von Doenhoff, Theory of Wing Sections, eqs. 6.4 (four digits) and 6.6 (five digits,
    simple mean line).

    Args:
        name: ``"NACA 2412"``, ``"NACA 43018"`` or ``"flat"``.
        x: chord fractions in [0, 1], any shape.

    Returns:
        ``(z / c, dz / dx)``, each of the shape of ``x``.

    Raises:
        ValueError: for any other name, reflexed five-digit lines included.
    """
    x = np.asarray(x, float)
    digits = name.upper().replace("NACA", "").strip()
    if name.lower() == "flat":
        return np.zeros_like(x), np.zeros_like(x)
    if len(digits) == 4 and digits.isdigit():
        return _four_digit(int(digits[0]) / 100, int(digits[1]) / 10, x)
    if len(digits) == 5 and digits.isdigit() and digits[1:3] in _FIVE_DIGIT:
        scale = int(digits[0]) * _DESIGN_CL_PER_DIGIT / _TABLE_CL
        m, k1 = _FIVE_DIGIT[digits[1:3]]
        return _five_digit(m, scale * k1, x)
    raise ValueError(
        f"unknown airfoil {name!r}: expected 'flat', 'NACA' with 4 digits, or with 5 digits ds0tt, s = 1..5"
    )


def _four_digit(m: float, p: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two parabolas that meet at the position of maximum camber."""
    if m == 0.0 or p == 0.0:
        return np.zeros_like(x), np.zeros_like(x)
    ahead = x < p
    rear = (1 - p) ** 2
    z = np.where(ahead, m / p**2 * (2 * p * x - x**2), m / rear * (1 - 2 * p + 2 * p * x - x**2))
    slope = np.where(ahead, 2 * m / p**2 * (p - x), 2 * m / rear * (p - x))
    return z, slope


def _five_digit(m: float, k1: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A cubic to x = m, a straight line behind it."""
    ahead = x < m
    z = np.where(ahead, x**3 - 3 * m * x**2 + m**2 * (3 - m) * x, m**3 * (1 - x)) * k1 / 6
    slope = np.where(ahead, 3 * x**2 - 6 * m * x + m**2 * (3 - m), -(m**3)) * k1 / 6
    return z, slope
