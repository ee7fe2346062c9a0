"""The aerodynamics as compiled stages, from numbers of a definition to named outputs; nothing here knows OpenMDAO."""

from functools import lru_cache
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree

from hera_om.components import arrays
from hera_om.components.aero_outputs import Values, named
from hera_om.components.aero_plan import AeroPlan
from hera_om.components.structure import Structure, number_array, variables_under
from hera_om.core.programs import FAST, LEAN, Program, in_background, kept
from hera_om.physics.aero_cases import Body
from hera_om.physics.aerodynamics import evaluate
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
from hera_om.physics.equilibrium import Equilibrium, Known, Root, carried, find_root, settle
from hera_om.physics.performance import pull_up_rate

RAD = np.pi / 180
READS = (
    "wing.section",
    "wing.x_le_root_m",
    "wing.z_root_m",
    "wing.incidence_deg",
    "wing.polar",
    "htail",
    "vtail",
    "surface",
    "fuselage",
    "drag_area",
    "rotor",
    "blade",
    "reference",
    "flight",
)
"""What the aerodynamics reads of a definition, see `components.base.JaxComponent`."""


class Finished(NamedTuple):
    """What the last stage finds."""

    outputs: Values
    by: Any  # Coefficients by the state
    thrust_by: Any
    pressure: Any  # see `physics.aerodynamics.AeroResult`


class Stages(NamedTuple):
    """Compiled once a process. Each but the last two takes structure, plan and paths, then numbers and constants.

    Assembly and factorisation read geometry and Mach number; root, equilibrium and end the state. The Jacobian by all
    inputs takes the tangents of the assembly.
    """

    assemble: Any
    root: Any
    settle: Any
    finish: Any
    by_system: Any
    by_input: Any

    def state(self, static, base, constants, system, inputs) -> tuple[Known, Finished]:
        """The state at an assembled system; of `Program.begin`s, their shapes."""
        args = (*static, base, constants, system, inputs)
        root = self.root(*args)
        found, known = self.settle(*args, root)
        return known, self.finish(*args, found)


def conditions(aircraft, plan: AeroPlan) -> dict[str, float]:
    """Inputs of the aerodynamics beside the design variables, at the definition's flight condition."""
    point, flight = arrays.moment_point(aircraft), aircraft.flight
    out = {"alpha": flight.alpha_deg, "q_hat": flight.q_hat, "delta_e": flight.delta_e_deg, "mach": flight.mach}
    if plan.model.lateral:
        out |= {"beta": flight.beta_deg, "p_hat": flight.p_hat, "r_hat": flight.r_hat}
    out |= {name: getattr(flight, f"{name}_deg") for name in plan.commands}
    out |= {"altitude": flight.altitude_m, "x_cg": point[0], "z_cg": point[2]}
    return out | {f"theta_{r.name}": r.beta75_deg for r in aircraft.rotor}


def begin(aircraft) -> None:
    """Start to load or compile what a single condition of this aircraft will ask for; faults wait for the asking."""
    if not kept():
        return

    def work() -> None:
        plan, constants = AeroPlan(aircraft, True), tuple(arrays.grids(aircraft, True))
        variables = variables_under(aircraft, READS)
        paths = tuple((v.name, v.path) for v in variables)
        values = conditions(aircraft, plan) | {"load_factor": 1.0} | {v.name: v.value for v in variables}
        inputs = {name: np.asarray(value, float) for name, value in values.items()}
        given = ((Structure(aircraft), plan, paths), number_array(aircraft), constants)
        s = stages(True)
        begun = Stages(s.assemble.begin, s.root.begin, s.settle.begin, s.finish.begin, None, None)
        begun.state(*given, begun.assemble(*given[0], *given[1:], inputs), inputs)

    in_background(work)


@lru_cache(maxsize=2)
def stages(once: bool) -> Stages:
    """The stages; ``once``: for conditions that are analysed one by one, see `VALUES`."""
    assemble, root, settled, finish = [Program(f, 3, single if once else many) for f, (single, many) in VALUES.items()]
    return Stages(assemble, root, settled, finish, Program(_by_system, 4, NEWER), Program(_by_input, 6))


def _definition(structure: Structure, paths, base, inputs: Values):
    """The definition with the values of its variables."""
    return structure.aircraft(base, {path: inputs[name] for name, path in paths})


def _assemble(structure, statics: AeroPlan, paths, base, constants, inputs) -> System:
    """Geometry, influence coefficients, factors."""
    aircraft = _definition(structure, paths, base, inputs)
    surfaces = arrays.surfaces(aircraft, list(constants), statics.model.lateral)
    rotors, slender = arrays.rotors(aircraft), arrays.slender(aircraft)
    how = {"slender": slender, "alpha": inputs["alpha"] * RAD}
    return make_system(surfaces, rotors, statics.rotors, inputs["mach"], statics.model, **how)


def _root(structure, statics: AeroPlan, paths, base, constants, system: System, inputs) -> Root:
    """Where lattice and rotors agree."""
    x, at, _ = _setting(_definition(structure, paths, base, inputs), statics, system, inputs)
    return find_root(x, at, statics.rotors)


def _settle(structure, statics, paths, base, constants, system, inputs, root: Root) -> tuple[Equilibrium, Known]:
    """The equilibrium at a root, with derivatives by the state."""
    x, at, _ = _setting(_definition(structure, paths, base, inputs), statics, system, inputs)
    return settle(root, x, at, statics.rotors)


def _finish(structure, statics, paths, base, constants, system, inputs, found: Equilibrium) -> Finished:
    """Forces, derivatives and outputs at an equilibrium."""
    aircraft = _definition(structure, paths, base, inputs)
    x, at, body = _setting(aircraft, statics, system, inputs)
    surfaces = arrays.surfaces(aircraft, list(constants), statics.model.lateral)
    polars, lay = [s.polar for s in surfaces], panel_layout(surfaces, statics.model)
    result = evaluate(found, x, polars, at=at, plan=statics.rotors, body=body, lay=lay)
    outputs = named(aircraft, statics, at, body, result)
    if statics.aeroelastic:
        assert system.lattice is not None
        slope = lift_by_twist(system.lattice, lay, wind(x), outputs["cl_span"].shape[0])
        outputs["strip_lift_by_twist"] = outputs["dynamic_pressure"] * slope
    return Finished(outputs, result.derivatives, result.thrust_by, result.pressure)


def _setting(aircraft, statics: AeroPlan, system: System, inputs: Values) -> tuple[Controls, Setting, Body]:
    """State, stream and reference quantities."""
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


def _by_system(structure, statics, paths, wrt, base, constants, inputs):
    """Tangents of the assembled system by the inputs that it reads, stacked on a leading axis."""

    def run(v):
        here = inputs | dict(zip(wrt, v, strict=True))
        return split_factors(_assemble(structure, statics, paths, base, constants, here))[0]

    start = jnp.stack([jnp.asarray(inputs[n]) for n in wrt])
    return jax.vmap(lambda direction: jax.jvp(run, (start,), (direction,))[1])(jnp.eye(len(wrt)))


def _by_input(structure, statics, paths, names, fixed, moving, base, constants, system, known: Known, inputs, tangents):
    """Jacobian of all outputs, columns in alphabetical order of the inputs."""

    def run(varying, v):
        here = inputs | dict(zip(order, v, strict=True))
        system = join_factors(varying, factors)
        x, at, _ = _setting(_definition(structure, paths, base, here), statics, system, here)
        found = carried(known, x, at, statics.rotors)
        out = _finish(structure, statics, paths, base, constants, system, here, found).outputs
        return ravel_pytree({n: out[n] for n in names})[0]

    order = (*fixed, *moving)
    varying, factors = split_factors(system)
    start, basis = jnp.stack([jnp.asarray(inputs[n]) for n in order]), jnp.eye(len(order))
    padded = jax.tree.map(lambda t: jnp.concatenate([t, jnp.zeros((len(moving), *t.shape[1:]), t.dtype)]), tangents)
    push = jax.vmap(lambda d_system, d: jax.jvp(run, (varying, start), (d_system, d))[1], out_axes=1)
    return push(padded, basis)[:, jnp.asarray(np.argsort(order))]


LESS = LEAN | {"xla_backend_optimization_level": 1}
NEWER: dict[str, Any] = {}
"""XLA's own options, with its newer emitters: the lattice's kernels run twice as fast."""
VALUES = {_assemble: (LESS, NEWER), _root: (FAST, LEAN), _settle: (LESS, LEAN), _finish: (FAST, LEAN)}
"""Stages that give values, with XLA's options for single conditions, where compiling fast is worth as much, and for
many."""
