"""Laws of spacing along a span or a chord, by AVL's numbers."""

import math

WORDS = {"uniform": 0.0, "cosine": 1.0, "sine": -2.0, "sine-inner": 2.0}


def law_number(text: str) -> float:
    """AVL's number of a law: 0 or 3 uniform, 1 cosine, 2 dense at the start, -2 dense at the end, blends between."""
    return WORDS[text] if text in WORDS else float(text)


def law_at(law: float, u: float) -> float:
    """Position from 0 to 1 at the parameter ``u``: AVL's SPACER, a blend of uniform, cosine and sine."""
    theta = math.pi * u
    sine = 1.0 - math.cos(theta / 2) if law >= 0.0 else math.sin(theta / 2)
    uniform, cosine, share = blend(law)
    return uniform * u + cosine * (1.0 - math.cos(theta)) / 2 + share * sine


def blend(law: float) -> tuple[float, float, float]:
    """Shares of uniform, cosine and sine in a law."""
    size = abs(law)
    if size <= 1.0:
        return 1.0 - size, size, 0.0
    if size <= 2.0:
        return 0.0, 2.0 - size, size - 1.0
    return size - 2.0, 0.0, 3.0 - size


def chord_points(law: float, n: int) -> tuple[list[float], list[float], list[float]]:
    """Edges of n panels along a chord, their vortices and their control points, as fractions of the chord.

    Uniform panels have vortex and control point at one and three quarters. With the cosine law these points are
    spread by the law themselves (Lan's quasi-vortex idea, as in AVL's CSPACER): with d = pi / (4n + 2), edge i is
    (1 - cos((4i - 3) d)) / 2, its vortex d and its control point 3d farther; the sine law has d = pi / (8n + 2).
    """
    uniform, cosine, sine = blend(law)
    step, half = math.pi / (4 * n + 2), 0.5 * math.pi / (4 * n + 1)

    def at(i: int, part: int) -> float:
        k = 4 * i + 1 + part
        rear = 1.0 - math.cos(k * half) if law >= 0.0 else math.sin(k * half)
        return uniform * (i + part / 4) / n + cosine * (1.0 - math.cos(k * step)) / 2 + sine * rear

    edges = [0.0, *(at(i, 0) for i in range(1, n)), 1.0]
    return edges, [at(i, 1) for i in range(n)], [at(i, 3) for i in range(n)]
