"""Aerodynamics of a whole aircraft in symmetric flow: coefficients, drag build-up, derivatives, loads."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Body, Flow, RotorPlan, Rotors, Surface
from hera_om.physics.coupling import SLIPSTREAM, Controls, Solution, System, onset, solve_coupled
from hera_om.physics.disks import slipstreams
from hera_om.physics.lattice import solve
from hera_om.physics.lattice_forces import StripLoads, filament_forces, half_resultant, strip_loads, trefftz
from hera_om.physics.profile_drag import section_profile_drag
from hera_om.physics.rotor import RotorSolution

DOWNWASH_LAG = 1.0
"""Share of the wing's downwash lag in the alpha-dot terms; 0 leaves quasi-steady flow without any."""


class Coefficients(NamedTuple):
    """Force and moment coefficients; CX CZ Cm hold everything, CL CD leave the rotors' hub loads out."""

    CL: Array
    CD: Array
    CX: Array
    CZ: Array
    Cm: Array


class DragParts(NamedTuple):
    """Drag coefficients on the reference area."""

    CDi: Array  # from the Trefftz plane, circulation alone
    CDi_near: Array  # from the near field, circulation alone
    CD_slipstream: Array  # of the slipstreams' velocities on the circulation; negative: swirl recovered
    CD_profile: Array
    CD_areas: Array


class Loads(NamedTuple):
    """Loads for the structure, starboard half, over dynamic pressure; and the rotors."""

    wing: StripLoads | None
    rotors: RotorSolution | None


class AeroResult(NamedTuple):
    """Outcome of `evaluate`."""

    total: Coefficients
    derivatives: Coefficients  # each [2 + e + g]: by alpha, q_hat, delta_e and the groups' blade pitch, 1/rad
    alphadot: Coefficients  # by alphadot c / 2V
    drag: DragParts
    lift_margin: Array  # least of cl_max - |cl| over the strips
    cl_strips: list[Array]  # section lift coefficients by surface, on the local dynamic pressure
    loads: Loads
    solution: Solution


def evaluate(
    system: System,
    x: Controls,
    surfaces: list[Surface],
    *,
    rotors: Rotors | None,
    plan: RotorPlan | None,
    body: Body,
    flow: Flow,
    tail: int | None,
) -> AeroResult:
    """Everything at one state, with the derivatives by the state.

    The alpha-dot derivatives are INTERIM: quasi-steady flow in which the wing's circulation, as the tail sees it, is
    late by the time of flight from the wing (the lag of downwash, Etkin & Reid, Dynamics of Flight 3e, section 5.5),
    computed with the lattice's own downwash. Apparent mass and the wing's own unsteady wake are left out.

    Args:
        system: from `make_system`.
        x: state.
        surfaces: the surfaces of the system; the first one is the wing.
        rotors, plan: rotors or None.
        body: reference quantities and what the lattice does not carry.
        flow: stream and moment point.
        tail: index of the surface in the wing's downwash, or None.

    Returns:
        AeroResult.
    """
    size = x.theta.shape[0]
    flat = jnp.concatenate([jnp.stack([x.alpha, x.q_hat, x.delta_e]), x.theta])

    def state(v):
        return Controls(v[0], v[1], v[2], v[3 : 3 + size])

    def forces(v):
        solution = solve_coupled(system, state(v), rotors=rotors, plan=plan, flow=flow, c=body.c)
        total, parts = _coefficients(system, state(v), solution, surfaces, plan=plan, rotors=rotors, body=body, flow=flow)
        return (total, solution.gamma), (total, parts, solution)

    (derivatives, gamma_by), (total, parts, solution) = jax.jacfwd(forces, has_aux=True)(flat)
    alphadot = _alphadot(system, x, solution, gamma_by, surfaces, plan=plan, rotors=rotors, body=body, flow=flow, tail=tail)
    drag, cl, margin, loads = parts
    return AeroResult(total, derivatives, alphadot, drag, margin, cl, loads, solution)


def _coefficients(system, x, solution, surfaces, *, plan, rotors, body: Body, flow: Flow):
    """Coefficients and everything that hangs on the same forces."""
    stream = jnp.stack([jnp.cos(x.alpha), 0.0 * x.alpha, jnp.sin(x.alpha)])
    zero = jnp.zeros(3)
    lattice_force, lattice_moment, profile_force, profile_moment = zero, zero, zero, zero
    drag_of = lambda force: force @ stream / body.S  # noqa: E731
    cl, margin, wing, induced, slip = [], jnp.inf, None, 0.0, 0.0
    if system.lattice is not None:
        lattice, panels = system.lattice, system.panels
        wash = jnp.zeros_like(lattice.bound_points)
        if rotors is not None:
            wash = SLIPSTREAM * slipstreams(rotors, plan, solution.wake, lattice.bound_points)
        base = onset(lattice.bound_points, x, c=body.c, point=flow.point)
        loads = strip_loads(lattice, panels, filament_forces(lattice, panels, solution.gamma, base + wash))
        without = strip_loads(lattice, panels, filament_forces(lattice, panels, solution.gamma, base))
        lattice_force, lattice_moment = half_resultant(loads, flow.point)
        bare_force, _ = half_resultant(without, flow.point)
        induced, slip = drag_of(bare_force), drag_of(lattice_force - bare_force)
        drags, cl, margin = _profile(panels, surfaces, loads, base + wash, body, flow)
        profile_force, profile_moment = half_resultant(drags, flow.point)
        wing = jax.tree.map(jnp.add, loads[0], drags[0]._replace(point=jnp.zeros_like(drags[0].point)))
    area_force, area_moment = _areas(body, solution, stream, flow)
    aero = lattice_force + profile_force + area_force
    moment = lattice_moment + profile_moment + area_moment
    everything = aero / body.S
    cm = moment[1] / (body.S * body.c) + body.munk_slope * x.alpha
    if rotors is not None:
        hub_force, hub_moment = _hub_loads(rotors, plan, solution, flow)
        q_S = 0.5 * flow.density * flow.speed**2 * body.S
        everything, cm = everything + hub_force / q_S, cm + hub_moment[1] / (q_S * body.c)
    up = jnp.stack([-jnp.sin(x.alpha), 0.0 * x.alpha, jnp.cos(x.alpha)])
    total = Coefficients(aero @ up / body.S, drag_of(aero), everything[0], everything[2], cm)
    trace = trefftz(system.panels, solution.gamma)[1] / body.S if system.panels else jnp.zeros(())
    parts = DragParts(trace, jnp.asarray(induced), jnp.asarray(slip), drag_of(profile_force), drag_of(area_force))
    return total, (parts, cl, margin, Loads(wing, solution.rotors))


def _profile(panels, surfaces, loads, velocity, body, flow):
    """Profile drag of every strip in its own stream, section lift coefficients, and the least margin to cl_max."""
    out, cls, margin, start = [], [], jnp.inf, 0
    for panel, surface, load in zip(panels, surfaces, loads, strict=True):
        nc, ns = panel.collocation.shape[:2]
        local = jnp.mean(velocity[start : start + nc * ns].reshape(nc, ns, 3), axis=0)
        start += nc * (2 * ns + 1)
        q = jnp.sum(local**2, axis=-1)
        edge = panel.strip_edges[1:] - panel.strip_edges[:-1]
        up = jnp.cross(local, edge)
        up = up / jnp.linalg.norm(up, axis=-1, keepdims=True)
        area = panel.strip_chord * panel.strip_width
        cl = jnp.sum(load.force * up, axis=-1) / (q * area)
        p = surface.polar
        scale = jnp.where(flow.speed > 0, flow.density * flow.speed / flow.viscosity, p.re / panel.strip_chord[0])
        reynolds = scale * jnp.sqrt(q) * panel.strip_chord
        cd = section_profile_drag(cl, reynolds, cd_min=p.cd_min, cl_at_cd_min=p.cl_at_cd_min, k=p.k, re_ref=p.re)
        drag = (cd * jnp.sqrt(q) * area)[:, None] * local
        out.append(StripLoads(load.point, drag, jnp.zeros_like(drag)))
        cls.append(cl)
        margin = jnp.minimum(margin, p.cl_max - jnp.max(jnp.abs(cl)))
    return out, cls, margin


def _areas(body: Body, solution: Solution, stream, flow: Flow):
    """Drag areas in the free stream, or in the developed slipstream (twice the disk's mean velocity) of a rotor."""
    d = body.drag
    pressure = jnp.ones_like(d.area)
    if solution.wake is not None:
        behind = (1.0 + 2.0 * SLIPSTREAM * jnp.mean(solution.wake.axial, axis=1)) ** 2 - 1.0
        pressure = pressure + d.rotor_share @ behind
    force = jnp.sum(d.area * pressure) * stream
    arm = jnp.sum(d.area * pressure * (d.z - flow.point[2]))
    return force, jnp.stack([jnp.zeros_like(arm), arm * stream[0], jnp.zeros_like(arm)])


def _hub_loads(rotors, plan, solution: Solution, flow: Flow):
    """Hub force (N) and moment about the point (N m) of all rotors, mirrored ones included."""
    force, moment = solution.rotors.force, solution.rotors.moment
    about = moment + jnp.cross(rotors.hub - flow.point, force)
    if plan.sides == 1:
        return jnp.sum(force, axis=0), jnp.sum(about, axis=0)
    keep = jnp.asarray([2.0, 0.0, 2.0])
    return keep * jnp.sum(force, axis=0), (2.0 - keep) * jnp.sum(about, axis=0)


def _alphadot(system, x, solution, gamma_by, surfaces, *, plan, rotors, body, flow, tail):
    """Derivatives by alphadot c / 2V: the tail meets the downwash of a wing that was at alpha - alphadot dx / V."""
    if tail is None or system.lattice is None:
        return jax.tree.map(jnp.zeros_like, Coefficients(*[jnp.zeros(())] * 5))
    counts = [p.collocation.shape[0] * p.collocation.shape[1] for p in system.panels]
    first, last = sum(counts[:tail]), sum(counts[: tail + 1])
    wing = slice(0, counts[0])
    distance = system.lattice.collocation[first:last, 0] - jnp.mean(system.panels[0].strip_edges[:, 0])
    downwash = system.lattice.matrix[first:last, wing] @ gamma_by[wing, 0]
    late = DOWNWASH_LAG * 2.0 * distance / body.c * downwash
    rhs = jnp.zeros_like(solution.gamma).at[first:last].set(late)
    response = solve(system.lattice, rhs)

    def forces(step):
        moved = solution._replace(gamma=solution.gamma + step * response)
        return _coefficients(system, x, moved, surfaces, plan=plan, rotors=rotors, body=body, flow=flow)[0]

    return jax.jvp(forces, (jnp.zeros(()),), (jnp.ones(()),))[1]
