"""Aerodynamics of a whole aircraft in symmetric flow: coefficients, drag build-up, derivatives, loads."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Body, Flow, RotorPlan, StripPolar, Surface
from hera_om.physics.coupling import SLIPSTREAM, Controls, Response, Setting, onset, panel_layout, respond
from hera_om.physics.disks import Wake, mean_slipstreams
from hera_om.physics.lattice import Lattice, solve
from hera_om.physics.lattice_forces import (
    StripLoads,
    filament_force_change,
    filament_forces,
    filament_strengths,
    half_resultant,
    strip_loads,
    trefftz,
)
from hera_om.physics.layout import Layout
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

    surfaces: StripLoads | None  # strips of all surfaces, wing first
    rotors: RotorSolution | None


class AeroResult(NamedTuple):
    """Outcome of `evaluate`. Derivatives are by alpha, q_hat, delta_e and blade pitch, per radian."""

    total: Coefficients
    derivatives: Coefficients  # each [3 + g]
    thrust_by: Float[Array, "m s"]  # of each starboard rotor, N
    alphadot: Coefficients  # by alphadot c / 2V
    drag: DragParts
    lift_margin: Array  # least of cl_max - |cl| over the strips
    cl_strips: Float[Array, " s"]  # section lift coefficients on the local dynamic pressure, wing first
    loads: Loads
    wake: Wake | None
    residual: Array  # of the coupling, over the flight speed
    inverse: Float[Array, "u u"]  # of the Jacobian of the coupling, for `coupling.carry_derivatives`


def evaluate(
    flat: Float[Array, " u"],
    x: Controls,
    surfaces: list[Surface],
    *,
    at: Setting,
    plan: RotorPlan | None,
    body: Body,
    tail: int | None,
    phi=None,
) -> AeroResult:
    """Everything at one state, with the derivatives by the state at equilibrium of lattice and rotors.

    The response of lattice and rotors is differentiated by the state and by the unknowns of the coupling, the
    implicit function theorem joins both, and the forces are differentiated along the directions that result.

    The alpha-dot derivatives are INTERIM: quasi-steady flow in which the wing's circulation, as the tail sees
    it, is late by the time of flight from the wing (the lag of downwash, Etkin & Reid, Dynamics of Flight 3e,
    section 5.5), computed with the lattice's own downwash. Apparent mass and the wing's own unsteady wake are
    left out.

    Args:
        flat: equilibrium from `coupling.find_root` or `coupling.carry_derivatives`.
        x: state.
        surfaces: the surfaces of the system; the first one is the wing.
        at: system, rotors, stream and reference chord.
        plan: static facts of the rotors, or None.
        body: reference quantities and what the lattice does not carry.
        tail: index of the surface in the wing's downwash, or None.
        phi: inflow angles of the blade elements at equilibrium.

    Returns:
        AeroResult.
    """
    n, size, lay = flat.shape[0], x.theta.shape[0], panel_layout(surfaces)
    polar = _strip_polars(surfaces, lay)
    state = jnp.concatenate([flat, jnp.stack([x.alpha, x.q_hat, x.delta_e]), x.theta])

    def at_state(v):
        return Controls(v[0], v[1], v[2], v[3 : 3 + size])

    def answer_to(v):
        answer = respond(v[:n], at_state(v[n:]), at, plan, phi)
        return answer, answer

    by, answer = jax.jacfwd(answer_to, has_aux=True)(state)
    if n:
        inverse = jnp.linalg.inv(by.flat[:, :n] - jnp.eye(n))
        shift = -inverse @ by.flat[:, n:]
        by = jax.tree.map(lambda d: d[..., n:] + d[..., :n] @ shift, by)
    else:
        inverse = jnp.zeros((0, 0))

    def forces(step):
        moved = jax.tree.map(lambda value, slope: value + slope @ step, answer, by)
        total, rest = _coefficients(at_state(state[n:] + step), moved, polar, at=at, plan=plan, body=body, lay=lay)
        return total, (total, rest)

    derivatives, (total, rest) = jax.jacfwd(forces, has_aux=True)(jnp.zeros(3 + size))
    drag, cl, margin, wing, local = rest
    alphadot = _alphadot(local, x, answer, by.gamma[:, 0], at=at, body=body, tail=tail, lay=lay)
    return AeroResult(
        total=total,
        derivatives=derivatives,
        thrust_by=jnp.zeros((0, 3 + size)) if by.loads is None else by.loads.thrust,
        alphadot=alphadot,
        drag=drag,
        lift_margin=margin,
        cl_strips=cl,
        loads=Loads(wing, answer.loads),
        wake=answer.wake,
        residual=jnp.max(jnp.abs(answer.flat - flat), initial=0.0),
        inverse=inverse,
    )


def _coefficients(x: Controls, answer: Response, polar: StripPolar, *, at: Setting, plan, body: Body, lay: Layout):
    """Coefficients and everything that hangs on the same forces."""
    flow, system = at.flow, at.system
    stream, up = _wind_axes(x.alpha)
    force = moment = profile_force = local = jnp.zeros(3)
    cl, margin, wing = jnp.zeros(0), jnp.asarray(jnp.inf), None
    induced = slip = trace = jnp.zeros(())
    if system.lattice is not None:
        lattice = system.lattice
        wash = jnp.zeros_like(lattice.points)
        if plan is not None and at.rotors is not None and answer.wake is not None:
            wash = SLIPSTREAM * mean_slipstreams(at.rotors, plan, answer.wake, lattice.middles, lattice.arms)
        local = onset(lattice.points, x, c=at.c, point=flow.point) + wash
        loads = strip_loads(lattice, lay, filament_forces(lattice, lay, answer.gamma, local))
        drag, cl, margin = _profile(lattice, lay, loads, local, polar, flow)
        wing = loads._replace(force=loads.force + drag)
        force, moment = half_resultant(wing, flow.point)
        profile_force, _ = half_resultant(loads._replace(force=drag), flow.point)
        by_wash = jnp.cross(wash, lattice.arms) @ stream
        slip = 4.0 * filament_strengths(lay, answer.gamma) @ by_wash / body.S
        induced = (force - profile_force) @ stream / body.S - slip
        trace = trefftz(lattice, lay, answer.gamma)[1] / body.S
    area_force, area_moment = _areas(body, answer, stream, flow)
    force, moment = force + area_force, moment + area_moment
    everything, cm = force / body.S, moment[1] / (body.S * body.c) + body.munk_slope * x.alpha
    if plan is not None and answer.loads is not None:
        hub_force, hub_moment = _hub_loads(at.rotors, plan, answer.loads, flow)
        q_S = 0.5 * flow.density * flow.speed**2 * body.S
        everything, cm = everything + hub_force / q_S, cm + hub_moment[1] / (q_S * body.c)
    total = Coefficients(force @ up / body.S, force @ stream / body.S, everything[0], everything[2], cm)
    parts = DragParts(trace, induced, slip, profile_force @ stream / body.S, area_force @ stream / body.S)
    return total, (parts, cl, margin, wing, local)


def _wind_axes(alpha):
    """Unit vectors along drag and lift."""
    zero = jnp.zeros_like(alpha)
    return jnp.stack([jnp.cos(alpha), zero, jnp.sin(alpha)]), jnp.stack([-jnp.sin(alpha), zero, jnp.cos(alpha)])


def _strip_polars(surfaces: list[Surface], lay: Layout) -> StripPolar:
    """Polars of all strips, one array a number."""
    rows = [jax.tree.map(lambda v, k=k: jnp.full(k, v), s.polar) for s, k in zip(surfaces, lay.strips, strict=True)]
    return jax.tree.map(lambda *parts: jnp.concatenate(parts), *rows) if rows else StripPolar(*[jnp.zeros(0)] * 5)


def _profile(lattice: Lattice, lay: Layout, loads: StripLoads, velocity, polar: StripPolar, flow: Flow):
    """Profile drag of every strip in its own stream, section lift coefficients, least margin to cl_max.

    The stream of a strip is the mean over its bound filaments, without the lattice's own induction.
    """
    bound = np.flatnonzero(lay.share == 1.0)
    rows = np.bincount(lay.inner[bound])[:, None]
    local = jnp.zeros_like(loads.force).at[lay.inner[bound]].add(velocity[bound]) / rows
    q = jnp.sum(local**2, axis=-1)
    up = jnp.cross(local, lattice.strip_edge)
    up = up / jnp.linalg.norm(up, axis=-1, keepdims=True)
    area = lattice.strip_chord * lattice.strip_width
    cl = jnp.sum(loads.force * up, axis=-1) / (q * area)
    scale = jnp.where(flow.speed > 0, flow.density * flow.speed / flow.viscosity, polar.re / lattice.strip_chord)
    reynolds = scale * jnp.sqrt(q) * lattice.strip_chord
    cd = section_profile_drag(
        cl, reynolds, cd_min=polar.cd_min, cl_at_cd_min=polar.cl_at_cd_min, k=polar.k, re_ref=polar.re
    )
    return (cd * jnp.sqrt(q) * area)[:, None] * local, cl, jnp.min(polar.cl_max - jnp.abs(cl))


def _areas(body: Body, answer: Response, stream, flow: Flow):
    """Drag areas in the free stream, or in a rotor's developed slipstream, twice its mean velocity."""
    d = body.drag
    pressure = jnp.ones_like(d.area)
    if answer.wake is not None:
        behind = (1.0 + 2.0 * SLIPSTREAM * jnp.mean(answer.wake.axial, axis=1)) ** 2 - 1.0
        pressure = pressure + d.rotor_share @ behind
    force = jnp.sum(d.area * pressure) * stream
    arm = jnp.sum(d.area * pressure * (d.z - flow.point[2]))
    return force, jnp.stack([jnp.zeros_like(arm), arm * stream[0], jnp.zeros_like(arm)])


def _hub_loads(rotors, plan, loads: RotorSolution, flow: Flow):
    """Hub force (N) and moment about the point (N m) of all rotors, mirrored ones included."""
    force = loads.force
    about = loads.moment + jnp.cross(rotors.hub - flow.point, force)
    if plan.sides == 1:
        return jnp.sum(force, axis=0), jnp.sum(about, axis=0)
    keep = jnp.asarray([2.0, 0.0, 2.0])
    return keep * jnp.sum(force, axis=0), (2.0 - keep) * jnp.sum(about, axis=0)


def _alphadot(local, x: Controls, answer: Response, gamma_alpha, *, at: Setting, body: Body, tail, lay: Layout):
    """Derivatives by alphadot c / 2V: the tail meets the downwash of a wing at alpha - alphadot dx / V."""
    if tail is None or at.system.lattice is None:
        return Coefficients(*[jnp.zeros(())] * 5)
    lattice, flow, wing = at.system.lattice, at.flow, lay.counts[0]
    first, last = sum(lay.counts[:tail]), sum(lay.counts[: tail + 1])
    distance = lattice.collocation[first:last, 0] - jnp.mean(lattice.strip_point[: lay.strips[0], 0])
    downwash = lattice.matrix[first:last, :wing] @ gamma_alpha[:wing]
    late = DOWNWASH_LAG * 2.0 * distance / body.c * downwash
    response = solve(lattice, jnp.zeros_like(answer.gamma).at[first:last].set(late))
    change = filament_force_change(lattice, lay, answer.gamma, local, response)
    force, moment = half_resultant(strip_loads(lattice, lay, change), flow.point)
    stream, up = _wind_axes(x.alpha)
    force = force / body.S
    return Coefficients(force @ up, force @ stream, force[0], force[2], moment[1] / (body.S * body.c))
