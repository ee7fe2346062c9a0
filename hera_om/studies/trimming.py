"""Steady flight, by the implicit solve or by the optimisation of Table 4."""

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash
from hera_om.components.mass import MassProperties
from hera_om.components.stability import Stability
from hera_om.components.trim import narrowed, state_bounds
from hera_om.core.errors import AnalysisFailure
from hera_om.models.cases import TRIM_BALANCE, TRIM_GOAL, table_4
from hera_om.models.problems import build_trim
from hera_om.models.trim_solver import saturated
from hera_om.models.trimmed import TrimPoint, known_box
from hera_om.studies.aero_source import aero_of
from hera_om.studies.record import Record
from hera_om.studies.snapshot import snapshot
from hera_om.studies.values import collect

Progress = Callable[[int, float, float, float], None]


def trim(
    aircraft: Aircraft,
    *,
    method: str = "solve",
    aero: str = "lattice",
    load_factor: float = 1.0,
    database: str | Path | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Trim an aircraft in level flight at a load factor.

    Args:
        aircraft: a definition with masses.
        method: ``solve`` (implicit, the split of thrust as in the design thrusts) or ``SLSQP`` (Table 4: four
            variables, three balances, best L/D).
        aero: ``lattice`` or a surrogate's file.
        load_factor: load factor.
        database: file of the record; absent: none.
        progress: called with iteration, objective, worst violation, seconds.

    Returns:
        ``trimmed``, ``saturated`` (states at a bound), ``values``, ``units``, ``bounds``, ``residuals``.

    Raises:
        AnalysisFailure: there is no solution and no control is at its limit.
        ValueError: the definition lacks masses, or the method is unknown.
    """
    if method not in ("solve", "SLSQP"):
        raise ValueError(f"method {method!r}: expected 'solve' or 'SLSQP'")
    source = aero_of(aero, aircraft)
    record = _record(database, aircraft, method, load_factor)
    with record or nullcontext():
        run = _solve if method == "solve" else _optimise
        result, problem = run(aircraft, source, load_factor, record, progress)
        if record is not None:
            record.snapshot("optimum", snapshot(aircraft, problem))
            record.result({"optimum": result["values"], "success": result["trimmed"], "feasible": result["trimmed"]})
    return {"aircraft": aircraft.name, "hash": definition_hash(aircraft), "method": method, **result}


def _record(database, aircraft: Aircraft, method: str, load_factor: float) -> Record | None:
    """The record of a trim, if one is wanted."""
    if database is None:
        return None
    rows = [
        {"name": n, "path": n, "units": "deg", "lower": low, "baseline": 0.0, "upper": high}
        for n, (low, high) in table_4(aircraft).items()
    ]
    goal = {"name": TRIM_GOAL.name, "units": None, "sense": TRIM_GOAL.sense}
    options = {"driver": method, "load_factor": load_factor}
    return Record(database, kind="trim", aircraft=aircraft, options=options, variables=rows, objective=goal)


def _solve(aircraft: Aircraft, source, load_factor: float, record, progress):
    """Newton's method inside the analysis."""
    problem = om.Problem(reports=False)
    model = problem.model
    model.add_subsystem("mass_properties", MassProperties(aircraft=aircraft), promotes=["*"])
    point = TrimPoint(aircraft=aircraft, aero=source, powered=bool(aircraft.rotor), load_factor=float(load_factor))
    model.add_subsystem("cruise", point, promotes_inputs=["*", ("mass", "mass_cruise")], promotes_outputs=["*"])
    stability = Stability(aircraft=aircraft)
    model.add_subsystem("stability", stability, promotes=["*"])
    problem.setup()
    problem.set_solver_print(level=-1)
    trimmed = True
    if record is not None:
        record.attach(problem)
    try:
        problem.run_model()
    except om.AnalysisError as error:
        trimmed = False
        if not saturated(point.balance):
            raise AnalysisFailure(str(error), where="trim") from error
    bounds = narrowed(state_bounds(aircraft, bool(aircraft.rotor)), known_box(source))
    left = {n: float(v[0]) for n, v in _residuals(point.balance).items()}
    result = _result(problem, trimmed, saturated(point.balance), bounds, left)
    if not trimmed:  # what follows the trim has not run
        result["values"] = {k: v for k, v in result["values"].items() if k not in stability._var_rel_names["output"]}
    return result, problem


def _residuals(balance) -> dict[str, Any]:
    """Balances by the state that closes them."""
    balance.run_apply_nonlinear()
    return {n: balance._residuals[n] for n in balance.equilibrium.states}


def _optimise(aircraft: Aircraft, source, load_factor: float, record, progress):
    """The problem of Table 4."""
    problem = build_trim(aircraft, aero=source, load_factor=load_factor)
    if record is not None:
        record.attach(problem)
    try:
        done = problem.run_driver()
    except om.AnalysisError as error:
        raise AnalysisFailure(str(error), where="trim") from error
    values, _ = collect(problem)
    left = {n: v for n, v in values.items() if n.startswith("balance_")}
    bounds = narrowed(table_4(aircraft), known_box(source))
    stuck = [n for n, (low, high) in bounds.items() if min(values[n] - low, high - values[n]) < 1e-6]
    closed = all(abs(v) < TRIM_BALANCE for v in left.values())
    if progress is not None:
        progress(int(done.iter_count), values[TRIM_GOAL.name], max(map(abs, left.values())), float(done.runtime))
    result = _result(problem, closed, stuck, bounds, left)
    return result | {"iterations": int(done.iter_count), "evaluations": int(done.model_evals)}, problem


def _result(problem: om.Problem, trimmed: bool, stuck: list[str], bounds, left) -> dict[str, Any]:
    """What a trim returns."""
    values, units = collect(problem)
    values = {k: v for k, v in values.items() if not isinstance(v, list)}
    limits = {k: list(v) for k, v in bounds.items()}
    return {
        "trimmed": trimmed,
        "saturated": stuck,
        "values": values,
        "units": units,
        "bounds": limits,
        "residuals": left,
    }
