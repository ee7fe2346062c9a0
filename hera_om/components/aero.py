"""Lattice and rotors as one component: meshes and slipstreams never cross its border."""

from collections import OrderedDict
from functools import lru_cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from hera_om.components import arrays
from hera_om.components.base import JaxComponent, Values, fill_partials
from hera_om.components.structure import Structure
from hera_om.physics.aerodynamics import AeroResult, evaluate
from hera_om.physics.coupling import Controls, System, make_system
from hera_om.physics.geometry import CAMBER

RAD = np.pi / 180
COEFFICIENTS = ("CL", "CD", "CX", "CZ", "Cm")
GEOMETRY = ("wing", "htail", "lattice")  # what the factorised system reads, beside the disks and the Mach number
STATE_INPUTS = ("alpha", "q_hat", "delta_e", "altitude", "x_cg", "z_cg")  # never change the system; nor does blade pitch


class Aerodynamics(JaxComponent):
    """Coefficients, drag build-up, power-on derivatives and loads at one flight condition.

    Evaluation has two stages: assembly and factorisation, which read geometry and Mach number, are kept while those
    stand still; the state (incidence, rates, controls, blade pitch, altitude, moment point) is then cheap. While
    `states_only` is set, partials by anything else are left as they were: Newton's method needs only those by states.
    """

    READS = ("wing.section", "wing.x_le_root_m", "wing.z_root_m", "wing.incidence_deg", "wing.polar", "htail", "vtail")
    READS += ("fuselage", "drag_area", "rotor", "blade", "reference", "flight")
    states_only = False

    def declare(self) -> None:
        """Condition and controls in; coefficients, derivatives, rotors and loads out."""
        aircraft = self.options["aircraft"]
        self.groups = tuple(r.name for r in aircraft.rotor)
        self.statics = AeroPlan(aircraft)
        self.constants = tuple(arrays.grids(aircraft))
        point = np.asarray(arrays.moment_point(aircraft))
        flight = aircraft.flight
        defaults = {"alpha": flight.alpha_deg, "q_hat": flight.q_hat, "delta_e": flight.delta_e_deg, "mach": flight.mach}
        defaults |= {"altitude": flight.altitude_m, "x_cg": point[0], "z_cg": point[2]}
        defaults |= {f"theta_{r.name}": r.beta75_deg for r in aircraft.rotor}
        for name, value in defaults.items():
            self.add(name, val=value)
        for name, shape in self.statics.outputs(aircraft).items():
            self.add(name, shape=shape, **_TEXTS.get(name, {}))

    @staticmethod
    def evaluate(aircraft, statics: "AeroPlan", constants, inputs: Values) -> Values:
        """Both stages at once."""
        system = _system(aircraft, statics, constants, inputs)
        return _outputs(aircraft, statics, constants, system, inputs)

    def compute(self, inputs, outputs) -> None:
        """Assemble if geometry or Mach number have moved, then evaluate the state."""
        values = self.values(inputs)
        _, state, _, _ = _stages()
        out = state(*self._static(), self.base, self.constants, self._assembled(values), values)
        self.store(out, outputs)

    def compute_partials(self, inputs, partials) -> None:
        """By the state from the kept system; by geometry through the assembly as well, unless `states_only`."""
        values = self.values(inputs)
        names = tuple(sorted(self._var_rel_names["output"]))
        fixed = self._fixed_names()
        moving = tuple(n for n in sorted(values) if n not in fixed)
        _, _, by_state, by_all = _stages()
        system = self._assembled(values)
        args = (*self._static(), names)
        columns = by_state(*args, moving, self.base, self.constants, system, values)
        self._fill(partials, columns, names, moving)
        if fixed and not self.states_only:
            self._fill(partials, by_all(*args, fixed, self.base, self.constants, values), names, fixed)

    def _fill(self, partials, matrix, names, wrt) -> None:
        """Blocks of some columns."""
        fill_partials(partials, np.asarray(matrix), names, {n: np.zeros(1) for n in wrt}, self._outputs)

    def _fixed_names(self) -> tuple[str, ...]:
        """Inputs that the factorised system depends on."""
        reads = [n for n, path in self.paths.items() if path.split(".")[0] in (*GEOMETRY, "rotor", "blade", "flight")]
        return tuple(sorted([*reads, "mach"]))

    def _static(self) -> tuple[Any, ...]:
        return self.structure, self.statics, tuple(self.paths.items())

    def _assembled(self, values: Values) -> System:
        """The factorised system of these inputs, from the last few kept."""
        read = {n: float(values[n]) for n in self._fixed_names()}
        key = (self.structure, self.statics, self.base.tobytes(), tuple(read.items()))
        if key not in _systems:
            assemble, _, _, _ = _stages()
            _systems[key] = assemble(*self._static(), self.base, self.constants, values)
            while len(_systems) > KEPT:
                _systems.popitem(last=False)
        _systems.move_to_end(key)
        return _systems[key]


KEPT = 4
_systems: OrderedDict[Any, System] = OrderedDict()


class AeroPlan:
    """Hashable statics of the aerodynamics of an aircraft."""

    def __init__(self, aircraft, shape: str = CAMBER) -> None:
        self.rotors = arrays.plan(aircraft)
        self.groups = tuple(r.name for r in aircraft.rotor)
        self.tail = 1 if aircraft.wing is not None and aircraft.htail is not None else None
        self.elevator = aircraft.htail is not None and aircraft.htail.control.elevator is not None
        self.shape = shape

    def _key(self):
        return self.rotors, self.groups, self.tail, self.elevator, self.shape

    def __hash__(self) -> int:
        """Hash of the statics."""
        return hash(self._key())

    def __eq__(self, other: object) -> bool:
        """Equal statics."""
        return isinstance(other, AeroPlan) and self._key() == other._key()

    def outputs(self, aircraft) -> dict[str, tuple[int, ...]]:
        """Names and shapes of the outputs."""
        scalars = [*COEFFICIENTS, "L_over_D", "CDi", "CDi_near", "CD_slipstream", "CD_profile", "CD_fuselage", "CD_areas"]
        scalars += ["lift_margin", "dynamic_pressure", "speed", "density"]
        scalars += [f"{c}_{by}" for c in COEFFICIENTS for by in self.by]
        out: dict[str, tuple[int, ...]] = {name: (1,) for name in scalars}
        if self.groups:
            out |= {name: (1,) for name in ("thrust", "power")}
            families = ("thrust", "power", "CT", "CP", "eta")
            out |= {f"{f}_{g}": (1,) for g in self.groups for f in families}
            m = len(self.rotors.groups)
            out |= {"rotor_hub": (m, 3), "rotor_force": (m, 3), "rotor_moment": (m, 3)}
        if aircraft.wing is not None:
            ns = aircraft.lattice.wing_spanwise
            out |= {"cl_span": (ns,), "y_span": (ns,), "strip_edge": (ns + 1,), "strip_point": (ns, 3)}
            out |= {"strip_force": (ns, 3), "strip_moment": (ns, 3)}
        return out

    @property
    def by(self) -> tuple[str, ...]:
        """What coefficients are differentiated by."""
        elevator = ("delta_e",) if self.elevator else ()
        return ("alpha", "q", "alphadot", *elevator, *(f"theta_{g}" for g in self.groups))


_TEXTS: dict[str, dict[str, Any]] = {
    "lift_margin": {"desc": "least of cl_max - |cl| over all strips; negative: stalled, the model does not hold"},
    "dynamic_pressure": {"units": "Pa", "desc": "dynamic pressure of the free stream"},
    "speed": {"units": "m/s", "desc": "true airspeed"},
    "density": {"units": "kg/m**3", "desc": "density of the air"},
    "rotor_hub": {"units": "m", "desc": "hubs of the starboard rotors, inner first within a group"},
    "rotor_force": {"units": "N", "desc": "force of each starboard rotor on the aircraft, geometry axes"},
    "rotor_moment": {"units": "N*m", "desc": "moment of each starboard rotor about its hub, geometry axes"},
    "y_span": {"units": "m", "desc": "middles of the wing's strips"},
    "strip_edge": {"units": "m", "desc": "y of the edges of the wing's strips"},
    "strip_point": {"units": "m", "desc": "quarter-chord points of the wing's strips"},
    "strip_force": {"units": "N", "desc": "force on each strip of the starboard wing, geometry axes"},
    "strip_moment": {"units": "N*m", "desc": "moment on each strip about its point, geometry axes"},
}


def _flow(aircraft, inputs: Values):
    """The stream about the centre of gravity."""
    point = jnp.stack([inputs["x_cg"], jnp.zeros(()), inputs["z_cg"]])
    return arrays.flow(aircraft, inputs["mach"], inputs["altitude"], point)


def _system(aircraft, statics: AeroPlan, constants, inputs: Values) -> System:
    """First stage."""
    surfaces = arrays.surfaces(aircraft, list(constants))
    return make_system(surfaces, arrays.rotors(aircraft), statics.rotors, inputs["mach"], statics.shape)


def _outputs(aircraft, statics: AeroPlan, constants, system: System, inputs: Values) -> Values:
    """Second stage."""
    flow = _flow(aircraft, inputs)
    body = arrays.body(aircraft, flow)
    theta = [inputs[f"theta_{g}"] * RAD for g in statics.groups]
    x = Controls(
        inputs["alpha"] * RAD, inputs["q_hat"], inputs["delta_e"] * RAD, jnp.stack(theta) if theta else jnp.zeros(0)
    )
    rotors = arrays.rotors(aircraft)
    surfaces = arrays.surfaces(aircraft, list(constants))
    result = evaluate(
        system, x, surfaces, rotors=rotors, plan=statics.rotors, body=body, flow=flow, tail=statics.tail
    )
    out = _coefficients(statics, result) | _drag(aircraft, result, body, flow) | _air(result, flow)
    if rotors is not None:
        out |= _rotor_outputs(statics, result, rotors, flow)
    if aircraft.wing is not None:
        out |= _wing_outputs(system, result, flow)
    return out


def _coefficients(statics: AeroPlan, result: AeroResult) -> Values:
    """Coefficients and their derivatives, angles per radian."""
    out = dict(zip(COEFFICIENTS, result.total, strict=True))
    out["L_over_D"] = result.total.CL / jnp.where(result.total.CD == 0, 1.0, result.total.CD)
    columns = ["alpha", "q", "delta_e", *(f"theta_{g}" for g in statics.groups)]
    for name, row, lag in zip(COEFFICIENTS, result.derivatives, result.alphadot, strict=True):
        out |= {f"{name}_{by}": row[i] for i, by in enumerate(columns) if by in statics.by}
        out[f"{name}_alphadot"] = lag
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


def _air(result: AeroResult, flow) -> Values:
    """Stream and stall margin."""
    margin = jnp.minimum(result.lift_margin, 1e3)
    q = 0.5 * flow.density * flow.speed**2
    return {"lift_margin": margin, "dynamic_pressure": q, "speed": flow.speed, "density": flow.density}


def _rotor_outputs(statics: AeroPlan, result: AeroResult, rotors, flow) -> Values:
    """One rotor of each group, and the sums over all rotors."""
    r, plan = result.solution.rotors, statics.rotors
    first = [plan.groups.index(i) for i in range(len(statics.groups))]
    advance = jnp.where(r.CP == 0, 0.0, r.CT / jnp.where(r.CP == 0, 1.0, r.CP)) * (
        flow.speed * np.pi / (rotors.omega * rotors.radius)
    )
    out = {"thrust": plan.sides * jnp.sum(r.thrust), "power": plan.sides * jnp.sum(r.power)}
    for name, i in zip(statics.groups, first, strict=True):
        members = jnp.asarray([k for k, g in enumerate(plan.groups) if g == statics.groups.index(name)])
        out |= {f"thrust_{name}": jnp.mean(r.thrust[members]), f"power_{name}": jnp.mean(r.power[members])}
        out |= {f"CT_{name}": jnp.mean(r.CT[members]), f"CP_{name}": jnp.mean(r.CP[members])}
        out[f"eta_{name}"] = jnp.mean(advance[members])
    return out | {"rotor_hub": rotors.hub, "rotor_force": r.force, "rotor_moment": r.moment}


def _wing_outputs(system: System, result: AeroResult, flow) -> Values:
    """Section lift and dimensional loads of the wing's strips."""
    q = 0.5 * flow.density * flow.speed**2
    wing = result.loads.wing
    return {
        "cl_span": result.cl_strips[0],
        "y_span": wing.point[:, 1],
        "strip_edge": system.panels[0].strip_edges[:, 1],
        "strip_point": wing.point,
        "strip_force": q * wing.force,
        "strip_moment": q * wing.moment,
    }


@lru_cache(maxsize=1)
def _stages():
    """Compiled: assembly, state, Jacobian by state at a kept system, Jacobian through both stages."""

    def definition(structure: Structure, paths, base, inputs):
        return structure.aircraft(base, {path: inputs[name] for name, path in paths})

    def assemble(structure, statics, paths, base, constants, inputs):
        return _system(definition(structure, paths, base, inputs), statics, constants, inputs)

    def state(structure, statics, paths, base, constants, system, inputs):
        return _outputs(definition(structure, paths, base, inputs), statics, constants, system, inputs)

    def columns(run, names, wrt, inputs):
        flat, unravel = ravel_pytree({n: jnp.asarray(inputs[n]) for n in wrt})

        def flat_run(v):
            out = run(inputs | unravel(v))
            return ravel_pytree({n: out[n] for n in names})[0]

        return jax.jacfwd(flat_run)(flat)

    def by_state(structure, statics, paths, names, wrt, base, constants, system, inputs):
        return columns(lambda x: state(structure, statics, paths, base, constants, system, x), names, wrt, inputs)

    def by_all(structure, statics, paths, names, wrt, base, constants, inputs):
        def run(x):
            return state(structure, statics, paths, base, constants, assemble(structure, statics, paths, base, constants, x), x)

        return columns(run, names, wrt, inputs)

    return (
        jax.jit(assemble, static_argnums=(0, 1, 2)),
        jax.jit(state, static_argnums=(0, 1, 2)),
        jax.jit(by_state, static_argnums=(0, 1, 2, 3, 4)),
        jax.jit(by_all, static_argnums=(0, 1, 2, 3, 4)),
    )
