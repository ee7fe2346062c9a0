"""Velocities at the wing's leading edge and loads of the blades around their disks, for pictures."""

from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from hera_om.aircraft import Aircraft
from hera_om.components import arrays
from hera_om.core.programs import Program
from hera_om.physics.aero_cases import Flow, Model, RotorPlan, Rotors, Surface
from hera_om.physics.blade_loads import section_loading
from hera_om.physics.coupling import Controls, Setting, induced, make_system, respond, winds
from hera_om.physics.disks import blades, slipstreams
from hera_om.physics.equilibrium import find_root
from hera_om.physics.geometry import surface_mesh
from hera_om.physics.lattice import assemble
from hera_om.physics.rotor import azimuths

RAD = np.pi / 180
AHEAD = 0.1
"""Points of the velocities ahead of the leading edge over the chord: on a thin wing's edge they have no end."""
POINTS = 181
"""Points along the semispan."""
AZIMUTHS = 36
"""Blade stations around a disk, more than forces need: pictures shall be smooth."""
SECTION = 0.75
"""Radius of the blade section that is shown over the tip radius."""


def fields(both: Aircraft, wing: Aircraft, rotors: Aircraft, alphas: Sequence[float]) -> dict[str, Any]:
    """Velocities at the leading edge and blade loads of wing and rotors, each alone and together.

    Returns:
        ``leading_edge``: by incidence, ``y`` and velocities over the flight speed [points, 3], "both", "wing",
        "rotors"; ``blades``: by incidence and rotor, the section's thrust coefficient dT/dr / (rho n^2 D^3) over
        ``azimuth_deg``, "both" and "rotors"; ``disks``: y and radius of each, m.
    """
    points = _leading_edge(wing)
    fine = {"lattice": both.lattice.model_copy(update={"rotor_azimuthal": AZIMUTHS})}
    both, wing, rotors = (case.model_copy(update=fine) for case in (both, wing, rotors))
    names = [
        f"{r.name} {i + 1}" if r.count_per_side > 1 else r.name for r in both.rotor for i in range(r.count_per_side)
    ]
    edge, loads = [], []
    for alpha in alphas:
        velocity, load = zip(*(_solve(case, alpha, points) for case in (both, wing, rotors)), strict=True)
        row = {"both": velocity[0], "wing": velocity[1], "rotors": velocity[2]}
        edge.append({"alpha": alpha, "y": points[:, 1].tolist(), **{k: v.tolist() for k, v in row.items()}})
        angle = np.degrees(np.asarray(azimuths(AZIMUTHS))).tolist()
        for name, installed, alone in zip(names, load[0].tolist(), load[2].tolist(), strict=True):
            loads.append({"alpha": alpha, "rotor": name, "azimuth_deg": angle, "both": installed, "rotors": alone})
    disks = arrays.rotors(both)
    assert disks is not None
    places = np.column_stack([disks.hub[:, 1], disks.radius]).tolist()
    return {"leading_edge": edge, "blades": loads, "disks": places}


def _leading_edge(aircraft: Aircraft) -> np.ndarray:
    """Points along the wing and ahead of its leading edge, between the middles of the first and the last strip, m."""
    wing = arrays.surfaces(aircraft, arrays.grids(aircraft))[0]
    mesh = np.asarray(surface_mesh(wing.sections, wing.grid, arrays.model(aircraft, False).shape))
    ahead = mesh[0] - AHEAD * (mesh[-1] - mesh[0])
    ahead = 0.5 * (ahead[1:] + ahead[:-1])
    y = np.linspace(ahead[0, 1], ahead[-1, 1], POINTS)
    return np.column_stack([np.interp(y, ahead[:, 1], column) for column in ahead.T])


def _solve(aircraft: Aircraft, alpha: float, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Velocity of surfaces and slipstreams at the points over the flight speed, and the section's load [m, npsi]."""
    at, plan, model = arrays.moment_point(aircraft), arrays.plan(aircraft, False), arrays.model(aircraft, False)
    given = aircraft.flight
    flow = arrays.flow(aircraft, jnp.asarray(given.mach), jnp.asarray(given.altitude_m), jnp.asarray(at))
    commands = arrays.model_commands(aircraft, False)
    x = Controls(
        jnp.asarray(alpha * RAD),
        jnp.asarray(given.q_hat),
        jnp.asarray([getattr(given, f"{c}_deg") * RAD for c in commands]),
        jnp.asarray([r.beta75_deg * RAD for r in aircraft.rotor]),
        jnp.zeros(0),
    )
    surfaces = arrays.surfaces(aircraft, arrays.grids(aircraft))
    lengths = tuple(jnp.asarray(v, float) for v in arrays.reference(aircraft)[1:])
    velocity, load = _field(plan, model, x, surfaces, arrays.rotors(aircraft), flow, lengths, jnp.asarray(points))
    return np.asarray(velocity), np.asarray(load)


def _velocity_and_load(
    plan: RotorPlan | None,
    model: Model,
    x: Controls,
    surfaces: list[Surface],
    rotors: Rotors | None,
    flow: Flow,
    lengths,
    points,
):
    """Equilibrium of surfaces and rotors, and what it is seen by."""
    at = Setting(make_system(surfaces, rotors, plan, flow.mach, model, None, x.alpha), rotors, flow, *lengths)
    root = find_root(x, at, plan)
    answer = respond(root.flat, x, at, plan, root.phi)
    velocity, load = jnp.zeros_like(points), jnp.zeros((0, 1))
    if surfaces:
        _, (even, _) = assemble(at.system.panels, flow.mach, points, kinds=model.kinds)
        velocity = velocity + induced(even, None, answer.gamma)[0]
    if plan is not None and rotors is not None and answer.wake is not None and answer.loads is not None:
        velocity = velocity + jnp.sum(slipstreams(rotors, plan, answer.wake, points, winds=winds(x))[0], axis=0)
        load = _section(rotors, plan, answer.loads, flow.density)
    return velocity, load


def _section(rotors: Rotors, plan: RotorPlan, loads, density):
    """The section's load of every starboard rotor."""

    def one(blade, solution, omega, radius):
        return section_loading(solution, blade, SECTION, omega=omega, radius=radius, density=density)

    first = jax.tree.map(lambda v: v[0], loads)
    return jax.vmap(one)(blades(rotors, plan), first, rotors.omega, rotors.radius)


_field = Program(_velocity_and_load, 2)
