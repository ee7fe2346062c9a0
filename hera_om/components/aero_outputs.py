"""Results of the aerodynamics by the names that the component gives them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from hera_om.components.aero_plan import PARTS, PARTS_BY, AeroPlan
from hera_om.physics.aero_cases import Body
from hera_om.physics.aerodynamics import AeroResult
from hera_om.physics.coupling import Setting, System

Values = dict[str, Any]


def named(aircraft, statics: AeroPlan, at: Setting, body: Body, result: AeroResult) -> Values:
    """Outputs of the component by name."""
    out = _coefficients(statics, result) | _drag(aircraft, result, body, at.flow) | _air(result, at.flow, body)
    if at.rotors is not None:
        out |= _rotor_outputs(statics, result, at.rotors, at.flow)
    if aircraft.wing is not None:
        out |= _wing_outputs(at.system, result, at.flow)
    return out


def _coefficients(statics: AeroPlan, result: AeroResult) -> Values:
    """Coefficients and their derivatives, angles per radian."""
    out: Values = {name: getattr(result.total, name) for name in statics.coefficients}
    out["L_over_D"] = result.total.CL / jnp.where(result.total.CD == 0, 1.0, result.total.CD)
    for name in statics.coefficients:
        row = getattr(result.derivatives, name)
        out |= {f"{name}_{by}": row[i] for i, by in enumerate(statics.columns)}
        rates = {"alphadot": result.alphadot, "betadot": result.betadot}
        out |= {f"{name}_{by}": getattr(rates[by], name) for by in statics.by if by in rates}
    for name in statics.split:
        out |= {f"{name}_{PARTS}": getattr(result.parts, name), f"{name}_{PARTS_BY}": getattr(result.parts_by, name)}
    return out


def _drag(aircraft, result: AeroResult, body, flow) -> Values:
    """Drag build-up; the fuselage stands first among the areas, the fin counts as profile drag."""
    parts = result.drag
    free = body.drag.area / body.S
    index = 0
    fuselage = fin = jnp.zeros(())
    if aircraft.fuselage is not None:
        fuselage, index = free[0], 1
    if aircraft.vtail is not None and aircraft.vtail.polar is not None:
        fin = free[index]
    return {
        "CDi": parts.CDi,
        "CDi_near": parts.CDi_near,
        "CD_slipstream": parts.CD_slipstream,
        "CD_profile": parts.CD_profile + fin,
        "CD_fuselage": fuselage,
        "CD_areas": parts.CD_areas - fuselage - fin,
    }


def _air(result: AeroResult, flow, body: Body) -> Values:
    """Stream and stall margin."""
    q = 0.5 * flow.density * flow.speed**2
    out = {
        "dynamic_pressure": q,
        "speed": flow.speed,
        "density": flow.density,
        "q_S": q * body.S,
    }
    if result.stall is not None:
        out |= {"lift_margin": result.stall.margin, "lift_margin_smooth": result.stall.smooth}
        out |= {"stall_surface": result.stall.surface.astype(float), "stall_y": result.stall.y}
    return out | {"coupling_residual": result.residual}


def _rotor_outputs(statics: AeroPlan, result: AeroResult, rotors, flow) -> Values:
    """Means of each group over its rotors that run, on both sides, and sums over all rotors, failed ones included.

    Of a group without any that runs, thrust and power are the means of all and the coefficients are zero.
    """
    r, plan, starboard = result.loads.every, statics.rotors, result.loads.rotors
    assert r is not None and plan is not None and starboard is not None
    halves = r.thrust.shape[0]
    advance = jnp.where(r.CP == 0, 0.0, r.CT / jnp.where(r.CP == 0, 1.0, r.CP)) * (
        flow.speed * np.pi / (rotors.omega * rotors.radius)
    )
    out = {"thrust": plan.sides / halves * jnp.sum(r.thrust), "power": plan.sides / halves * jnp.sum(r.power)}
    families = {"thrust": r.thrust, "power": r.power, "CT": r.CT, "CP": r.CP, "eta": advance}
    for i, name in enumerate(statics.groups):
        running = statics.running(i, halves)
        members = np.array(running or statics.members(i))
        means = {family: jnp.mean(values.ravel()[members]) for family, values in families.items()}
        if not running:
            means |= {family: jnp.zeros(()) for family in ("CT", "CP", "eta")}
        out |= {f"{family}_{name}": value for family, value in means.items()}
    return out | {"rotor_hub": rotors.hub, "rotor_force": starboard.force, "rotor_moment": starboard.moment}


def _wing_outputs(system: System, result: AeroResult, flow) -> Values:
    """Section lift and dimensional loads of the wing's strips."""
    q = 0.5 * flow.density * flow.speed**2
    assert system.wing_edges is not None
    ns = system.wing_edges.shape[0] - 1
    wing = jax.tree.map(lambda v: v[:ns], result.loads.surfaces)
    return {
        "cl_span": result.cl_strips[:ns],
        "y_span": wing.point[:, 1],
        "strip_edge": system.wing_edges,
        "strip_point": wing.point,
        "strip_force": q * wing.force,
        "strip_moment": q * wing.moment,
    }
