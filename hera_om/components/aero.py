"""Lattice and rotors as one component: meshes and slipstreams never cross its border."""

from collections import OrderedDict
from functools import lru_cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import openmdao.api as om
from jax.flatten_util import ravel_pytree

from hera_om.components import arrays
from hera_om.components.aero_plan import COEFFICIENTS, PARTS, PARTS_BY, TEXTS, AeroPlan
from hera_om.components.base import JaxComponent, Values, fill_partials
from hera_om.components.structure import Structure
from hera_om.core.programs import program
from hera_om.physics.aero_cases import Body
from hera_om.physics.aerodynamics import AeroResult, evaluate
from hera_om.physics.aeroelastic import lift_by_twist
from hera_om.physics.coupling import (
    Controls,
    Setting,
    System,
    join_factors,
    make_system,
    panel_layout,
    split_factors,
    wind,
)
from hera_om.physics.equilibrium import Known, carried, find_root, settle
from hera_om.physics.performance import pull_up_rate

RAD = np.pi / 180
# What the factorised system reads, beside the disks and the Mach number.
GEOMETRY = ("wing", "htail", "vtail", "surface", "fuselage", "lattice")


class Aerodynamics(JaxComponent):
    """Coefficients, drag build-up, power-on derivatives and loads at one flight condition.

    Evaluation has two stages: assembly and factorisation, which read geometry and Mach number, are kept while
    those stand still; the state (incidence, rates, controls, blade pitch, altitude, moment point) is then
    cheap.

    With the option ``lateral`` both halves of the aircraft are solved: sideslip, roll and yaw rate, aileron and
    rudder become inputs, side force, rolling and yawing moment and all derivatives by them outputs.

    While `states_only` is set, `compute_partials` fills in only what a trim needs, the balances by incidence,
    elevator and blade pitch, from derivatives that `compute` has found anyway. `pressure` holds what the last
    evaluation found on the panels, see `physics.aerodynamics.AeroResult`; only pictures need it.
    """

    READS = (
        "wing.section",
        "wing.x_le_root_m",
        "wing.z_root_m",
        "wing.incidence_deg",
        "wing.polar",
        "htail",
        "vtail",
        "surface",
    )
    READS += ("fuselage", "drag_area", "rotor", "blade", "reference", "flight")
    states_only = False

    def initialize(self) -> None:
        """Declare options."""
        super().initialize()
        self.options.declare("lateral", types=bool, default=False, desc="whether the two halves may differ")

    def declare(self) -> None:
        """Condition and controls in; coefficients, derivatives, rotors and loads out."""
        aircraft = self.options["aircraft"]
        self.statics = AeroPlan(aircraft, self.options["lateral"])
        self.constants = tuple(arrays.grids(aircraft, self.options["lateral"]))
        point = arrays.moment_point(aircraft)
        flight = aircraft.flight
        defaults = {
            "alpha": flight.alpha_deg,
            "q_hat": flight.q_hat,
            "delta_e": flight.delta_e_deg,
            "mach": flight.mach,
        }
        if self.options["lateral"]:
            defaults |= {"beta": flight.beta_deg, "p_hat": flight.p_hat, "r_hat": flight.r_hat}
        defaults |= {name: getattr(flight, f"{name}_deg") for name in self.statics.commands}
        defaults |= {"altitude": flight.altitude_m, "x_cg": point[0], "z_cg": point[2]}
        defaults |= {f"theta_{r.name}": r.beta75_deg for r in aircraft.rotor}
        for name, value in defaults.items():
            self.add(name, val=value)
        self.add("load_factor", val=1.0, desc="load factor; beyond 1 a steady pull-up adds its pitch rate to q_hat")
        for name, shape in self.statics.outputs(aircraft).items():
            self.add(name, shape=shape, **TEXTS.get(name, {}))

    def compute(self, inputs, outputs) -> None:
        """Assemble if geometry or Mach number have moved, then evaluate the state."""
        kept = self._state(self.values(inputs))
        self.store(kept.outputs, outputs)
        self.pressure = np.asarray(kept.pressure)

    def store(self, out: Values, outputs) -> None:
        """Copy results, unless lattice and rotors have found no equilibrium."""
        super().store(out, outputs)
        if float(out["coupling_residual"]) > UNCONVERGED:
            raise om.AnalysisError(
                f"{self.pathname}: lattice and rotors have not converged "
                f"(residual {float(out['coupling_residual']):.1e} "
                f"of the flight speed, limit {UNCONVERGED:.0e})"
            )

    def compute_partials(self, inputs, partials) -> None:
        """Exact derivatives by all inputs, or those of the balances alone, see `states_only`."""
        values = self.values(inputs)
        kept = self._state(values)
        if self.states_only:
            self._balances(partials, kept)
            return
        _, _, by_system, by_input = _stages(self.statics.model.lateral)
        names = tuple(sorted(self._var_rel_names["output"]))
        fixed = self._fixed_names()
        moving = tuple(n for n in sorted(values) if n not in fixed)
        static = self._static()
        tangents = _keep(
            _tangents,
            (*self._system_key(values), fixed),
            lambda: by_system(*static, fixed, self.base, self.constants, values),
        )
        args = (self.base, self.constants, kept.system, kept.known, values)
        matrix = by_input(*static, names, fixed, moving, *args, tangents)
        fill_partials(partials, np.asarray(matrix), names, {n: np.zeros(1) for n in fixed + moving}, self._outputs)

    def _balances(self, partials, kept: "State") -> None:
        """Partials of the balances by the trim's states, per degree, from derivatives among the outputs."""
        states = ("alpha", "delta_e", *(f"theta_{g}" for g in self.statics.groups))
        for wrt, column in ((n, i) for i, n in enumerate(self.statics.columns) if n in states):
            for of in COEFFICIENTS:
                partials[of, wrt] = float(getattr(kept.by, of)[column]) * RAD
            for i, group in enumerate(self.statics.groups):
                members = self.statics.running(i, 1)
                partials[f"thrust_{group}", wrt] = float(np.mean(np.asarray(kept.thrust_by)[members, column])) * RAD

    def _fixed_names(self) -> tuple[str, ...]:
        """Inputs that the factorised system depends on."""
        reads = [n for n, path in self.paths.items() if path.split(".")[0] in (*GEOMETRY, "rotor", "blade", "flight")]
        turning = ["alpha"] if self.statics.model.stream_wake else []
        return tuple(sorted([*reads, "mach", *turning]))

    def _static(self) -> tuple[Any, ...]:
        return self.structure, self.statics, tuple(self.paths.items())

    def _system_key(self, values: Values) -> tuple[Any, ...]:
        """What the factorised system depends on."""
        read = tuple((n, float(values[n])) for n in self._fixed_names())
        return self.structure, self.statics, self.base.tobytes(), read

    def _state(self, values: Values) -> "State":
        """The state at these inputs: evaluated, or kept from the last few calls of any instance."""
        assemble, state, _, _ = _stages(self.statics.model.lateral)
        static, key = self._static(), self._system_key(values)
        system = _keep(_systems, key, lambda: assemble(*static, self.base, self.constants, values))
        at = (*key, tuple((n, float(v)) for n, v in sorted(values.items())))
        return _keep(_states, at, lambda: state(*static, self.base, self.constants, system, values))


class State(NamedTuple):
    """What one evaluation leaves for its outputs and its derivatives."""

    outputs: Values
    system: System
    known: Known  # what carries derivatives through the equilibrium
    by: Any  # Coefficients by the state
    thrust_by: Any
    pressure: Any  # see `physics.aerodynamics.AeroResult`


UNCONVERGED = 1e-9  # of the flight speed: residual of the coupling above which an analysis has failed
KEPT = 4
_systems: OrderedDict[Any, System] = OrderedDict()
_states: OrderedDict[Any, State] = OrderedDict()
_tangents: OrderedDict[Any, System] = OrderedDict()


def _keep(store: OrderedDict, key, make):
    """The value of a key, made if it is not among the last few."""
    if key not in store:
        store[key] = make()
        while len(store) > KEPT:
            store.popitem(last=False)
    store.move_to_end(key)
    return store[key]


def _system(aircraft, statics: AeroPlan, constants, inputs: Values) -> System:
    """First stage."""
    surfaces = arrays.surfaces(aircraft, list(constants), statics.model.lateral)
    rotors, slender = arrays.rotors(aircraft), arrays.slender(aircraft)
    how = {"slender": slender, "alpha": inputs["alpha"] * RAD}
    return make_system(surfaces, rotors, statics.rotors, inputs["mach"], statics.model, **how)


def _setting(aircraft, statics: AeroPlan, system: System, inputs: Values) -> tuple[Controls, Setting, Body]:
    """State, stream and reference quantities of the second stage."""
    point = jnp.stack([inputs["x_cg"], jnp.zeros(()), inputs["z_cg"]])
    flow = arrays.flow(aircraft, inputs["mach"], inputs["altitude"], point)
    body = arrays.body(aircraft, flow)
    turning = jnp.where(
        flow.speed > 0, pull_up_rate(jnp.where(flow.speed > 0, flow.speed, 1.0), inputs["load_factor"]), 0.0
    )
    q_hat = inputs["q_hat"] + turning * body.c / (2 * jnp.where(flow.speed > 0, flow.speed, 1.0))
    delta = [inputs[name] * RAD for name in statics.commands]
    theta = [inputs[f"theta_{g}"] * RAD for g in statics.groups]
    slip = [inputs["beta"] * RAD, inputs["p_hat"], inputs["r_hat"]] if statics.model.lateral else []
    rows = [jnp.stack(v) if v else jnp.zeros(0) for v in (delta, theta, slip)]
    x = Controls(inputs["alpha"] * RAD, jnp.asarray(q_hat), *rows)
    return x, Setting(system, arrays.rotors(aircraft), flow, body.c, body.b), body


def _evaluate(
    aircraft, statics: AeroPlan, constants, system: System, inputs: Values, known: Known | None
) -> tuple[AeroResult, Known]:
    """Second stage: from nothing, or at an equilibrium that is known and carries derivatives."""
    x, at, body = _setting(aircraft, statics, system, inputs)
    plan, surfaces = statics.rotors, arrays.surfaces(aircraft, list(constants), statics.model.lateral)
    if known is None:
        found, known = settle(find_root(x, at, plan), x, at, plan)
    else:
        found = carried(known, x, at, plan)
    polars, lay = [s.polar for s in surfaces], panel_layout(surfaces, statics.model)
    return evaluate(found, x, polars, at=at, plan=plan, body=body, lay=lay), known


def _outputs(aircraft, statics: AeroPlan, constants, system: System, inputs: Values, result: AeroResult) -> Values:
    """Outputs by name."""
    x, at, body = _setting(aircraft, statics, system, inputs)
    out = _coefficients(statics, result) | _drag(aircraft, result, body, at.flow) | _air(result, at.flow, body)
    if at.rotors is not None:
        out |= _rotor_outputs(statics, result, at.rotors, at.flow)
    if aircraft.wing is not None:
        out |= _wing_outputs(system, result, at.flow)
    if statics.aeroelastic:
        assert system.lattice is not None
        lay = panel_layout(arrays.surfaces(aircraft, list(constants)), statics.model)
        slope = lift_by_twist(system.lattice, lay, wind(x), out["cl_span"].shape[0])
        out["strip_lift_by_twist"] = out["dynamic_pressure"] * slope
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


QUICK = {"xla_backend_optimization_level": 0}
"""The state stage with both halves serves single conditions: compiling it fast is worth more than running it fast."""


@lru_cache(maxsize=2)
def _stages(once: bool):
    """Compiled once a process: assembly, state, tangents of the assembly, and the Jacobian by all inputs.

    ``once``: for conditions that are analysed one by one, see `QUICK`.
    """

    def definition(structure: Structure, paths, base, inputs):
        return structure.aircraft(base, {path: inputs[name] for name, path in paths})

    def assemble(structure, statics, paths, base, constants, inputs):
        return _system(definition(structure, paths, base, inputs), statics, constants, inputs)

    def state(structure, statics, paths, base, constants, system, inputs):
        aircraft = definition(structure, paths, base, inputs)
        result, known = _evaluate(aircraft, statics, constants, system, inputs, None)
        outputs = _outputs(aircraft, statics, constants, system, inputs, result)
        return State(outputs, system, known, result.derivatives, result.thrust_by, result.pressure)

    def by_system(structure, statics, paths, wrt, base, constants, inputs):
        """Tangents of the assembled system by the inputs that it reads, stacked on a leading axis."""

        def run(v):
            here = inputs | dict(zip(wrt, v, strict=True))
            return split_factors(assemble(structure, statics, paths, base, constants, here))[0]

        start = jnp.stack([jnp.asarray(inputs[n]) for n in wrt])
        return jax.vmap(lambda direction: jax.jvp(run, (start,), (direction,))[1])(jnp.eye(len(wrt)))

    def by_input(
        structure,
        statics,
        paths,
        names,
        fixed,
        moving,
        base,
        constants,
        system,
        known,
        inputs,
        tangents,
    ):
        """Jacobian of all outputs, columns in alphabetical order of the inputs."""

        def run(varying, v):
            here = inputs | dict(zip(order, v, strict=True))
            aircraft = definition(structure, paths, base, here)
            system = join_factors(varying, factors)
            result, _ = _evaluate(aircraft, statics, constants, system, here, known)
            out = _outputs(aircraft, statics, constants, system, here, result)
            return ravel_pytree({n: out[n] for n in names})[0]

        order = (*fixed, *moving)
        varying, factors = split_factors(system)
        start, basis = jnp.stack([jnp.asarray(inputs[n]) for n in order]), jnp.eye(len(order))
        padded = jax.tree.map(lambda t: jnp.concatenate([t, jnp.zeros((len(moving), *t.shape[1:]), t.dtype)]), tangents)
        push = jax.vmap(lambda d_system, d: jax.jvp(run, (varying, start), (d_system, d))[1], out_axes=1)
        return push(padded, basis)[:, jnp.asarray(np.argsort(order))]

    static = (0, 1, 2)
    return (
        program(assemble, 3) if once else jax.jit(assemble, static_argnums=static),
        program(state, 3, QUICK) if once else jax.jit(state, static_argnums=static),
        jax.jit(by_system, static_argnums=(*static, 3)),
        jax.jit(by_input, static_argnums=(*static, 3, 4, 5)),
    )
