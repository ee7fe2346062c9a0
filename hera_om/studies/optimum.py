"""What can be said of an optimum: margins, multipliers, and the gain split by cause."""

from typing import Any

import numpy as np
import openmdao.api as om
from scipy.optimize import nnls

from hera_om.aircraft import Aircraft, variable_box
from hera_om.models.cases import Goal, Limit
from hera_om.studies.values import number

FEASIBLE = 1e-4  # of a bound: a smaller violation counts as rounding of the driver
ACTIVE = 2e-3  # of a bound, or of a variable's range: closer than this it is active
DRAG_PARTS = ("CDi_near", "CD_slipstream", "CD_profile", "CD_fuselage", "CD_areas")
GRAVITY = 9.80665


def constraint_rows(problem: om.Problem, limits: tuple[Limit, ...]) -> dict[str, dict[str, Any]]:
    """Value, bounds and signed margin (negative: violated; relative to the bound) of every constraint."""
    out = {}
    for limit in limits:
        value = number(problem, limit.name)
        gaps = [(value - limit.lower, limit.lower)] if limit.lower is not None else []
        gaps += [(limit.upper - value, limit.upper)] if limit.upper is not None else []
        margin = min(gap / (abs(bound) or 1.0) for gap, bound in gaps)
        out[limit.name] = {
            "value": value,
            "lower": limit.lower,
            "upper": limit.upper,
            "margin": margin,
            "violated": margin < -FEASIBLE,
            "active": margin < ACTIVE,
            "multiplier": None,
            "reason": limit.reason,
        }
    return out


def variable_rows(problem: om.Problem, aircraft: Aircraft) -> dict[str, dict[str, Any]]:
    """Value, bounds and multiplier of every variable."""
    box, out = variable_box(aircraft), {}
    for i, n in enumerate(box.names):
        value, width = number(problem, n, box.units[i]), box.upper[i] - box.lower[i]
        at = (
            "lower"
            if value - box.lower[i] < ACTIVE * width
            else "upper"
            if box.upper[i] - value < ACTIVE * width
            else None
        )
        row = {"value": value, "lower": box.lower[i], "baseline": box.baseline[i], "upper": box.upper[i]}
        out[n] = row | {"at_bound": at, "multiplier": None}
    return out


def multipliers(problem: om.Problem, aircraft: Aircraft, goal: Goal, constraints, variables) -> dict[str, float]:
    """Fill in the multipliers and return how well the conditions of Karush, Kuhn and Tucker hold.

    At an optimum the objective's gradient is a sum of the active constraints' outward gradients with factors
    that are not negative: what a unit of relaxation gains. They are found by non-negative least squares over
    variables scaled by their ranges (Nocedal & Wright, Numerical Optimization 2e, theorem 12.1).
    """
    box = variable_box(aircraft)
    width = np.array(box.upper) - np.array(box.lower)
    active = [n for n, row in constraints.items() if row["active"]]
    totals: Any = problem.compute_totals([goal.name, *active], list(box.names))

    def gradient(name: str) -> np.ndarray:
        return np.array([totals[name, v][0, 0] for v in box.names]) * width

    rows: list[tuple[dict[str, Any], np.ndarray]] = []
    for n in active:
        row = constraints[n]
        above = row["upper"] is not None and (
            row["lower"] is None or row["upper"] - row["value"] < row["value"] - row["lower"]
        )
        rows.append((row, gradient(n) * (1.0 if above else -1.0)))
    for i, n in enumerate(box.names):
        if variables[n]["at_bound"]:
            unit = np.eye(len(width))[i] * width[i]
            rows.append((variables[n], unit if variables[n]["at_bound"] == "upper" else -unit))
    target = gradient(goal.name) * (1.0 if goal.sense == "max" else -1.0)
    norm = float(np.linalg.norm(target))
    if not rows:
        return {"gradient": norm, "residual": norm}
    scale = np.array([np.linalg.norm(g) or 1.0 for _, g in rows])
    factors, left = nnls(np.stack([g for _, g in rows], axis=1) / scale, target)
    for (row, _), factor, s in zip(rows, factors, scale, strict=True):
        row["multiplier"] = float(factor / s)
    return {"gradient": norm, "residual": float(left)}


def gain_by_cause(before: dict[str, float], after: dict[str, float]) -> dict[str, float]:
    """Split the change of range at fixed take-off mass among its causes, km.

    Range is (U / c_s) (CL / CD) ln(Wi / Wf), so ln(R1 / R0) is a sum: lift, each part of drag by its share of
    the change of CD (logarithmic mean, exact), and fuel, which the structural mass saved has become. Each cause
    gets its share of the logarithm times the change.
    """
    keys = ("range_fixed_mass", "CL", "CD", "L_over_D")
    r0, cl0, cd0, ld0 = (before[k] for k in keys)
    r1, cl1, cd1, ld1 = (after[k] for k in keys)
    total = np.log(r1 / r0)
    mean = cd0 if abs(cd1 - cd0) < 1e-12 else (cd1 - cd0) / np.log(cd1 / cd0)
    shares = {"lift coefficient": np.log(cl1 / cl0)}
    names = ("induced drag", "slipstream drag", "profile drag", "fuselage drag", "fixed drag areas")
    shares |= {n: (before[p] - after[p]) / mean for n, p in zip(names, DRAG_PARTS, strict=True)}
    fuel = total - np.log(ld1 / ld0)
    saved = {"wing mass": before["m_wing"] - after["m_wing"]} if "m_wing" in before else {}
    saved["other structural mass"] = after["mass_saved"] - before["mass_saved"] - sum(saved.values())
    weight = sum(saved.values())
    shares |= {f"fuel from {n}": fuel * m / weight if abs(weight) > 1e-9 else 0.0 for n, m in saved.items()}
    unit = (r1 - r0) / total if abs(total) > 1e-12 else 0.0
    return {name: float(share * unit) for name, share in shares.items()} | {"total": float(r1 - r0)}
