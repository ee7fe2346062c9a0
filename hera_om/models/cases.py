"""Variables, constraints and objectives of each case, as tables with bounds and reasons."""

from dataclasses import dataclass

from hera_om.aircraft.definition import Aircraft
from hera_om.physics.criteria import TABLE_7


@dataclass(frozen=True)
class Limit:
    """A constraint of a case; a bound is None where there is none."""

    name: str
    lower: float | None
    upper: float | None
    reason: str


@dataclass(frozen=True)
class Goal:
    """An objective with its sense and its scale for the driver."""

    name: str
    sense: str  # "max" or "min"
    ref: float


TRIM_BALANCE = 1e-6  # of the load coefficients; the paper stops at 0.05

# Table 4 of the paper: bounds in degrees. Blade pitch takes the definition's bounds where it has any.
TABLE_4 = {"alpha": (-2.0, 9.0), "delta_e": (-10.0, 10.0), "theta": (40.0, 60.0)}

# Objectives of the mdo case by name; the first is the default.
GOALS = {
    g.name: g
    for g in (
        Goal("range_fixed_mass", "max", 1000.0),
        Goal("range_fixed_fuel", "max", 1000.0),
        Goal("range_per_energy", "max", 5e-5),
        Goal("L_over_D", "max", 15.0),
    )
}
MDO_GOAL = GOALS["range_fixed_mass"]
TRIM_GOAL = Goal("L_over_D", "max", 15.0)
BOX_LIMITS = ("RFC", "RFT")


def mdo_limits(boxed: bool) -> tuple[Limit, ...]:
    """Table 7 of the paper, without the reserve factors for an aircraft whose wing is not sized."""
    return tuple(
        Limit(c.quantity, c.lower, c.upper, f"{c.standard}: {c.paragraph}")
        for c in TABLE_7
        if boxed or c.quantity not in BOX_LIMITS
    )


def table_4(aircraft: Aircraft) -> dict[str, tuple[float, float]]:
    """Bounds of the trim variables of Table 4 for an aircraft, deg."""
    out = {"alpha": TABLE_4["alpha"]}
    if aircraft.htail is not None and aircraft.htail.control.elevator is not None:
        out["delta_e"] = TABLE_4["delta_e"]
    for rotor in aircraft.rotor:
        low, high = rotor.beta75_min_deg, rotor.beta75_max_deg
        out[f"theta_{rotor.name}"] = (
            TABLE_4["theta"][0] if low is None else low,
            TABLE_4["theta"][1] if high is None else high,
        )
    return out


# Where a run starts: share of the way from lower to upper bound of every variable; None is the baseline.
STARTS: dict[str, float | None] = {"baseline": None, "low": 0.25, "high": 0.75}
