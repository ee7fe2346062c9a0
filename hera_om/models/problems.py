"""Problems: one builder a case, the same problem for every driver."""

import warnings

import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.paths import variable_box
from hera_om.components.mass import MassProperties
from hera_om.components.trim import TrimResiduals, narrowed, start_values
from hera_om.components.wingbox import frozen_remainder
from hera_om.models.cases import (
    GOALS,
    MDO_GOAL,
    STARTS,
    TRIM_BALANCE,
    TRIM_GOAL,
    Goal,
    Limit,
    mdo_limits,
    table_4,
)
from hera_om.models.trimmed import (
    Aero,
    TrimmedAircraft,
    aero_variables,
    aerodynamics,
    has_box,
    known_box,
    wing_structure,
)

# COBYLA first moves by a fifth of each variable's range; SLSQP stops when the scaled objective settles.
DRIVERS = {
    "SLSQP": {"tol": 1e-7, "maxiter": 60, "opt_settings": {}},
    "COBYLA": {"tol": 1e-4, "maxiter": 400, "opt_settings": {"rhobeg": 0.2, "catol": 1e-5}},
}


def build_aircraft(aircraft: Aircraft, *, aero: Aero = "lattice") -> om.Problem:
    """The trimmed aircraft as a problem, set up, with the wing's remainder frozen at the baseline."""
    remainder = baseline_remainder(aircraft, aero=aero) if has_box(aircraft) else 0.0
    problem = om.Problem(TrimmedAircraft(aircraft=aircraft, aero=aero, remainder=remainder), reports=False)
    _set_up(problem)
    return problem


def build_mdo(
    aircraft: Aircraft,
    *,
    driver: str = "SLSQP",
    aero: Aero = "lattice",
    max_iterations: int | None = None,
    start: str = "baseline",
    objective: str = MDO_GOAL.name,
) -> om.Problem:
    """The problem of Table 7: its variables, range, flying qualities, reserve factors, with the trim inside.

    Args:
        aircraft: a definition with variables, masses, a mission, and rotors or not.
        driver: ``SLSQP`` or ``COBYLA``.
        aero: ``lattice`` or a SurrogateSet.
        max_iterations: of the driver; absent: see `DRIVERS`.
        start: one of `cases.STARTS`.
        objective: one of `cases.GOALS`.

    Returns:
        An OpenMDAO problem, set up, its variables at the start.

    Raises:
        ValueError: the definition lacks a part that the case needs, or an argument is not among the choices.
    """
    _require(aircraft, "mdo", variables=aircraft.variables, mass=aircraft.mass, mission=aircraft.mission)
    if objective not in GOALS:
        raise ValueError(f"objective {objective!r}: expected one of {', '.join(GOALS)}")
    problem = build_aircraft(aircraft, aero=aero)
    box = variable_box(aircraft)
    for i, n in enumerate(box.names):
        problem.model.add_design_var(n, lower=box.lower[i], upper=box.upper[i], units=box.units[i])
    _add_goals(problem, GOALS[objective], mdo_limits(has_box(aircraft)))
    problem.driver = make_driver(driver, max_iterations)
    _set_up(problem)
    set_start(problem, aircraft, start)
    return problem


def build_trim(aircraft: Aircraft, *, aero: Aero = "lattice", load_factor: float = 1.0) -> om.Problem:
    """The problem of Table 4: incidence, elevator, blade pitch for three balances and the best L/D."""
    _require(aircraft, "trim", mass=aircraft.mass)
    model = om.Group()
    model.add_subsystem("mass_properties", MassProperties(aircraft=aircraft), promotes=["*"])
    variables = aero_variables(aircraft)
    point = ["x_cg", "z_cg", "mach", "altitude", "q_hat", "load_factor", *variables, *start_values(aircraft)]
    if not _has_elevator(aircraft):
        point = [n for n in point if n != "delta_e"]
    model.add_subsystem("aero", aerodynamics(aircraft, aero), promotes_inputs=point, promotes_outputs=["*"])
    model.add_subsystem(
        "balance",
        TrimResiduals(aircraft=aircraft),
        promotes_inputs=["*", ("mass", "mass_cruise")],
        promotes_outputs=["*"],
    )
    model.set_input_defaults("load_factor", val=load_factor)
    for state, (low, high) in narrowed(table_4(aircraft), known_box(aero)).items():
        model.add_design_var(state, lower=low, upper=high, units="deg")
    problem = om.Problem(model, reports=False)
    problem.driver = make_driver("SLSQP", None)
    limits = [Limit(f"balance_{axis}", 0.0, 0.0, "equilibrium") for axis in _axes(aircraft)]
    _add_goals(problem, TRIM_GOAL, limits, equality_ref=TRIM_BALANCE * 100)
    for rotor in aircraft.rotor:
        if rotor.shaft_power_max_W is not None:
            limit = rotor.shaft_power_max_W
            model.add_constraint(f"power_{rotor.name}", upper=limit, ref=limit, units="W")
    _set_up(problem)
    return problem


def baseline_remainder(aircraft: Aircraft, *, aero: Aero = "lattice") -> float:
    """Frozen part of the wing's mass, kg: the definition's, or what the sized baseline leaves of its total."""
    box = wing_structure(aircraft)
    if box.mass_remainder_kg is not None:
        return box.mass_remainder_kg
    problem = om.Problem(TrimmedAircraft(aircraft=aircraft, aero=aero, close_mass=False), reports=False)
    _set_up(problem)
    problem.set_val("m_wing", box.mass_total_baseline_kg, units="kg")
    problem.run_model()
    return frozen_remainder(aircraft, float(problem.get_val("wing_box.m_wing", units="kg")[0]))


class ScipyDriver(om.ScipyOptimizeDriver):
    """OpenMDAO's driver, but it stops at an analysis that fails.

    The original hands SciPy an objective of zero instead, goes on to the end, and raises only then.
    """

    @property
    def message(self) -> str:
        """What SciPy said at the end of the last run."""
        result = self._scipy_optimize_result
        return "" if result is None else str(result.message)

    def _objfunc(self, x_new):
        """Objective at a point."""
        return self._checked(super()._objfunc(x_new))

    def _gradfunc(self, x_new):
        """Gradient at a point."""
        return self._checked(super()._gradfunc(x_new))

    def _checked(self, value):
        """A value, unless the exception behind it waits to be raised."""
        if self._exc_info is not None:
            self._reraise()
        return value


def make_driver(name: str, max_iterations: int | None) -> om.ScipyOptimizeDriver:
    """A SciPy driver on variables scaled to their bounds."""
    if name not in DRIVERS:
        raise ValueError(f"driver {name!r}: expected one of {', '.join(DRIVERS)}")
    known = DRIVERS[name]
    driver = ScipyDriver(optimizer=name, tol=known["tol"], disp=False)
    driver.options["maxiter"] = max_iterations or known["maxiter"]
    driver.opt_settings.update(known["opt_settings"])
    driver.autoscaler = om.BoundsAutoscaler()
    return driver


def set_start(problem: om.Problem, aircraft: Aircraft, start: str) -> None:
    """Put the variables at the baseline or at a share of their ranges."""
    if start not in STARTS:
        raise ValueError(f"start {start!r}: expected one of {', '.join(STARTS)}")
    share, box = STARTS[start], variable_box(aircraft)
    for i, n in enumerate(box.names):
        value = box.baseline[i] if share is None else box.lower[i] + share * (box.upper[i] - box.lower[i])
        problem.set_val(n, value, units=box.units[i])


def _add_goals(problem: om.Problem, goal: Goal, limits, equality_ref: float | None = None) -> None:
    """Objective and constraints, scaled by their bounds."""
    sign = -1.0 if goal.sense == "max" else 1.0
    problem.model.add_objective(goal.name, ref=sign * goal.ref)
    for limit in limits:
        if limit.lower == limit.upper:
            problem.model.add_constraint(limit.name, equals=limit.lower, ref=equality_ref)
            continue
        ref = max(abs(b) for b in (limit.lower, limit.upper) if b is not None)
        bounds = {k: v for k, v in (("lower", limit.lower), ("upper", limit.upper)) if v is not None}
        problem.model.add_constraint(limit.name, ref=ref, **bounds)


def _set_up(problem: om.Problem) -> None:
    """Set up quietly, in the mode with fewer passes."""
    # Newton's method inside a trim makes OpenMDAO count the whole model as one: so it is meant.
    warnings.filterwarnings("ignore", category=om.OpenMDAOWarning, message=".*nonlinear solver that computes gradients")
    problem.setup(mode="auto")
    problem.set_solver_print(level=-1)


def _has_elevator(aircraft: Aircraft) -> bool:
    """Whether there is an elevator."""
    return aircraft.htail is not None and aircraft.htail.control.elevator is not None


def _axes(aircraft: Aircraft) -> list[str]:
    """Balances of the Table 4 problem."""
    return ["z", *(["m"] if _has_elevator(aircraft) else []), *(["x"] if aircraft.rotor else [])]


def _require(aircraft: Aircraft, case: str, **parts) -> None:
    """Complain about parts that the case needs and the definition lacks."""
    missing = [name for name, part in parts.items() if not part]
    if missing:
        raise ValueError(f"{case} of {aircraft.name!r} needs {', '.join(missing)} in its definition")
