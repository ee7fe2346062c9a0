"""What rotors, wing and tail do to each other: Tables 2 and 3 of the paper, the split by part, curves and fields.

Every configuration is the same aircraft with parts taken off. Reference quantities and moment point stay those of the
whole, and rotors keep their places in space when the wing goes.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash
from hera_om.aircraft.reference import reference_b
from hera_om.components import arrays
from hera_om.components.aero_plan import ROTORS
from hera_om.components.mass import MassProperties
from hera_om.core.errors import AnalysisFailure, InputError, Problem
from hera_om.studies.analysis import analyze
from hera_om.studies.interaction_fields import fields

FULL, CLEAN, BODY_TAIL = "Full with rotors", "Full without rotors", "Fuselage + tail"
WING, DISKS, WING_DISKS = "Wing isolated", "Rotors isolated", "Wing + rotors"
TAIL = "htail"
CURVE = (-4.0, -2.0, 0.0, 2.0, 4.0, 5.0, 6.0, 8.0, 10.0)
"""Incidences of the curves, deg."""
FACTOR = 1.5
"""A number that differs from the paper's by more than this factor, or in its sign, wants an explanation."""
SOURCE = "the paper's Tables 2 and 3: DUST, vortex lattice and vortex particles, on the HERA geometry, not public"
PAPER_2 = {
    0.0: {"L_over_D isolated": 14.33, "L_over_D": 16.24, "L_over_D change": 13.35, "thrust change": 11.21},
    5.0: {"L_over_D isolated": 11.01, "L_over_D": 12.20, "L_over_D change": 10.76, "thrust change": 12.12},
    10.0: {"L_over_D isolated": 6.87, "L_over_D": 7.15, "L_over_D change": 4.17, "thrust change": 5.73},
}
"""By incidence in degrees: L/D of the wing without and with rotors, changes by installation in percent."""
SLOPES = ("CZ_alpha", "Cm_alpha", "CZ_tail_alpha", "Cm_tail_alpha")
_PAPER_3 = {
    CLEAN: (0.065034, -0.041431, 0.009575, -0.098089, 0.0, 0.0, 0.0, 0.0),
    FULL: (0.068198, -0.040348, 0.010086, -0.103550, 4.865, 2.614, 5.338, -5.569),
    BODY_TAIL: (0.014139, -0.091405, 0.011667, -0.120860, -78.259, -120.620, 21.843, -23.217),
}
PAPER_3 = {name: dict(zip((*SLOPES, *(f"{s} change" for s in SLOPES)), v, strict=True)) for name, v in _PAPER_3.items()}
"""Slopes between 0 and 5 degrees, per degree, and their changes in percent of the size of the first row's."""


def interact(aircraft: Aircraft, alphas: Sequence[float] = (0.0, 5.0)) -> dict[str, Any]:
    """Effects of the rotors on wing, tail and stability, and of the wing on the rotors.

    Args:
        aircraft: with wing, horizontal tail and rotors; all else of the flight condition is the definition's.
        alphas: incidences, deg; slopes of Table 3 are those of the chord from the first to the last.

    Returns:
        ``table2`` and ``table3``, rows with the paper's numbers beside (Table 2 at the incidences that it has);
        ``differences``, what is beyond `FACTOR` or of another sign; ``split``, coefficients and derivatives of
        the parts with and without rotors and the slipstreams' share, the difference, by incidence; ``curves`` over
        incidence by configuration; ``span``, ``leading_edge`` and ``blades``, what the pictures need.

    Raises:
        InputError: no wing, no horizontal tail, no rotor, or fewer than two incidences.
        AnalysisFailure: no converged solution.
    """
    _check(aircraft, alphas)
    cases = configurations(aircraft)
    found = states(cases, alphas)
    second, third = table2(found, alphas), table3(found, alphas)
    curves = {name: _curve(cases[name], found[name]) for name in (CLEAN, FULL, BODY_TAIL)}
    units = {"alpha": "deg", "thrust": "N", "slopes": "1/deg", "changes": "%"}
    result = {"aircraft": aircraft.name, "hash": definition_hash(aircraft), "units": units, "alphas": list(alphas)}
    result |= {"table2": second, "table3": third, "differences": differences([*second, *third]), "paper": SOURCE}
    result |= {"split": [split(found, a) for a in alphas], "curves": curves, "span": _span(found, alphas)}
    return result | fields(cases[WING_DISKS], cases[WING], cases[DISKS], alphas)


def configurations(aircraft: Aircraft) -> dict[str, Aircraft]:
    """The aircraft with parts taken off: references, moment point and places of the rotors as they are.

    Drag areas go with the wing, where most of them stand. No rotor has failed.
    """
    S, c, _ = (float(v) for v in arrays.reference(aircraft))
    x, y, z = moment_point(aircraft)
    given = {"S_m2": S, "c_m": c, "b_m": float(reference_b(aircraft)), "x_m": x, "y_m": y, "z_m": z}
    fixed = aircraft.reference.model_copy(update=given)
    intact = aircraft.flight.model_copy(update={"failed": ()})
    full = aircraft.model_copy(update={"reference": fixed, "flight": intact, "mass": (), "variables": ()})
    areas = tuple(d.model_copy(update={"rotor": None}) for d in full.drag_area)
    alone = {"drag_area": (), "fuselage": None, "htail": None, "vtail": None, "surface": ()}
    wing = full.model_copy(update=alone)
    return {
        FULL: full,
        CLEAN: full.model_copy(update={"rotor": (), "drag_area": areas}),
        BODY_TAIL: full.model_copy(update={"rotor": (), "drag_area": (), "wing": None}),
        WING: wing.model_copy(update={"rotor": ()}),
        WING_DISKS: wing,
        DISKS: wing.model_copy(update={"wing": None, "rotor": _in_space(full)}),
    }


def states(cases: dict[str, Aircraft], alphas: Sequence[float]) -> dict[str, dict[float, dict[str, Any]]]:
    """Analysis of every case at every incidence in degrees."""
    return {name: {a: _at(case, a) for a in alphas} for name, case in cases.items()}


def moment_point(aircraft: Aircraft) -> tuple[float, ...]:
    """The point that `analyze` takes moments about: that of the definition, else the centre of gravity, if any."""
    point = tuple(float(v) for v in arrays.moment_point(aircraft))
    if aircraft.reference.x_m is not None or not aircraft.mass:
        return point
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("mass", MassProperties(aircraft=aircraft), promotes=["*"])
    problem.setup()
    problem.run_model()
    return float(problem.get_val("x_cg")[0]), point[1], float(problem.get_val("z_cg")[0])


def _in_space(aircraft: Aircraft) -> tuple[Any, ...]:
    """Every rotor as a group of its own, at the place of its hub."""
    every = arrays.rotors(aircraft)
    assert every is not None
    groups = [(r, i) for r in aircraft.rotor for i in range(r.count_per_side)]
    away = {"count_per_side": 1, "spacing_m": None, "x_ahead_of_leading_edge_m": None, "z_offset_m": None}
    return tuple(
        r.model_copy(update=away | {"name": f"{r.name}_{i + 1}", "x_m": x, "y_m": y, "z_m": z})
        for (r, i), (x, y, z) in zip(groups, np.asarray(every.hub).tolist(), strict=True)
    )


def _at(aircraft: Aircraft, alpha: float) -> dict[str, Any]:
    """Analysis at an incidence in degrees."""
    flight = aircraft.flight.model_copy(update={"alpha_deg": float(alpha)})
    try:
        return analyze(aircraft.model_copy(update={"flight": flight}))
    except AnalysisFailure as error:
        raise AnalysisFailure(f"{error.what} at {alpha:g} deg", where="interaction") from error


def table2(found, alphas) -> list[dict[str, Any]]:
    """The wing with and without rotors, the rotors with and without wing."""
    rows = []
    for a in alphas:
        alone, both = found[WING][a], found[WING_DISKS][a]
        ours = {"L_over_D isolated": alone["L_over_D"], "L_over_D": both["L_over_D"]}
        ours["L_over_D change"] = change(both["L_over_D"], alone["L_over_D"])
        ours["thrust isolated"], ours["thrust"] = found[DISKS][a]["thrust"], both["thrust"]
        ours["thrust change"] = change(ours["thrust"], ours["thrust isolated"])
        rows.append({"table": 2, "case": f"{a:g} deg", "ours": ours, "paper": PAPER_2.get(float(a), {})})
    return rows


def table3(found, alphas) -> list[dict[str, Any]]:
    """Slopes of force, moment and tail loads of three configurations, per degree."""
    by = {name: slopes(found[name], alphas) for name in (CLEAN, FULL, BODY_TAIL)}
    rows = []
    for name, ours in by.items():
        changes = {f"{s} change": change(ours[s], by[CLEAN][s]) for s in SLOPES}
        rows.append({"table": 3, "case": name, "ours": ours | changes, "paper": PAPER_3[name]})
    return rows


def slopes(states: dict[float, Any], alphas) -> dict[str, float]:
    """Slopes of the chord from the first incidence to the last, per degree."""
    loads = [_loads(states[a]) for a in (alphas[0], alphas[-1])]
    return {f"{k}_alpha": (loads[1][k] - loads[0][k]) / (alphas[-1] - alphas[0]) for k in ("CZ", "Cm", *_TAIL_LOADS)}


_TAIL_LOADS = ("CZ_tail", "Cm_tail")


def _loads(state: dict[str, Any]) -> dict[str, float]:
    """Forces and moment of the whole, and of the tail."""
    tail = state["parts"][TAIL]
    whole = {k: state[k] for k in ("CX", "CZ", "Cm")}
    return whole | {"CZ_tail": tail["CZ"], "Cm_tail": tail["Cm"]}


def change(value: float, reference: float) -> float:
    """Change in percent of the size of the reference, as the paper has it."""
    return 100.0 * (value - reference) / abs(reference)


def differences(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Numbers of the tables beyond the factor, or of another sign than the paper's."""
    out = []
    for row in rows:
        for name, theirs in row["paper"].items():
            ours = row["ours"][name]
            if theirs != 0.0 and not 1.0 / FACTOR <= ours / theirs <= FACTOR:
                entry = {"table": row["table"], "case": row["case"], "quantity": name}
                out.append(entry | {"ours": ours, "paper": theirs, "ratio": ours / theirs})
    return out


def split(found, alpha: float) -> dict[str, Any]:
    """Parts with rotors, without, and what the slipstreams add to each part, derivatives per radian."""
    on, off = found[FULL][alpha]["parts"], found[CLEAN][alpha]["parts"]
    added = {part: {k: on[part][k] - v for k, v in values.items() if k in on[part]} for part, values in off.items()}
    return {"alpha": alpha, "power_on": on, "power_off": off, "slipstream": added, ROTORS: on[ROTORS]}


def _curve(aircraft: Aircraft, known: dict[float, Any]) -> dict[str, list[float]]:
    """Loads over incidence."""
    states = {a: known[a] if a in known else _at(aircraft, a) for a in sorted({*CURVE, *known})}
    loads = [_loads(s) for s in states.values()]
    return {"alpha": list(states), **{k: [row[k] for row in loads] for k in loads[0]}}


def _span(found, alphas) -> list[dict[str, Any]]:
    """Section lift of the whole aircraft's wing, with and without rotors, and the axial force of its strips."""
    out = []
    for a in alphas:
        on, off = found[FULL][a], found[CLEAN][a]
        edges = np.asarray(on["strip_edge"])
        widths = on["dynamic_pressure"] * np.diff(edges)
        row = {"alpha": a, "y": on["y_span"]}
        for name, state in (("on", on), ("off", off)):
            force = np.asarray(state["strip_force"])
            row[f"cz_c_{name}"] = (force[:, 2] / widths).tolist()
            row[f"cx_c_{name}"] = (force[:, 0] / widths).tolist()
        out.append(row)
    return out


def _check(aircraft: Aircraft, alphas: Sequence[float]) -> None:
    """What the comparison needs."""
    needed = {"wing": aircraft.wing is None, "htail": aircraft.htail is None, "rotor": not aircraft.rotor}
    problems = [
        Problem(aircraft.name, part, None, "a part that the comparison takes off") for part, no in needed.items() if no
    ]
    if len(set(alphas)) < 2:
        problems.append(Problem("interaction", "alphas", list(alphas), "two incidences at least"))
    if problems:
        raise InputError(problems)
