"""Lattice and rotors solved together: slipstream on the surfaces, upwash of the surfaces at the disks.

The lattice is linear in the velocities of the slipstreams, so the coupled system reduces to the rotors'
unknowns: the mean induced velocities of every annulus (two numbers by rotor and radius).
"""

from typing import NamedTuple

import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Flow, RotorPlan, Rotors, Surface
from hera_om.physics.disks import Wake, disk_points, mean_slipstreams, rotor_loads
from hera_om.physics.geometry import CAMBER, make_panels
from hera_om.physics.lattice import Lattice, assemble, solve
from hera_om.physics.layout import Layout, layout
from hera_om.physics.rotor import RotorSolution

TOLERANCE = 1e-12  # of the induced velocities over the flight speed
MAX_ITERATIONS = 60  # of the coupling; the residual is an output, so that a failure is seen
SLIPSTREAM = 1.0
"""Share of the slipstream that reaches the surfaces; 0 leaves the rotors only their hub forces."""
UPWASH = 1.0
"""Share of the surfaces' induced velocity that reaches the disks."""


class System(NamedTuple):
    """Everything that does not depend on incidence, rates, controls or blade pitch."""

    lattice: Lattice | None
    disk_velocity: Array | None  # [m nr npsi 3 n] velocity at the blade elements per unit circulation
    wing_edges: Array | None  # [ns + 1] y of the edges of the first surface's strips, m


def split_factors(system: System) -> tuple[System, tuple]:
    """A system without its factorisation, which carries no derivatives, and the factorisation."""
    if system.lattice is None:
        return system, ()
    return system._replace(lattice=system.lattice._replace(lu=())), system.lattice.lu


def join_factors(system: System, factors: tuple) -> System:
    """The inverse of `split_factors`."""
    return system if system.lattice is None else system._replace(lattice=system.lattice._replace(lu=factors))


class Controls(NamedTuple):
    """The state that derivatives are taken by."""

    alpha: Array | float  # rad
    q_hat: Array | float  # q c / 2V
    delta_e: Array | float  # rad
    theta: Float[Array, " g"]  # blade pitch of the rotor groups at 75 % radius, rad


class Root(NamedTuple):
    """Equilibrium found without derivatives, and what carries derivatives through it."""

    flat: Float[Array, " u"]  # induced velocities over flight speed: axial, then swirl, by rotor and radius
    phi: Array | None  # inflow angles of the blade elements there, rad


class Response(NamedTuple):
    """Lattice and rotors for given induced velocities."""

    flat: Float[Array, " u"]  # induced velocities that the rotors answer with
    gamma: Float[Array, " n"]
    loads: RotorSolution | None
    wake: Wake | None


class Setting(NamedTuple):
    """Arrays that surround the state; all of them can carry derivatives."""

    system: System
    rotors: Rotors | None
    flow: Flow
    c: Array | float  # reference chord, m


def make_system(
    surfaces: list[Surface], rotors: Rotors | None, plan: RotorPlan | None, mach, shape: str = CAMBER
) -> System:
    """Panels, factorised lattice, and its influence on the disks."""
    panels = [make_panels(s.sections, s.grid, shape) for s in surfaces]
    if not panels:
        return System(None, None, None)
    edges = panels[0].strip_edges[:, 1]
    if rotors is None or plan is None:
        return System(assemble(panels, mach)[0], None, edges)
    points = disk_points(rotors, plan)
    lattice, upwash = assemble(panels, mach, points.reshape(-1, 3))
    return System(lattice, upwash.reshape(*points.shape[:3], 3, -1), edges)


def panel_layout(surfaces: list[Surface]) -> Layout:
    """Index arrays of the surfaces' panels."""
    return layout([(s.grid.xi.shape[0] - 1, s.grid.middle.shape[0]) for s in surfaces])


def onset(points, x: Controls, *, c, point) -> Float[Array, "... 3"]:
    """Free stream and pitch rate over the flight speed: -(omega x r) relative to the aircraft."""
    stream = jnp.stack([jnp.cos(x.alpha), jnp.zeros_like(x.alpha), jnp.sin(x.alpha)])
    rate = 2.0 * x.q_hat / c
    arm = points - point
    return stream + rate * jnp.stack([-arm[..., 2], jnp.zeros_like(arm[..., 0]), arm[..., 0]], axis=-1)


def normals(lattice: Lattice, delta_e) -> Float[Array, "n 3"]:
    """Normals with the elevator deflected."""
    return lattice.normal + jnp.sin(delta_e) * lattice.normal_hinge


def circulation(at: Setting, x: Controls, extra) -> Float[Array, " n"]:
    """Ring circulations with the velocity ``extra`` [n, 3] at the collocation points, if any."""
    lattice = at.system.lattice
    if lattice is None:
        return jnp.zeros(0)
    wash = onset(lattice.collocation, x, c=at.c, point=at.flow.point) + extra
    return solve(lattice, -jnp.sum(wash * normals(lattice, x.delta_e), axis=-1))


def unknowns(plan: RotorPlan | None, system: System) -> int:
    """Number of unknowns of the coupling: none without rotors or without surfaces."""
    return 0 if plan is None or system.lattice is None else 2 * len(plan.groups) * plan.radial


def respond(flat: Float[Array, " u"], x: Controls, at: Setting, plan: RotorPlan | None, phi=None) -> Response:
    """One pass: slipstreams of the given strength, the lattice in them, the rotors in its upwash."""
    if plan is None or at.rotors is None:
        return Response(flat, circulation(at, x, jnp.zeros(3)), None, None)
    if at.system.lattice is None:
        loads = _disk_loads(at.rotors, at, x, None, plan=plan, phi=phi)
        return Response(flat, jnp.zeros(0), loads, Wake(loads.v_axial / at.flow.speed, loads.v_swirl / at.flow.speed))
    wake = Wake(*flat.reshape(2, len(plan.groups), plan.radial))
    extra = SLIPSTREAM * mean_slipstreams(at.rotors, plan, wake, *at.system.lattice.across)
    gamma = circulation(at, x, extra)
    loads = _disk_loads(at.rotors, at, x, gamma, plan=plan, phi=phi)
    induced = jnp.concatenate([loads.v_axial.ravel(), loads.v_swirl.ravel()]) / at.flow.speed
    return Response(induced, gamma, loads, wake)


def find_root(x: Controls, at: Setting, plan: RotorPlan | None) -> Root:
    """Equilibrium of lattice and rotors, without derivatives.

    The upwash changes a rotor's loading by a few percent and the loading the upwash by less: plain iteration
    gains more than a digit a step and needs one compiled copy of the model.
    """
    x, at = lax.stop_gradient((x, at))
    n = unknowns(plan, at.system)
    if plan is None:
        return Root(jnp.zeros(0), None)
    if n == 0:
        return Root(jnp.zeros(0), _answer(jnp.zeros(0), x, at, plan)[1])

    def unfinished(carry):
        flat, out, _, i = carry
        return (jnp.max(jnp.abs(out - flat)) > TOLERANCE) & (i < MAX_ITERATIONS)

    def step(carry):
        _, out, _, i = carry
        return out, *_answer(out, x, at, plan), i + 1

    start = jnp.zeros(n)
    blank = jnp.zeros((len(plan.groups), plan.radial, plan.azimuthal))
    _, flat, phi, _ = lax.while_loop(unfinished, step, (start - 1.0, start, blank, 0))
    return Root(flat, phi)


def _answer(flat, x: Controls, at: Setting, plan: RotorPlan) -> tuple[Array, Array | None]:
    """Induced velocities and inflow angles that the rotors answer with."""
    answer = respond(flat, x, at, plan)
    return answer.flat, None if answer.loads is None else answer.loads.phi


def carry_derivatives(root: Root, inverse, x: Controls, at: Setting, plan: RotorPlan | None) -> Float[Array, " u"]:
    """The root as a function of everything: one step of Newton's method with the Jacobian of the root.

    Its value is the root's; its first derivatives are exact (implicit function theorem).
    """
    miss = respond(root.flat, x, at, plan, root.phi).flat - root.flat
    return root.flat - inverse @ miss


def _disk_loads(rotors: Rotors, at: Setting, x: Controls, gamma, *, plan: RotorPlan, phi) -> RotorSolution:
    """Rotors in the free stream, the pitch rate and the upwash of the surfaces."""
    points = disk_points(rotors, plan)
    stream = onset(points, x, c=at.c, point=at.flow.point)
    if at.system.disk_velocity is not None:
        stream = stream + UPWASH * at.system.disk_velocity @ gamma
    return rotor_loads(rotors, plan, at.flow.speed * stream, pitch=x.theta, flow=at.flow, phi=phi)
