"""Mean lines of aerofoils: the NACA families by formula, coordinates by a smooth fit. NumPy only."""

from typing import Any, NamedTuple

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
_MOST_INTERVALS = 24  # of the spline: finer than any mean line asks for, coarser than the noise of rounded files
_THICKNESS = (0.2969, -0.1260, -0.3516, 0.2843, -0.1015)  # x^(1/2), x, x^2, x^3, x^4 over 0.2; Abbott, eq. 6.2


def naca_line(name: str, x: Any) -> tuple[np.ndarray, np.ndarray]:
    """Height over chord and slope of a NACA mean line, or of ``"flat"``, at chord fractions ``x``.

    Abbott & von Doenhoff, Theory of Wing Sections, eqs. 6.4 (four digits) and 6.6 (five digits, simple line).

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


def fitted_line(x: Any, z: Any, at: Any) -> tuple[np.ndarray, np.ndarray]:
    """Height over chord and slope of the mean line through coordinates, at chord fractions ``at``.

    With x = (1 - cos t) / 2, the mean line is an even function of t and half the thickness of a contour an odd
    one. Both are cubic splines in t, fitted together by least squares to z = mean + half on one side and
    z = mean - half on the other: sides need no common abscissae, and rounded ordinates are smoothed. The mean is
    taken along z, as AVL does. Heights count from the leading edge; a chord line that is turned stays turned.

    Args:
        x: a contour from trailing edge over leading edge to trailing edge, or a mean line with rising x.
        z: ordinates of the same length.
        at: chord fractions in [0, 1], any shape.

    Returns:
        ``(z / c, dz / dx)``, each of the shape of ``at``.
    """
    at = np.asarray(at, float)
    mean, values, _, _ = _fit(x, z)
    height, rate, second = (rows @ values for rows in mean.rows(_angle(at).ravel()))
    slope = _by_chord(_angle(at).ravel(), rate, second)
    return (height - values[0]).reshape(at.shape), slope.reshape(at.shape)


def fitted_half(x: Any, z: Any, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half thickness over chord of a contour and its rate by t, at angles t of chord fractions (1 - cos t) / 2.

    The odd part of the fit of `fitted_line`; arguments as there, but ``x`` must be those of a contour.
    """
    _, _, half, values = _fit(x, z)
    value, rate, _ = (rows[:, 1:] @ values for rows in half.rows(np.asarray(t, float)))
    return value, rate


def naca_half(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half thickness over chord per unit thickness ratio of the NACA form and its rate by t; Abbott, eq. 6.2."""
    t = np.asarray(t, float)
    x, slope = (1 - np.cos(t)) / 2, np.sin(t) / 2
    root, *rest = (a / 0.2 for a in _THICKNESS)
    value = root * np.sin(t / 2) + sum(a * x**i for i, a in enumerate(rest, 1))
    rate = root * np.cos(t / 2) / 2 + slope * sum(i * a * x ** (i - 1) for i, a in enumerate(rest, 1))
    return value, rate


def mean_line(airfoil: Any, x: Any) -> tuple[np.ndarray, np.ndarray]:
    """Height and slope of a mean line: of a name (``naca_line``) or of a pair of coordinates (``fitted_line``)."""
    return naca_line(airfoil, x) if isinstance(airfoil, str) else fitted_line(airfoil[0], airfoil[1], x)


def is_mean_line(x: Any) -> bool:
    """Whether abscissae only rise: then they are those of a mean line, not of a contour."""
    return bool(np.all(np.diff(np.asarray(x, float)) > 0))


class Contour(NamedTuple):
    """A contour from the trailing edge over the upper side to the nose and back below, by chord fractions."""

    x: tuple[float, ...]
    z: tuple[float, ...]


def contour(height: Any, thickness: float, points: int = 61) -> Contour:
    """A contour about a mean line, thickness of the NACA four digits laid along z: its mean is the line itself.

    Args:
        height: function of chord fractions that gives the mean line's height over chord.
        thickness: largest thickness over chord.
        points: points of one side, denser at both edges.
    """
    x = (1 - np.cos(np.linspace(0.0, np.pi, points))) / 2
    powers = (np.sqrt(x), x, x**2, x**3, x**4)
    half = thickness / 0.2 * sum((a * p for a, p in zip(_THICKNESS, powers, strict=True)), np.zeros_like(x))
    z = np.asarray(height(x))
    upper, lower = (z + half)[::-1], (z - half)[1:]
    both = np.concatenate([x[::-1], x[1:]]), np.concatenate([upper, lower])
    return Contour(*(tuple(np.round(v, 9).tolist()) for v in both))


def _fit(x: Any, z: Any) -> tuple["_Spline", np.ndarray, "_Spline", np.ndarray]:
    """Splines of mean line and half thickness and their values at the knots; a mean line has no half."""
    x, z = np.asarray(x, float), np.asarray(z, float)
    nose, tail = x.min(), x[-1] if is_mean_line(x) else (x[0] + x[-1]) / 2
    t, z = _angle((x - nose) / (tail - nose)), z / (tail - nose)
    if is_mean_line(x):
        knots = _knots(t, _MOST_INTERVALS)
        mean, half = _Spline(knots, odd=False), _Spline(knots, odd=True)
        return mean, np.linalg.lstsq(mean.rows(t)[0], z, rcond=None)[0], half, np.zeros(len(knots) - 1)
    first = int(np.argmin(x))
    side = np.where(np.arange(len(x)) <= first, 1.0, -1.0)
    knots = _knots(t, min(_MOST_INTERVALS, max(3, min(first, len(x) - first - 1) // 2)))
    mean, half = _Spline(knots, odd=False), _Spline(knots, odd=True)
    basis = np.hstack([mean.rows(t)[0], side[:, None] * half.rows(t)[0][:, 1:]])  # half is 0 at the nose
    values = np.linalg.lstsq(basis, z, rcond=None)[0]
    return mean, values[: len(knots)], half, values[len(knots) :]


class _Spline:
    """Cubic spline as a linear map from its values at the knots; even about both ends, or odd about the first."""

    def __init__(self, knots: np.ndarray, *, odd: bool) -> None:
        self.knots, self.steps = knots, np.diff(knots)
        n, h = len(knots), self.steps
        left, right = np.zeros((n, n)), np.zeros((n, n))
        for i in range(1, n - 1):
            left[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
            right[i, i - 1 : i + 2] = 6 / h[i - 1], -6 / h[i - 1] - 6 / h[i], 6 / h[i]
        if odd:
            left[0, 0] = 1.0
        else:
            left[0, :2], right[0, :2] = (2 * h[0], h[0]), (-6 / h[0], 6 / h[0])
        left[-1, -2:], right[-1, -2:] = (h[-1], 2 * h[-1]), (6 / h[-1], -6 / h[-1])
        self.second = np.linalg.solve(left, right)

    def rows(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Matrices that take the knots' values to the value and two derivatives at ``t``."""
        i = np.clip(np.searchsorted(self.knots, t, side="right") - 1, 0, len(self.steps) - 1)
        h = self.steps[i][:, None]
        b = (t[:, None] - self.knots[i][:, None]) / h
        a, unit = 1 - b, np.eye(len(self.knots))
        v0, v1, m0, m1 = unit[i], unit[i + 1], self.second[i], self.second[i + 1]
        value = a * v0 + b * v1 + ((a**3 - a) * m0 + (b**3 - b) * m1) * h**2 / 6
        rate = (v1 - v0) / h + ((1 - 3 * a**2) * m0 + (3 * b**2 - 1) * m1) * h / 6
        return value, rate, a * m0 + b * m1


def _angle(x: np.ndarray) -> np.ndarray:
    """t of x = (1 - cos t) / 2."""
    return np.arccos(1 - 2 * np.clip(x, 0.0, 1.0))


def _knots(t: np.ndarray, intervals: int) -> np.ndarray:
    """Knots from 0 to pi that share the points evenly."""
    distinct = np.unique(np.round(t, 9))
    inner = np.quantile(distinct, np.linspace(0, 1, min(intervals, len(distinct) - 1) + 1)[1:-1])
    return np.concatenate([[0.0], inner, [np.pi]])


def _by_chord(t: np.ndarray, rate: np.ndarray, second: np.ndarray) -> np.ndarray:
    """dz/dx = 2 z'(t) / sin t, and its limit 2 z''(t) / cos t at the edges, where z' is zero."""
    sine = np.sin(t)
    edge = sine < 1e-6
    return np.where(edge, 2 * second / np.cos(t), 2 * rate / np.where(edge, 1.0, sine))


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
