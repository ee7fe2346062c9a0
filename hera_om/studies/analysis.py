"""One flight condition, not trimmed: coefficients, derivatives, rotors; stability when there are masses."""

from typing import Any

import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash
from hera_om.components.aero import Aerodynamics
from hera_om.components.aero_plan import PARTS, PARTS_BY, AeroPlan
from hera_om.components.arrays import reference
from hera_om.components.mass import MassProperties
from hera_om.components.stability import Stability
from hera_om.core.errors import AnalysisFailure
from hera_om.studies.values import collect


def analyze(aircraft: Aircraft) -> dict[str, Any]:
    """Analyse a definition at its ``[flight]`` condition; any part may be absent.

    Moments are about the definition's reference point, else the centre of gravity, else the quarter of the mean
    aerodynamic chord. Flying qualities need them about the centre of gravity: a reference point leaves them out.

    Returns:
        ``aircraft``, ``hash``, ``units``, registry names with their values, and ``parts``: the same coefficients
        and derivatives of every lifting surface, of the fuselage with all drag areas, and of the rotors' hub loads.

    Raises:
        AnalysisFailure: no finite or no converged solution.
    """
    problem = om.Problem(reports=False)
    fixed_point = aircraft.reference.x_m is not None
    if aircraft.mass:
        outputs = [("x_cg", "x_cg_mass"), ("z_cg", "z_cg_mass"), "mass*", "I*"] if fixed_point else ["*"]
        mass = MassProperties(aircraft=aircraft)
        problem.model.add_subsystem("mass_properties", mass, promotes_inputs=["*"], promotes_outputs=outputs)
    aero = Aerodynamics(aircraft=aircraft, lateral=True)
    problem.model.add_subsystem("aero", aero, promotes=["*"])
    if aircraft.mass and aircraft.wing is not None and not fixed_point:
        problem.model.add_subsystem("stability", Stability(aircraft=aircraft), promotes=["*"])
        problem.model.set_input_defaults("alpha", val=aircraft.flight.alpha_deg, units="deg")
    problem.setup()
    problem.set_solver_print(level=-1)
    try:
        problem.run_model()
    except om.AnalysisError as error:
        raise AnalysisFailure(str(error), where="analyze") from error
    values, units = collect(problem)
    if "x_np" not in values and values.get("CZ_alpha") and (aircraft.wing is not None or aircraft.surface):
        chord = reference(aircraft)[1]
        values["x_np"] = values["x_cg"] - float(chord) * values["Cm_alpha"] / values["CZ_alpha"]
        units["x_np"] = "m"
    parts = by_part(values, aero.statics)
    return {"aircraft": aircraft.name, "hash": definition_hash(aircraft), "units": units, **values, "parts": parts}


def by_part(values: dict[str, Any], plan: AeroPlan) -> dict[str, dict[str, float]]:
    """Take the arrays of the parts out of the values: coefficients and derivatives by the name of the part."""
    out: dict[str, dict[str, float]] = {name: {} for name in plan.parts}
    for c in plan.split:
        rows = zip(plan.parts, values.pop(f"{c}_{PARTS}"), values.pop(f"{c}_{PARTS_BY}"), strict=True)
        for part, value, slopes in rows:
            out[part] |= {c: value} | {f"{c}_{by}": v for by, v in zip(plan.columns, slopes, strict=True)}
    return out
