"""What pictures and tables need of one design, taken once and stored in the record."""

from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.aircraft import Aircraft, replace_numbers
from hera_om.components import arrays
from hera_om.components.aero import Aerodynamics
from hera_om.physics.geometry import surface_mesh
from hera_om.studies.values import collect

BOX = (
    "t_skin_upper",
    "t_skin_lower",
    "t_web_front",
    "t_web_rear",
    "RFC_span",
    "RFT_span",
    "bending",
    "shear",
    "torsion",
)


def snapshot(aircraft: Aircraft, problem: om.Problem) -> dict[str, Any]:
    """Values, units and arrays of the design that a problem stands at."""
    values, units = collect(problem)
    extra, _ = collect(problem, "pullup.")
    design = at_design(aircraft, values)
    scalars = {k: v for k, v in values.items() if not isinstance(v, list)}
    scalars |= {f"pullup.{k}": v for k, v in extra.items() if not isinstance(v, list)}
    return {"values": scalars, "units": units, "arrays": _arrays(aircraft, design, values)}


def at_design(aircraft: Aircraft, values: dict[str, Any]) -> Aircraft:
    """The definition with the design variables at these values."""
    return replace_numbers(aircraft, {v.path: values[v.name] for v in aircraft.variables if v.name in values})


def _arrays(aircraft: Aircraft, design: Aircraft, values: dict[str, Any]) -> dict[str, Any]:
    """Planform, rotors, span loads with and without slipstream, pressures, wing box, masses."""
    out: dict[str, Any] = {"mass_items": _items(design, values)}
    if design.wing is not None:
        sections = arrays.wing_arrays(design)
        out["wing_outline"] = _outline(sections)
        out["y_span"], out["cl_span"] = values["y_span"], values["cl_span"]
        out["chord_span"] = np.interp(values["y_span"], sections.y, sections.chord).tolist()
    if design.htail is not None:
        out["htail_outline"] = _outline(
            next(arrays.sections_of(s) for s in arrays.parts(design, False) if s.name == "htail")
        )
    if arrays.parts(design, False):
        out["pressure"] = panel_pressures(aircraft, design, values)
    rotors = arrays.rotors(design)
    if rotors is not None:
        out["rotors"] = np.column_stack([rotors.hub, rotors.radius]).tolist()
        if design.wing is not None:
            out["cl_span_off"] = _without_rotors(aircraft, values).get_val("cl_span").tolist()
    if "box_y" in values:
        y = np.asarray(values["box_y"])
        out["box"] = {k: values[k] for k in BOX if k in values}
        out["box"] |= {"y": y.tolist(), "eta": (y / sections.y[-1]).tolist()}
    return out


def _outline(sections) -> list[list[float]]:
    """Leading edge outwards, trailing edge back: the starboard half seen from above."""
    lead = np.column_stack([sections.x_le, sections.y])
    trail = lead + np.column_stack([sections.chord, np.zeros(len(lead))])
    return np.vstack([lead, trail[::-1]]).tolist()


def _items(design: Aircraft, values: dict[str, Any]) -> dict[str, float]:
    """Mass of every item of this design, kg."""
    out = {}
    for item in design.mass:
        mass = item.m_kg
        if item.tracks == "wing":
            mass = values.get("m_wing", mass)
        elif item.tracks == "fuel":
            mass = values.get("mass_fuel", mass)
        elif item.tracks in ("htail", "vtail"):
            mass = mass * getattr(design, item.tracks).scale ** 2
        out[item.name] = float(mass)
    return out


def panel_pressures(aircraft: Aircraft, design: Aircraft, values: dict[str, Any]) -> list[dict[str, Any]]:
    """Corner points of the panels of each surface, m, and the pressure differences on their bound lines.

    Args:
        aircraft: the definition, whose panels keep their shares.
        design: the same at the design that the values belong to.
        values: state and design variables.

    Returns:
        By surface ``name``, ``corners`` [nc + 1, ns + 1, 3], ``pressure`` [nc, ns] over dynamic pressure, positive
        where it lifts; starboard half.
    """
    model: Any = _alone(aircraft, values).model
    out, start, shape = [], 0, arrays.model(aircraft, False).shape
    surfaces = arrays.surfaces(design, arrays.grids(aircraft))
    for part, surface in zip(arrays.parts(design, False), surfaces, strict=True):
        corners = np.asarray(surface_mesh(surface.sections, surface.grid, shape))
        nc, ns = corners.shape[0] - 1, corners.shape[1] - 1
        found = model.aero.pressure[0, start : start + nc * ns].reshape(nc, ns)
        out.append({"name": part.name, "corners": corners.tolist(), "pressure": found.tolist()})
        start += nc * ns
    return out


def _without_rotors(aircraft: Aircraft, values: dict[str, Any]) -> om.Problem:
    """The same state with the rotors taken off."""
    kept = tuple(v for v in aircraft.variables if not v.path.startswith("rotor."))
    clean = tuple(d.model_copy(update={"rotor": None}) for d in aircraft.drag_area)
    return _alone(aircraft.model_copy(update={"rotor": (), "drag_area": clean, "variables": kept}), values)


def _alone(aircraft: Aircraft, values: dict[str, Any]) -> om.Problem:
    """The aerodynamics by themselves at these values."""
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft), promotes=["*"])
    problem.setup()
    known = {m["prom_name"] for m in problem.model.get_io_metadata(iotypes=("input",)).values()}
    for name in known & values.keys():
        problem.set_val(name, values[name])
    problem.run_model()
    return problem
