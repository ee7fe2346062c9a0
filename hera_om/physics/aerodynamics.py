"""Aerodynamics of a whole aircraft: coefficients, drag build-up, derivatives, loads."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Body, Flow, RotorPlan
from hera_om.physics.coupling import (
    SLIPSTREAM,
    Controls,
    Response,
    Setting,
    body_motion,
    onset,
    sides,
    turned,
    wind,
)
from hera_om.physics.disks import Wake
from hera_om.physics.equilibrium import Equilibrium, as_vector
from hera_om.physics.lattice import Lattice, both_parts, induced
from hera_om.physics.lattice_forces import (
    StripLoads,
    both_halves,
    filament_forces,
    filament_strengths,
    panel_pressure,
    resultant,
    strip_loads,
    trefftz,
)
from hera_om.physics.layout import Layout
from hera_om.physics.rotor import RotorSolution
from hera_om.physics.slender_body import body_loads
from hera_om.physics.strip_polar import StripPolar, StripState, StripTable, stall_guard, strip_states
from hera_om.physics.thickness import buoyancy
from hera_om.physics.unsteady_lattice import plunge_rate, unsteady_resultant

Polars = Sequence[StripPolar | StripTable]
STILL_REYNOLDS = 1e6
"""Reynolds number by length, 1/m, where the air stands still: no force follows from it."""
FAR = 1e3
"""Margin to stall of a strip that is not there."""


class Coefficients(NamedTuple):
    """Force and moment coefficients; CL CD leave the rotors' hub loads out, the others hold everything."""

    CL: Array
    CD: Array
    CX: Array
    CZ: Array
    Cm: Array
    CY: Array
    Cl: Array
    Cn: Array


class Shares(NamedTuple):
    """Parts of the coefficients: of each lifting surface, the fuselage with all drag areas, the rotors' hub loads.

    Of the parts p the surfaces stand first in their order; rotors are the last part, if there are any. Each field
    sums up to the total of `Coefficients`.
    """

    CX: Array
    CZ: Array
    Cm: Array
    CY: Array
    Cl: Array
    Cn: Array


class DragParts(NamedTuple):
    """Drag coefficients on the reference area."""

    CDi: Array  # from the Trefftz plane, circulation alone
    CDi_near: Array  # from the near field, circulation alone
    CD_slipstream: Array  # of the slipstreams' velocities on circulation and thickness; negative: swirl recovered
    CD_profile: Array
    CD_areas: Array


class Loads(NamedTuple):
    """Loads for the structure, starboard half, over dynamic pressure; and the rotors."""

    surfaces: StripLoads | None  # strips of all surfaces, wing first
    rotors: RotorSolution | None
    every: RotorSolution | None  # the rotors of each solved half


class Stall(NamedTuple):
    """Where local lift comes nearest to the end of its polar, or leaves it farthest; None without a lattice."""

    margin: Array  # least margin of the section lift coefficients, negative beyond the polar
    smooth: Array  # the same as a smooth minimum, never above it
    surface: Array  # index of the surface
    y: Array  # of the strip, m; negative on the port half


class AeroResult(NamedTuple):
    """Outcome of `evaluate`. Derivatives are by alpha, q_hat, delta, theta and lateral of `Controls`, per radian."""

    total: Coefficients
    derivatives: Coefficients  # each [2 + k + g + l]
    parts: Shares  # each [p]
    parts_by: Shares  # each [p, 2 + k + g + l]
    thrust_by: Float[Array, "m s"]  # of each starboard rotor, N
    alphadot: Coefficients  # by alphadot c / 2V
    betadot: Coefficients  # by betadot b / 2V
    drag: DragParts
    stall: Stall | None
    cl_strips: Float[Array, " s"]  # section lift coefficients on the local dynamic pressure, wing first
    pressure: Float[Array, "h n"]  # differences on the panels of each half, see `lattice_forces.panel_pressure`
    loads: Loads
    wake: Wake | None
    residual: Array  # of the coupling, over the flight speed


def evaluate(
    found: Equilibrium, x: Controls, polars: Polars, *, at: Setting, plan: RotorPlan | None, body: Body, lay: Layout
) -> AeroResult:
    """Everything at one state, with the derivatives by the state at equilibrium of lattice and rotors.

    The forces are differentiated along the directions in which the equilibrium moves with the state.

    Args:
        found: equilibrium from `equilibrium.settle` or `equilibrium.carried`.
        x: state.
        polars: of the surfaces of the system; the first one is the wing.
        at: system, rotors, stream, reference chord and span.
        plan: static facts of the rotors, or None.
        body: reference quantities and what the lattice does not carry.
        lay: index arrays of the surfaces' panels, see `coupling.panel_layout`.

    Returns:
        AeroResult.
    """
    answer, by = found.answer, found.by
    first, unpack = as_vector(x)

    def forces(step):
        moved = jax.tree.map(lambda value, slope: value + slope @ step, answer, by)
        total, parts, rest = _coefficients(unpack(first + step), moved, polars, at=at, plan=plan, body=body, lay=lay)
        return (total, parts), (total, parts, rest)

    (derivatives, parts_by), (total, parts, rest) = jax.jacfwd(forces, has_aux=True)(jnp.zeros_like(first))
    drag, cl, stall, wing, filaments, local = rest
    rates = {"at": at, "body": body, "lay": lay}
    column = first.shape[0] - x.lateral.shape[0]  # of sideslip
    cells = at.system.cells
    return AeroResult(
        total=total,
        derivatives=derivatives,
        parts=parts,
        parts_by=parts_by,
        thrust_by=jnp.zeros((0, first.shape[0])) if by.loads is None else by.loads.thrust[0],
        alphadot=_alphadot(local, x, answer, by.gamma[..., 0], **rates),
        betadot=_betadot(local, answer, by.gamma[..., column], **rates) if x.lateral.shape[0] else _zeros(),
        drag=drag,
        stall=stall,
        cl_strips=cl,
        pressure=jnp.stack([panel_pressure(lay, f, cells) for f in filaments]) if cells else jnp.zeros((0, 0)),
        loads=Loads(wing, None if answer.loads is None else jax.tree.map(lambda v: v[0], answer.loads), answer.loads),
        wake=None if answer.wake is None else jax.tree.map(lambda v: v[0], answer.wake),
        residual=found.residual,
    )


def _coefficients(x: Controls, answer: Response, polars: Polars, *, at: Setting, plan, body: Body, lay: Layout):
    """Coefficients, in all and by part, and everything that hangs on the same forces."""
    at = turned(at, x)
    flow, stream = at.flow, wind(x)
    up = jnp.stack([-jnp.sin(x.alpha), jnp.zeros_like(x.alpha), jnp.cos(x.alpha)])
    profile_force = local = jnp.zeros(3)
    forces: list[Array] = []
    moments: list[Array] = []
    cl, stall, wing, filaments = jnp.zeros(0), None, None, []
    induced_drag = slip = trace = jnp.zeros(())
    if at.system.lattice is not None:
        halves, local = _half_loads(x, answer, polars, at=at, lay=lay)
        wing, cl, filaments = halves[0].loads, halves[0].state.cl, [h.filaments for h in halves]
        stall = _stall(at.system.lattice, lay, [h.state for h in halves])
        forces, moments = _surface_loads([h.loads for h in halves], lay, flow.point)
        profile_force = both_halves([jnp.sum(h.profile, axis=0) for h in halves])
        slip = (halves[0].slip + halves[-1].slip) / body.S
        induced_drag = (jnp.sum(jnp.stack(forces), axis=0) - profile_force) @ stream / body.S - slip
        trace = _trace_drag(at.system.lattice, lay, answer.gamma) / body.S
    area_force, area_moment = _areas(body, answer, stream, flow)
    force, moment = area_force, area_moment + body.S * body.c * body.munk_slope * _pitching(x)
    if at.system.slender is not None and answer.upwash is not None:
        shell = at.system.slender.body
        loads = body_loads(
            shell.shape, flow=body_motion(x, at), root=shell.root, x_tail=shell.x_tail, induced=answer.upwash
        )
        force = force + loads.force
        moment = moment + loads.moment + _transfer(loads.force, flow.point)
    forces, moments = [*forces, force], [*moments, moment]
    lift = jnp.sum(jnp.stack(forces), axis=0)
    if plan is not None and answer.loads is not None:
        hub_force, hub_moment = _hub_loads(at.rotors, plan, answer.loads, flow)
        q = 0.5 * flow.density * flow.speed**2
        forces, moments = [*forces, hub_force / q], [*moments, hub_moment / q]
    shares = _shares(jnp.stack(forces), jnp.stack(moments), body)
    total = Coefficients(CL=lift @ up / body.S, CD=lift @ stream / body.S, **jax.tree.map(jnp.sum, shares)._asdict())
    parts = DragParts(trace, induced_drag, slip, profile_force @ stream / body.S, area_force @ stream / body.S)
    return total, shares, (parts, cl, stall, wing, filaments, local)


def _shares(force: Float[Array, "p 3"], moment: Float[Array, "p 3"], body: Body) -> Shares:
    """Coefficients of parts from their forces and moments over dynamic pressure."""
    F, M = force.T / body.S, moment.T / body.S
    return Shares(F[0], F[2], M[1] / body.c, F[1], -M[0] / body.b, -M[2] / body.b)


def _surface_loads(halves: list[StripLoads], lay: Layout, point) -> tuple[list[Array], list[Array]]:
    """Force and moment of every surface over dynamic pressure, see `lattice_forces.resultant`."""
    ends = np.cumsum([0, *lay.strips])
    pairs = []
    for a, b in pairwise(ends):
        own = lay._replace(weight=lay.weight[a:b], image=lay.image[a:b])
        pairs.append(resultant([StripLoads(*[v[a:b] for v in h]) for h in halves], own, point))
    return [force for force, _ in pairs], [moment for _, moment in pairs]


def _transfer(force, point):
    """Moment of a force on the fuselage's axis about a point at another height or beside it."""
    return jnp.cross(-point * jnp.asarray([0.0, 1.0, 1.0]), force)


def _pitching(x: Controls):
    """Munk's moment turns about the axis across the body and the stream; yawing changes the sign."""
    beta = x.lateral[0] if x.lateral.shape[0] else jnp.zeros(())
    return jnp.stack([jnp.zeros(()), x.alpha, beta])


class HalfLoads(NamedTuple):
    """What one half carries, over dynamic pressure."""

    loads: StripLoads  # profile drag and the drag of thickness in slipstreams included
    profile: Float[Array, "s 3"]  # force of the profile drag that belongs to the half, m^2
    slip: Array  # drag of the slipstreams' velocities on circulation and thickness, m^2
    filaments: Float[Array, "e 3"]  # forces on the filaments, m^2
    state: StripState


def _half_loads(x: Controls, answer: Response, polars: Polars, *, at: Setting, lay: Layout):
    """Loads of each half, and the mirrored part of the velocity at the filaments that turns strengths into forces."""
    lattice, flow, halves = at.system.lattice, at.flow, sides(x)
    assert lattice is not None
    wash = jnp.zeros((len(halves), *lattice.points.shape)) if answer.wash is None else answer.wash
    own = induced(lattice.even.velocity, None if lattice.odd is None else lattice.odd.velocity, answer.gamma)
    odd = both_parts(list(answer.gamma))[1]
    out, locals_ = [], []
    for i, side in enumerate(halves):
        local = onset(lattice.points, x, at, side) + wash[i]
        faster = 1.0 + wash[i] @ wind(x, side)  # circulations and what they induce, from strengths: see `circulation`
        strength = filament_strengths(lay, answer.gamma[i], None if odd is None else side * odd) / faster
        full = local + own[i] / faster[:, None]
        forces = filament_forces(lattice, strength, full)
        loads = strip_loads(lattice, lay, forces)
        drag, state = _profile(lattice, lay, loads, local, polars, flow)
        weight = jnp.asarray(lay.share * lay.weight[lay.inner] + (1.0 - lay.share) * lay.weight[lay.outer])
        slip = 2.0 * (weight * strength) @ (jnp.cross(wash[i], lattice.arms) @ wind(x, side))
        here = jnp.asarray(lay.weight * (lay.image if side < 0 else 1.0))
        thick = _on_thickness(at, lay, wash[i] @ wind(x, side))
        slip = slip + jnp.asarray(lay.weight) @ thick
        carried = loads.force + drag + thick[:, None] * wind(x, side)
        out.append(HalfLoads(loads._replace(force=carried), here[:, None] * drag, slip, forces, state))
        locals_.append(full / faster[:, None])
    return out, both_parts(locals_)[0]


def _on_thickness(at: Setting, lay: Layout, along: Float[Array, " e"]) -> Float[Array, " s"]:
    """Force of slipstreams along the stream on the thickness of every strip, over dynamic pressure, m^2."""
    lattice, thickness = at.system.lattice, at.system.thickness
    assert lattice is not None
    if thickness is None:
        return jnp.zeros_like(lattice.strip_chord)
    bound = np.flatnonzero(lay.share == 1.0)
    strip = lay.inner[bound]
    force = buoyancy(thickness.growth, lattice.strip_width[strip], along[bound], mach=at.flow.mach)
    return jnp.zeros_like(lattice.strip_chord).at[strip].add(force)


def _stall(lattice: Lattice, lay: Layout, halves: list[StripState]) -> Stall:
    """The stall guard over the strips of both halves; strips without an image count once."""
    there = [np.ones(len(lay.image), bool), lay.image.astype(bool)][: len(halves)]
    margin = jnp.concatenate([jnp.where(t, h.margin, FAR) for t, h in zip(there, halves, strict=True)])
    y = jnp.concatenate([side * lattice.strip_point[:, 1] for side in (1.0, -1.0)[: len(halves)]])
    found = stall_guard(margin, lay.strips * len(halves), y)
    return Stall(found.least, found.smooth, found.surface % len(lay.strips), found.y)


def _trace_drag(lattice: Lattice, lay: Layout, gamma: Float[Array, "h n"]):
    """Induced drag from the Trefftz plane, mirrored and reversed flow together, m^2."""
    even, odd = both_parts(list(gamma))
    drag = trefftz(lattice, lay, even)[1]
    return drag if odd is None else drag + trefftz(lattice, lay, odd, odd=True)[1]


def _profile(lattice: Lattice, lay: Layout, loads: StripLoads, velocity, polars: Polars, flow: Flow):
    """Profile drag of every strip in its own stream, and what its polar says.

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
    unit = jnp.where(flow.speed > 0, flow.density * flow.speed / flow.viscosity, STILL_REYNOLDS)
    reynolds = unit * jnp.sqrt(q) * lattice.strip_chord
    state = strip_states(polars, lay.strips, cl, reynolds=reynolds, mach=flow.mach)
    return (state.cd * jnp.sqrt(q) * area)[:, None] * local, state


def _areas(body: Body, answer: Response, stream, flow: Flow):
    """Drag areas in the free stream, or in a rotor's developed slipstream, twice its mean velocity."""
    d = body.drag
    pressure = jnp.ones_like(d.area)
    if answer.wake is not None:
        mean = jnp.mean(answer.wake.axial, axis=(0, 2))
        pressure = pressure + d.rotor_share @ ((1.0 + 2.0 * SLIPSTREAM * mean) ** 2 - 1.0)
    drag = d.area * pressure
    arms = jnp.stack([d.x - flow.point[0], jnp.zeros_like(d.x) - flow.point[1], d.z - flow.point[2]], axis=-1)
    return jnp.sum(drag) * stream, jnp.cross(drag @ arms, stream)


def _hub_loads(rotors, plan, loads: RotorSolution, flow: Flow):
    """Hub force (N) and moment about the point (N m) of all rotors, mirrored ones included."""
    mirror = jnp.asarray([1.0, 0.0, 1.0]) if plan.sides == 2 else jnp.ones(3)
    centre = flow.point * mirror
    force = [jnp.sum(f, axis=0) for f in loads.force]
    about = [
        jnp.sum(m + jnp.cross(rotors.hub - centre, f), axis=0) for f, m in zip(loads.force, loads.moment, strict=True)
    ]
    if plan.sides == 1:
        return force[0], about[0]
    total = both_halves(force)
    return total, both_halves(about, axial=True) - jnp.cross(flow.point - centre, total)


def _zeros() -> Coefficients:
    """No derivatives."""
    return Coefficients(*[jnp.zeros(())] * 8)


def _alphadot(local, x: Controls, answer: Response, gamma_by, *, at: Setting, body: Body, lay: Layout):
    """Derivatives by alphadot c / 2V in pure plunging, see `unsteady_lattice.plunge_rate`; zero without its half."""
    lattice, zero = at.system.lattice, jnp.zeros(())
    if lattice is None or lattice.whole is not None:
        return _zeros()
    slope = both_parts(list(gamma_by))[0]
    loads = plunge_rate(lattice, at.system.panels, lay, gamma_by=slope, length=body.c, **_mean(local, answer, at))
    force, moment = unsteady_resultant(lattice, loads, at.flow.point)
    force = force / body.S
    stream = jnp.stack([jnp.cos(x.alpha), zero, jnp.sin(x.alpha)])
    up = jnp.stack([-stream[2], zero, stream[0]])
    cm = moment[1] / (body.S * body.c)
    return Coefficients(force @ up, force @ stream, force[0], force[2], cm, zero, zero, zero)


def _betadot(local, answer: Response, gamma_by, *, at: Setting, body: Body, lay: Layout) -> Coefficients:
    """The same by betadot b / 2V in plunging sideways: side force, rolling and yawing moment."""
    lattice = at.system.lattice
    if lattice is None or lattice.whole is not None:
        return _zeros()
    slope = both_parts(list(gamma_by))[1]
    assert slope is not None
    loads = plunge_rate(
        lattice, at.system.panels, lay, gamma_by=slope, length=body.b, odd=True, **_mean(local, answer, at)
    )
    force, moment = unsteady_resultant(lattice, loads, at.flow.point, odd=True)
    roll, yaw = -moment[0] / (body.S * body.b), -moment[2] / (body.S * body.b)
    return _zeros()._replace(CY=force[1] / body.S, Cl=roll, Cn=yaw)


def _mean(local, answer: Response, at: Setting):
    """The mirrored part of the flow, about which rates are small."""
    return {"gamma": both_parts(list(answer.gamma))[0], "velocity": local, "mach": at.flow.mach}
