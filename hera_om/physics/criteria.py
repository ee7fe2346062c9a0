"""Flying-qualities limits as data, and signed margins to them.

Quantities carry registry names and SI units. Trust: the lateral MIL-F-8785C rows are verified in public text,
the longitudinal ones are after the specification and its textbook copies, the DEF STAN 00-970 rows after
Cook, Flight Dynamics Principles, table 10.4 (moderate). The paper's 0.2-1.4 on ``zeta_sp`` is not MIL's Level
1 pair for category B.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

ScalarLike = Float[Array, ""] | float | int

MIL = "MIL-F-8785C (1980)"
DEF_STAN = "DEF STAN 00-970"
PAPER = "Granata et al. (2026), Table 7"
ALL_CLASSES = ("I", "II", "III", "IV")


@dataclass(frozen=True)
class Criterion:
    """Limits on one quantity for flight phases (one letter each), aircraft classes and a level."""

    quantity: str
    lower: float | None
    upper: float | None
    unit: str
    categories: str
    classes: tuple[str, ...]
    level: int
    standard: str
    paragraph: str


class Margins(NamedTuple):
    """Distance inside the lower and the upper limit, positive when met; None where there is no such limit."""

    lower: Float[Array, ""] | None
    upper: Float[Array, ""] | None


def _mil(quantity, unit, paragraph, *rows):
    """Criteria of one quantity from rows (categories, classes, level, lower, upper)."""
    return tuple(
        Criterion(quantity, lower, upper, unit, categories, classes, level, MIL, paragraph)
        for categories, classes, level, lower, upper in rows
    )


_LANDING = ("II-L", "III")

CRITERIA: tuple[Criterion, ...] = (
    *_mil(
        "zeta_sp", "1", "3.2.2.1.2",
        ("A", ALL_CLASSES, 1, 0.35, 1.3), ("A", ALL_CLASSES, 2, 0.25, 2.0), ("A", ALL_CLASSES, 3, 0.15, None),
        ("B", ALL_CLASSES, 1, 0.30, 2.0), ("B", ALL_CLASSES, 2, 0.20, 2.0), ("B", ALL_CLASSES, 3, 0.15, None),
        ("C", ALL_CLASSES, 1, 0.35, 1.3), ("C", ALL_CLASSES, 2, 0.25, 2.0), ("C", ALL_CLASSES, 3, 0.15, None),
    ),
    *_mil(
        "CAP", "rad2/s2 per g", "3.2.2.1.1",
        ("A", ALL_CLASSES, 1, 0.28, 3.6), ("A", ALL_CLASSES, 2, 0.16, 10.0),
        ("B", ALL_CLASSES, 1, 0.085, 3.6), ("B", ALL_CLASSES, 2, 0.038, 10.0),
        ("C", ALL_CLASSES, 1, 0.16, 3.6), ("C", ALL_CLASSES, 2, 0.096, 10.0),
    ),
    *_mil(
        "omega_sp", "rad/s", "3.2.2.1.1", ("A", ALL_CLASSES, 1, 1.0, None), ("C", _LANDING, 1, 0.7, None)
    ),
    *_mil("n_alpha", "g/rad", "3.2.2.1.1", ("C", _LANDING, 1, 2.0, None)),
    *_mil(
        "zeta_ph", "1", "3.2.1.2", ("ABC", ALL_CLASSES, 1, 0.04, None), ("ABC", ALL_CLASSES, 2, 0.0, None)
    ),
    *_mil("t2_phugoid", "s", "3.2.1.2", ("ABC", ALL_CLASSES, 3, 55.0, None)),
    *_mil(
        "zeta_dr", "1", "3.3.1.1",
        ("B", ALL_CLASSES, 1, 0.08, None), ("ABC", ALL_CLASSES, 2, 0.02, None),
        ("C", _LANDING, 1, 0.08, None), ("A", ("II", "III"), 1, 0.19, None),
    ),
    *_mil(
        "zeta_omega_dr", "rad/s", "3.3.1.1",
        ("B", ALL_CLASSES, 1, 0.15, None), ("ABC", ALL_CLASSES, 2, 0.05, None),
        ("C", _LANDING, 1, 0.10, None), ("A", ("II", "III"), 1, 0.35, None),
    ),
    *_mil(
        "omega_dr", "rad/s", "3.3.1.1", ("B", ALL_CLASSES, 1, 0.4, None), ("ABC", ALL_CLASSES, 2, 0.4, None)
    ),
    *_mil(
        "tau_roll", "s", "3.3.1.2",
        ("B", ALL_CLASSES, 1, None, 1.4), ("B", ALL_CLASSES, 2, None, 3.0),
        ("ABC", ALL_CLASSES, 3, None, 10.0),
    ),
    *_mil(
        "t2_spiral", "s", "3.3.1.3",
        ("B", ALL_CLASSES, 1, 20.0, None), ("AC", ALL_CLASSES, 1, 12.0, None),
        ("ABC", ALL_CLASSES, 2, 8.0, None), ("ABC", ALL_CLASSES, 3, 4.0, None),
    ),
    Criterion("zeta_sp", 0.3, 2.0, "1", "B", ALL_CLASSES, 1, DEF_STAN, "after Cook, table 10.4"),
    Criterion("zeta_sp", 0.5, 1.3, "1", "C", ALL_CLASSES, 1, DEF_STAN, "after Cook, table 10.4"),
)  # fmt: skip

TABLE_7: tuple[Criterion, ...] = (
    Criterion("static_margin", 0.05, 0.35, "1", "B", ("III",), 1, PAPER, "Eq. 2"),
    Criterion("omega_sp", 2.3, 3.5, "rad/s", "B", ("III",), 1, PAPER, "Eq. 4"),
    Criterion("zeta_sp", 0.2, 1.4, "1", "B", ("III",), 1, PAPER, "Eq. 3"),
    Criterion("zeta_ph", 0.04, None, "1", "B", ("III",), 1, PAPER, "Eq. 5"),
    Criterion("RFC", 1.5, None, "1", "B", ("III",), 1, PAPER, "structure"),
    Criterion("RFT", 1.5, None, "1", "B", ("III",), 1, PAPER, "structure"),
)


def select(quantity: str, category: str, aircraft_class: str, *, level: int = 1, standard: str = MIL) -> Criterion:
    """The one criterion that applies.

    Source: the tables of this module.

    Args:
        quantity: registry name.
        category: flight phase category, "A", "B" or "C".
        aircraft_class: "I", "II", "III", "IV"; "II-L" for class II, land-based.
        level: 1, 2 or 3.
        standard: ``MIL`` or ``DEF_STAN``.

    Returns:
        The criterion.

    Raises:
        KeyError: when the standard, as far as it is held here, sets no such limit.
    """
    classes = {aircraft_class, aircraft_class.removesuffix("-L")}
    for row in CRITERIA:
        wanted = (row.quantity, row.level, row.standard) == (quantity, level, standard)
        if wanted and category in row.categories and classes.intersection(row.classes):
            return row
    where = f"category {category}, class {aircraft_class}"
    raise KeyError(f"{standard} has no level {level} limit on {quantity}, {where}")


def margin(value: ScalarLike, lower: float | None, upper: float | None) -> Margins:
    """Signed margins to one or two limits, normalised so that different quantities compare.

    ``(value - lower) / s`` and ``(upper - value) / s``, with ``s`` the width between two limits, else the
    size of the one limit, else 1.

    Source: definition.

    Args:
        value: the quantity.
        lower: lower limit or None.
        upper: upper limit or None.

    Returns:
        Both margins, positive inside.

    Raises:
        ValueError: when there is no limit, or the limits are not in order.
    """
    limits = [limit for limit in (lower, upper) if limit is not None]
    if not limits:
        raise ValueError("a margin needs a lower or an upper limit; both are None")
    scale = limits[1] - limits[0] if len(limits) == 2 else abs(limits[0]) or 1.0
    if scale <= 0.0:
        raise ValueError(f"the lower limit {lower} is not below the upper limit {upper}")
    return Margins(
        lower=None if lower is None else jnp.asarray((value - lower) / scale),
        upper=None if upper is None else jnp.asarray((upper - value) / scale),
    )


def doubling_time_margin(growth_rate: ScalarLike, minimum: float) -> Float[Array, ""]:
    """Signed margin to a least time to double amplitude, smooth through neutral stability.

    ``(s_max - s) / s_max`` with ``s_max = ln 2 / T2_min``: 1 for a neutral mode, above 1 for a stable one,
    which has no time to double and which a comparison of times would fail.

    Source: definition of the time to double, Etkin and Reid, Dynamics of Flight (3rd edition), section 6.1.

    Args:
        growth_rate: real part of the root (``spiral_root``; of the phugoid ``-two_zeta_omega / 2``), 1/s.
        minimum: least time to double, s (``t2_spiral``, ``t2_phugoid``).

    Returns:
        Margin, positive when met.

    Valid for a positive minimum.
    """
    limit = math.log(2.0) / minimum
    return jnp.asarray((limit - growth_rate) / limit)
