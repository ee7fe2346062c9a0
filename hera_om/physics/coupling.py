"""Lattice and rotors solved together: slipstream on the surfaces, upwash of the surfaces at the disks.

The lattice is linear in the velocities of the slipstreams, so the coupled system reduces to the rotors' unknowns:
the mean induced velocities of every annulus (two numbers by rotor and radius).
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Flow, RotorPlan, Rotors, Surface
from hera_om.physics.disks import Wake, disk_points, rotor_loads, slipstreams
from hera_om.physics.geometry import CAMBER, Panels, make_panels
from hera_om.physics.lattice import Lattice, assemble, prandtl_glauert, solve, velocity_influence
from hera_om.physics.rotor import RotorSolution

TOLERANCE = 1e-12  # of the induced velocities over the flight speed
MAX_ITERATIONS = 60
SLIPSTREAM = 1.0
"""Share of the slipstream that reaches the surfaces; 0 makes the rotors act on the aircraft by their hub forces only."""
UPWASH = 1.0
"""Share of the surfaces' induced velocity that reaches the disks."""


class System(NamedTuple):
    """Everything that does not depend on incidence, rates, controls or blade pitch."""

    panels: list[Panels]
    lattice: Lattice | None
    disk_velocity: Array | None  # [m nr npsi 3 n] velocity at the blade elements per unit circulation


class Controls(NamedTuple):
    """The state that derivatives are taken by."""

    alpha: Array | float  # rad
    q_hat: Array | float  # q c / 2V
    delta_e: Array | float  # rad
    theta: Float[Array, " g"]  # blade pitch of the rotor groups at 75 % radius, rad


class Solution(NamedTuple):
    """Circulations and rotors in equilibrium with each other."""

    gamma: Float[Array, " n"]
    rotors: RotorSolution | None
    wake: Wake | None
    residual: Array  # of the coupling, over the flight speed


def make_system(surfaces: list[Surface], rotors: Rotors | None, plan: RotorPlan | None, mach, shape: str = CAMBER) -> System:
    """Panels, factorised lattice, and its influence on the disks."""
    panels = [make_panels(s.sections, s.grid, shape) for s in surfaces]
    if not panels:
        return System(panels, None, None)
    lattice = assemble(panels, mach)
    if rotors is None or plan is None:
        return System(panels, lattice, None)
    points = disk_points(rotors, plan)
    upwash = velocity_influence(points.reshape(-1, 3), panels, prandtl_glauert(mach))
    return System(panels, lattice, upwash.reshape(*points.shape[:3], 3, -1))


def onset(points, x: Controls, *, c, point) -> Float[Array, "... 3"]:
    """Free stream and pitch rate over the flight speed: air moves by -(omega x r) relative to a turning aircraft."""
    stream = jnp.stack([jnp.cos(x.alpha), jnp.zeros_like(x.alpha), jnp.sin(x.alpha)])
    rate = 2.0 * x.q_hat / c
    arm = points - point
    return stream + rate * jnp.stack([-arm[..., 2], jnp.zeros_like(arm[..., 0]), arm[..., 0]], axis=-1)


def normals(lattice: Lattice, delta_e) -> Float[Array, "n 3"]:
    """Normals with the elevator deflected."""
    return lattice.normal + jnp.sin(delta_e) * lattice.normal_hinge


def circulation(system: System, x: Controls, extra, *, c, point) -> Float[Array, " n"]:
    """Ring circulations with the velocity ``extra`` [n, 3] at the collocation points."""
    lattice = system.lattice
    wash = onset(lattice.collocation, x, c=c, point=point) + extra
    return solve(lattice, -jnp.sum(wash * normals(lattice, x.delta_e), axis=-1))


def solve_coupled(system: System, x: Controls, *, rotors: Rotors | None, plan: RotorPlan | None, flow: Flow, c) -> Solution:
    """Equilibrium of lattice and rotors.

    The fixed point of the induced velocities is found without derivatives; two chord steps with the exact Jacobian at
    the solution then carry first and second derivatives exactly (each step raises the order by one).
    """
    nothing = jnp.zeros(())
    if rotors is None or plan is None:
        return Solution(circulation(system, x, jnp.zeros(3), c=c, point=flow.point), None, None, nothing)
    if system.lattice is None:
        loads = _disk_loads(system, x, None, rotors=rotors, plan=plan, flow=flow, c=c)
        return Solution(jnp.zeros(0), loads, Wake(loads.v_axial / flow.speed, loads.v_swirl / flow.speed), nothing)

    def respond(flat, system, x, rotors, flow, c):
        wake = Wake(*flat.reshape(2, len(plan.groups), plan.radial))
        extra = SLIPSTREAM * slipstreams(rotors, plan, wake, system.lattice.collocation)
        gamma = circulation(system, x, extra, c=c, point=flow.point)
        loads = _disk_loads(system, x, gamma, rotors=rotors, plan=plan, flow=flow, c=c)
        induced = jnp.concatenate([loads.v_axial.ravel(), loads.v_swirl.ravel()])
        return induced / flow.speed, gamma, loads

    args = (system, x, rotors, flow, c)
    flat, inverse = _root(respond, lax.stop_gradient(args), 2 * len(plan.groups) * plan.radial)

    def chord(carry, _):
        out, gamma, loads = respond(carry, *args)
        miss = out - carry
        return carry - inverse @ miss, (carry, gamma, loads, miss)

    # two steps, and a last pass that only evaluates; one loop, so that the model is compiled once
    _, passes = lax.scan(chord, flat, None, length=3)
    flat, gamma, loads, miss = jax.tree.map(lambda p: p[-1], passes)
    wake = Wake(*flat.reshape(2, len(plan.groups), plan.radial))
    return Solution(gamma, loads, wake, jnp.max(jnp.abs(miss)))


def _disk_loads(system: System, x: Controls, gamma, *, rotors, plan, flow: Flow, c) -> RotorSolution:
    """Rotors in the free stream, the pitch rate and the upwash of the surfaces."""
    points = disk_points(rotors, plan)
    stream = onset(points, x, c=c, point=flow.point)
    if system.disk_velocity is not None:
        stream = stream + UPWASH * system.disk_velocity @ gamma
    return rotor_loads(rotors, plan, flow.speed * stream, pitch=x.theta, flow=flow)


def _root(respond, args, n: int) -> tuple[Array, Array]:
    """Fixed point from zero and the inverse of the Jacobian of (response - unknowns) there.

    The upwash changes a rotor's loading by a few percent and the loading the upwash by less: plain iteration
    gains more than a digit a step and needs the response compiled once only.
    """

    def unfinished(carry):
        flat, out, i = carry
        return (jnp.max(jnp.abs(out - flat)) > TOLERANCE) & (i < MAX_ITERATIONS)

    def step(carry):
        _, out, i = carry
        return out, respond(out, *args)[0], i + 1

    start = jnp.zeros(n)
    flat, _, _ = lax.while_loop(unfinished, step, (start - 1.0, start, 0))
    jacobian = jax.jacfwd(lambda f: respond(f, *args)[0])(flat) - jnp.eye(n)
    return flat, jnp.linalg.inv(jacobian)
