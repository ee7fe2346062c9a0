"""The optimisation of Table 7: record, progress, failures, feasibility, multipliers, gain by cause."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash, variable_box
from hera_om.components.base import JaxComponent
from hera_om.core.errors import AnalysisFailure
from hera_om.core.programs import kept
from hera_om.models.cases import GOALS, MDO_GOAL, Goal, Limit, mdo_limits
from hera_om.models.problems import DRIVERS, build_mdo, set_start
from hera_om.models.trimmed import has_box
from hera_om.studies.aero_source import aero_of
from hera_om.studies.optimum import constraint_rows, gain_by_cause, multipliers, variable_rows
from hera_om.studies.record import Record
from hera_om.studies.snapshot import snapshot
from hera_om.studies.values import known_units, number

Progress = Callable[[int, float, float, float], None]

ATTEMPTS = 3  # runs of the driver, the first one included, before failing analyses end a study
SHRINK = 0.5  # of the way back to the best design so far, for the bounds after a failed analysis


def mdo(
    aircraft: Aircraft,
    *,
    driver: str = "SLSQP",
    aero: str = "lattice",
    database: str | Path = "mdo.db",
    start: str = "baseline",
    max_iterations: int | None = None,
    objective: str = MDO_GOAL.name,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Build the problem of Table 7, by default with its objective, and `run` it."""
    source = aero_of(aero, aircraft)
    try:
        problem = build_mdo(aircraft, driver=driver, aero=source, max_iterations=max_iterations, objective=objective)
    except om.AnalysisError as error:
        raise AnalysisFailure(str(error), where="baseline") from error
    options = {"driver": driver, "aero": str(aero), "start": start, **DRIVERS[driver]}
    return run(problem, database=database, start=start, options=options, progress=progress)


def run(
    problem: om.Problem,
    *,
    database: str | Path,
    start: str = "baseline",
    options: dict[str, Any] | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run a problem of `models.build_mdo`, recording everything.

    A SciPy driver does not survive an analysis that fails. When one does, the driver starts again from the
    best design so far, with bounds drawn halfway in towards it, `ATTEMPTS` times in all; what was finished stays
    recorded.

    Args:
        problem: the problem, set up.
        database: file of the record.
        start: where the driver starts, one of `models.cases.STARTS`.
        options: noted in the record.
        progress: called with iteration, objective, worst violation, seconds.

    Returns:
        ``baseline``, ``optimum``, ``constraints``, ``variables``, ``gain``, ``success``, ``feasible``, counts,
        times.

    Raises:
        AnalysisFailure: the baseline cannot be analysed, or all attempts ended in failures.
    """
    problem.final_setup()
    if kept():
        components: Any = problem.model.system_iter(recurse=True, typ=JaxComponent)
        for component in components:
            component.begin_partials()
    aircraft: Aircraft = problem.model.options["aircraft"]
    limits, goal = mdo_limits(has_box(aircraft)), GOALS[next(iter(problem.model.get_objectives()))]
    rows = [
        {"name": x.name, "units": known_units(x.name), "lower": x.lower, "upper": x.upper, "reason": x.reason}
        for x in limits
    ]
    head = {"name": goal.name, "units": known_units(goal.name), "sense": goal.sense}
    with Record(database, kind="mdo", aircraft=aircraft, options=options, constraints=rows, objective=head) as record:
        best = _Best(aircraft, limits, goal)
        record.attach(problem, progress=_ticker(problem, best, progress))
        before = _baseline(problem, aircraft, record)
        best.see(problem)
        set_start(problem, aircraft, start)
        outcome = _drive(problem, aircraft, record, best)
        after = snapshot(aircraft, problem)
        record.snapshot("optimum", after)
        problem.record("optimum")
        result = _result(problem, aircraft, limits, goal, before, after, outcome)
        record.result(result)
    return {"aircraft": aircraft.name, "hash": definition_hash(aircraft), "units": after["units"], **result}


def _ticker(problem: om.Problem, best: "_Best", progress: Progress | None):
    """What happens after every evaluation of the driver: the best design is kept, progress is told."""

    def tick(row: dict[str, Any]) -> None:
        if row["success"]:
            best.see(problem)
        if progress is not None:
            progress(row["iteration"], row["objective"], row["worst_violation"], row["time_s"])

    return tick


def _baseline(problem: om.Problem, aircraft: Aircraft, record: Record) -> dict[str, Any]:
    """Analyse and store the baseline."""
    set_start(problem, aircraft, "baseline")
    try:
        problem.run_model()
    except om.AnalysisError as error:
        raise AnalysisFailure(str(error), where="baseline") from error
    found = snapshot(aircraft, problem)
    record.snapshot("baseline", found)
    problem.record("baseline")
    return found


class _Best:
    """The best design that the history of a run holds: least violated, then best objective."""

    def __init__(self, aircraft: Aircraft, limits: tuple[Limit, ...], goal: Goal) -> None:
        self.box, self.limits, self.goal = variable_box(aircraft), limits, goal.name
        self.sign = 1.0 if goal.sense == "max" else -1.0
        self.rank: tuple[float, float] | None = None
        self.values: list[float] = []
        self.states = np.zeros(0)

    def see(self, problem: om.Problem) -> None:
        """Compare the design a problem stands at."""
        worst = min((row["margin"] for row in constraint_rows(problem, self.limits).values()), default=0.0)
        rank = (min(worst, 0.0), self.sign * number(problem, self.goal))
        if self.rank is None or rank > self.rank:
            self.rank = rank
            self.values = [number(problem, n, u) for n, u in zip(self.box.names, self.box.units, strict=True)]
            self.states = _outputs(problem).asarray(copy=True)

    def go(self, problem: om.Problem) -> None:
        """Put a problem there, its states too: those of a failed solve may be no start for the next one."""
        _outputs(problem).set_val(self.states)
        for n, u, v in zip(self.box.names, self.box.units, self.values, strict=True):
            problem.set_val(n, v, units=u)


def _outputs(problem: om.Problem) -> Any:
    """Vector of all outputs of a problem, its variables among them."""
    return problem.model._outputs


def _drive(problem: om.Problem, aircraft: Aircraft, record: Record, best: _Best) -> dict[str, Any]:
    """Run the driver, again after a failed analysis from the best design in a smaller box; count all attempts."""
    failures: list[str] = []
    driver: Any = problem.driver
    spent, begun = {"iterations": 0, "evaluations": 0, "gradients": 0}, perf_counter()
    while True:
        error = _attempt(problem, spent)
        if error is None:
            break
        failures.append(str(error))
        record.note("failures", failures)
        if len(failures) == ATTEMPTS:
            text = f"{ATTEMPTS} attempts ended in failed analyses; the last: {error}"
            raise AnalysisFailure(text, where="mdo") from error
        best.go(problem)
        _shrink(problem, best)
    return {
        "success": bool(driver.result.success),
        "message": getattr(driver, "message", str(driver.result.exit_status)),
        **spent,
        "seconds": perf_counter() - begun,
        "failures": failures,
    }


def _attempt(problem: om.Problem, spent: dict[str, int]) -> om.AnalysisError | None:
    """Run the driver once and add what it spent; the analysis that failed, if one did."""
    driver: Any = problem.driver
    try:
        problem.run_driver()
    except om.AnalysisError as error:
        return error
    finally:
        done = driver.result
        spent["iterations"] += int(done.iter_count)
        spent["evaluations"] += int(done.model_evals)
        spent["gradients"] += int(done.deriv_evals)
    return None


def _shrink(problem: om.Problem, best: _Best) -> None:
    """Draw the bounds of the driver's variables halfway in towards the best design."""
    for i, (name, value) in enumerate(zip(best.box.names, best.values, strict=True)):
        low = value + SHRINK * (best.box.lower[i] - value)
        high = value + SHRINK * (best.box.upper[i] - value)
        problem.model.set_design_var_options(name, lower=low, upper=high)
    problem.final_setup()


def _result(problem: om.Problem, aircraft: Aircraft, limits, goal: Goal, before, after, outcome) -> dict[str, Any]:
    """Everything that is said of a finished run."""
    constraints, variables = constraint_rows(problem, limits), variable_rows(problem, aircraft)
    optimality = multipliers(problem, aircraft, goal, constraints, variables)
    feasible = not any(row["violated"] for row in constraints.values())
    old, new = before["values"], after["values"]
    return {
        "baseline": old,
        "optimum": new,
        "constraints": constraints,
        "variables": variables,
        "optimality": optimality,
        "feasible": feasible and bool(np.isfinite(new[goal.name])),
        "gain": gain_by_cause(old, new),
        **outcome,
    }
