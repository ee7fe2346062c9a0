"""Lattice and rotors solved together: slipstream on the surfaces, upwash of the surfaces at the disks.

The lattice is linear in the velocities of the slipstreams, so the coupled system reduces to the rotors'
unknowns: the mean induced velocities of every annulus (two numbers by rotor and radius) and its force across the shaft.

In lateral flow everything has a leading axis of two halves: the starboard one, and the port one as the plane of
symmetry mirrors it. There sideslip, roll and yaw rate change their signs and each command takes the sign of its
port half, so that the geometry of the starboard half serves both.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import Flow, Model, RotorPlan, Rotors, Slender, Surface
from hera_om.physics.blown_lattice import Blown, make_blown, solve_blown
from hera_om.physics.controls import controlled_panels
from hera_om.physics.disks import (
    Found,
    Wake,
    at_other_disks,
    disk_points,
    mean_slipstreams,
    rotor_loads,
    slipstream_edges,
    wake_behind,
)
from hera_om.physics.finite_jet import JetEdges, chord_shares
from hera_om.physics.geometry import FLAT, Grid, Panels, surface_mesh
from hera_om.physics.lattice import (
    MIRROR,
    Lattice,
    assemble,
    both_parts,
    by_symmetry,
    induced,
    marked,
    prandtl_glauert,
    present,
    solve,
)
from hera_om.physics.lattice_forces import pressure_cells
from hera_om.physics.layout import FREE, PLANE, ROOTED, Layout, layout
from hera_om.physics.rotor import RotorSolution
from hera_om.physics.slender_body import BodyField, Crossflow, axis_points, body_field, crossflow, mean_body_field
from hera_om.physics.strips import met_strips
from hera_om.physics.thickness import THICKNESS, on_panels, source_lines, source_velocity, strip_growth

SLIPSTREAM = 1.0
"""Share of the slipstream that reaches the surfaces; 0 leaves the rotors only their hub forces."""
UPWASH = 1.0
"""Share of what surfaces and a slender fuselage induce that reaches the disks."""
NEIGHBOURS = 1.0
"""Share of a rotor's slipstream that reaches other rotors."""
FINITE_JET = 1.0
"""Share of what the edges of a slipstream do to the lift of surfaces."""
MIRRORED = (ROOTED, FREE)
"""Kinds of surfaces that have an image in the plane of symmetry."""


class SlenderInfluence(NamedTuple):
    """What a slender fuselage and the lattice do to each other."""

    body: Slender
    field: BodyField  # of the body at the collocation points
    upwash: Float[Array, "m n"]  # z velocity at `slender_body.axis_points` per unit circulation, mirrored flow
    at_disks: BodyField  # of the body at the blade elements


class Thickness(NamedTuple):
    """Flow of the thickness of surfaces with an image, and where slipstreams act on it."""

    at_disks: Array  # velocity over the flight speed at the blade elements, m nr npsi 3
    growth: Float[Array, " n"]  # of thickness by panel, m


class System(NamedTuple):
    """Everything that does not depend on incidence, rates, controls or blade pitch."""

    lattice: Lattice | None
    # velocity at the blade elements per unit circulation, m nr npsi 3 n: in mirrored flow, in reversed flow
    disk_velocity: tuple[Array | None, Array | None]
    wing_edges: Array | None  # [ns + 1] y of the edges of the first surface's strips, m
    panels: tuple[Panels, ...] = ()
    cells: tuple[Float[Array, "_ _ 3"], ...] = ()  # see `lattice_forces.pressure_cells`
    slender: SlenderInfluence | None = None
    blown: Blown | None = None  # absent without rotors
    thickness: Thickness | None = None
    mirrored: Array | None = None  # 1 for every surface with an image, else 0
    wake_angle: Array | None = None  # of a wake along the stream, rad; absent: along x
    turn: Any = None  # derivative of all this by that angle, without factors


def split_factors(system: System) -> tuple[System, tuple]:
    """A system without its factorisations, which carry no derivatives, and the factorisations."""
    lattice = system.lattice
    if lattice is None:
        return system, ()
    factors = tuple(None if part is None else part.lu for part in (lattice.even, lattice.odd, lattice.whole))
    return join_factors(system, tuple(None if f is None else () for f in factors)), factors


def join_factors(system: System, factors: tuple) -> System:
    """The inverse of `split_factors`."""
    lattice = system.lattice
    if lattice is None:
        return system
    even, odd, whole = factors
    return system._replace(
        lattice=lattice._replace(
            even=lattice.even._replace(lu=even),
            odd=None if lattice.odd is None else lattice.odd._replace(lu=odd),
            whole=None if lattice.whole is None else lattice.whole._replace(lu=whole),
        )
    )


class Controls(NamedTuple):
    """The state that derivatives are taken by."""

    alpha: Array  # rad
    q_hat: Array  # q c / 2V
    delta: Float[Array, " k"]  # commands, rad
    theta: Float[Array, " g"]  # blade pitch of the rotor groups at 75 % radius, rad
    lateral: Float[Array, " l"]  # beta (rad), p_hat = p b / 2V, r_hat = r b / 2V; empty in mirrored flow


class Response(NamedTuple):
    """Lattice and rotors for given induced velocities."""

    flat: Float[Array, " u"]  # induced velocities that the rotors answer with
    gamma: Float[Array, "h n"]  # lift by span of each half over density and square of the flight speed, m
    loads: RotorSolution | None
    wake: Wake | None
    upwash: Array | None = None  # of the lattice at the axis of a slender fuselage
    wash: Float[Array, "h e 3"] | None = None  # of the slipstreams at the filaments, if asked for


class Jets(NamedTuple):
    """What slipstreams do at the collocation points of each half, one by one (axis k) or together."""

    velocity: Float[Array, "h *k n 3"]  # over the flight speed
    edges: tuple[JetEdges, ...]  # at the strips of each surface, each "h *k s *u"


class Washes(NamedTuple):
    """What slipstreams do, one by one (axis k) or together."""

    jets: Jets | None  # none without surfaces
    disks: Float[Array, "h *k m nr npsi 3"] | None  # velocity at the disks of other rotors
    filaments: Float[Array, "h *k e 3"] | None  # velocity at the filaments, if asked for


class Setting(NamedTuple):
    """Arrays that surround the state; all of them can carry derivatives."""

    system: System
    rotors: Rotors | None
    flow: Flow
    c: Array | float  # reference chord, m
    b: Array | float  # reference span, m


def make_system(
    surfaces: list[Surface],
    rotors: Rotors | None,
    plan: RotorPlan | None,
    mach,
    model: Model,
    slender: Slender | None = None,
    alpha=None,
) -> System:
    """Panels, factorised lattice, its influence on the disks and on the axis of a slender fuselage.

    With a wake along the stream all of it depends on the incidence ``alpha``: its derivative stands in ``turn``,
    so that derivatives by the state hold it too (`turned`).
    """
    if not model.stream_wake:
        return _straight_system(surfaces, rotors, plan, mach, model, slender, None)

    def build(angle):
        return split_factors(_straight_system(surfaces, rotors, plan, mach, model, slender, angle))

    angle = jnp.asarray(alpha, float)
    bare, turn, factors = jax.jvp(build, (angle,), (jnp.ones(()),), has_aux=True)
    return join_factors(bare, factors)._replace(wake_angle=angle, turn=turn)


def turned(at: Setting, x: Controls) -> Setting:
    """The setting with its wake turned to the stream: no change of values, but of derivatives by incidence."""
    if at.system.turn is None or at.system.wake_angle is None:
        return at
    bare, factors = split_factors(at.system._replace(turn=None, wake_angle=None))
    step = x.alpha - at.system.wake_angle
    moved = jax.tree.map(lambda value, slope: value + step * slope, bare, at.system.turn)
    return at._replace(system=join_factors(moved, factors))


def _straight_system(surfaces, rotors, plan, mach, model: Model, slender: Slender | None, angle) -> System:
    """The system for a wake along x, or at an angle."""
    panels = make_surfaces(surfaces, model)
    if not panels:
        return System(None, (None, None), None)
    edges = panels[0].strip_edges[:, 1]
    how = {"kinds": model.kinds, "lateral": model.lateral, "components": model.components, "wake_angle": angle}
    disks = jnp.zeros((0, 1, 1, 3)) if rotors is None or plan is None else disk_points(rotors, plan)
    axis = jnp.zeros((0, 3))
    if slender is not None:
        axis = axis_points(slender.shape, x_le=slender.root[0], x_tail=slender.x_tail)
    lattice, (even, odd) = assemble(panels, mach, jnp.concatenate([disks.reshape(-1, 3), axis]), **how)
    count = disks[..., 0].size
    at_disks = [None if u is None or not count else u[:count].reshape(*disks.shape[:3], 3, -1) for u in (even, odd)]
    influence = None
    if slender is not None:
        field = mean_body_field(slender.shape, *lattice.across)
        # Of crossflow in sideslip only fins feel the field, see docs/theory/sections_and_body.md.
        fin = jnp.asarray(marked(panels, model.kinds, PLANE))[:, None]
        at_body = body_field(slender.shape, disks.reshape(-1, 3))
        influence = SlenderInfluence(slender, field._replace(by_v=fin * field.by_v), even[count:, 2], at_body)
    cells = tuple(pressure_cells(surface_mesh(s.sections, s.grid, model.shape), s.grid.rear) for s in surfaces)
    blown = None
    if count:
        pairs = zip(surfaces, panels, strict=True)
        shares = [jnp.repeat(_chord_shares(s.grid), p.strip_chord.shape[0], axis=1) for s, p in pairs]
        blown = make_blown(panels, lattice, jnp.concatenate(shares, axis=1))
    mirrored = jnp.asarray([float(kind in MIRRORED) for kind in model.kinds])
    thickness = _thickness(surfaces, panels, model.kinds, disks, jnp.asarray(mach, float)) if count else None
    by_disks = (at_disks[0], at_disks[1])
    return System(lattice, by_disks, edges, tuple(panels), cells, influence, blown, thickness, mirrored)


def _chord_shares(grid: Grid) -> Float[Array, "2 nc"]:
    return chord_shares(*(jnp.asarray(v) for v in (grid.xi, grid.front, grid.rear)))


def _thickness(surfaces: list[Surface], panels: list[Panels], kinds, disks, mach) -> Thickness:
    """Flow of thickness of the surfaces with an image; the others are not in mirrored flow, which would miss theirs."""
    points, mirror, beta = disks.reshape(-1, 3), jnp.asarray(MIRROR), prandtl_glauert(mach)
    flow, every = jnp.zeros_like(points), []
    for surface, own, kind in zip(surfaces, panels, kinds, strict=True):
        if surface.thickness is None or kind not in MIRRORED:
            every.append(jnp.zeros(own.normal[..., 0].size))
            continue
        growth = strip_growth(surface.grid, surface.sections.chord, surface.thickness)
        lines = source_lines(surface.sections, surface.grid, growth, own.strip_width)
        flow += source_velocity(points, lines, beta) + mirror * source_velocity(points * mirror, lines, beta)
        every.append(on_panels(surface.grid, growth))
    return Thickness(THICKNESS * flow.reshape(disks.shape), THICKNESS * jnp.concatenate(every))


def make_surfaces(surfaces: list[Surface], model: Model) -> list[Panels]:
    """Panels of all surfaces."""
    return [
        controlled_panels(
            s.sections, s.grid, model.shape, station=s.station, controls=s.controls, commands=model.commands
        )
        for s in surfaces
    ]


def panel_layout(surfaces: list[Surface], model: Model) -> Layout:
    """Index arrays of the surfaces' panels."""
    cuts = [(s.grid.xi.shape[0] - 1, s.grid.middle.shape[0]) for s in surfaces]
    return layout(cuts, model.kinds, chordwise_loads=model.shape != FLAT)


def sides(x: Controls) -> tuple[float, ...]:
    """+1 for the starboard half, -1 for the port half as the plane mirrors it; the first alone in mirrored flow."""
    return (1.0, -1.0) if x.lateral.shape[0] else (1.0,)


def wind(x: Controls, side: float = 1.0) -> Float[Array, " 3"]:
    """Direction of the free stream in geometry axes as a half sees it."""
    beta = side * x.lateral[0] if x.lateral.shape[0] else jnp.zeros(())
    return jnp.stack([jnp.cos(x.alpha) * jnp.cos(beta), -jnp.sin(beta), jnp.sin(x.alpha) * jnp.cos(beta)])


def winds(x: Controls) -> Float[Array, "h 3"]:
    """`wind` of every half."""
    return jnp.stack([wind(x, side) for side in sides(x)])


def onset(points: Float[Array, "*p 3"], x: Controls, at: Setting, side: float = 1.0) -> Float[Array, "*p 3"]:
    """Free stream and rotation over the flight speed, as a half sees them: V - omega x r.

    Body rates are about x forward, y starboard, z down, so omega is (-p, q, -r) in geometry axes.
    """
    arm = points - at.flow.point * jnp.asarray([1.0, side, 1.0])
    q = 2.0 * x.q_hat / at.c
    air = wind(x, side) + q * jnp.stack([-arm[..., 2], jnp.zeros_like(arm[..., 0]), arm[..., 0]], axis=-1)
    if not x.lateral.shape[0]:
        return air
    p, r = side * 2.0 * x.lateral[1] / at.b, side * 2.0 * x.lateral[2] / at.b
    return air - jnp.stack([r * arm[..., 1], p * arm[..., 2] - r * arm[..., 0], -p * arm[..., 1]], axis=-1)


def normals(lattice: Lattice, delta: Float[Array, " k"], side: float = 1.0) -> Float[Array, "n 3"]:
    """Normals of a half with the controls deflected."""
    return lattice.normal + jnp.tensordot(jnp.sin(delta), lattice.normal_hinge[0 if side > 0 else 1], axes=1)


def circulation(at: Setting, x: Controls, jets: Jets | None = None) -> Float[Array, "h n"]:
    """Strengths of the rings in the stream and in slipstreams, if any.

    In a slipstream they are the circulations times mu = V_jet / V: lift, which is continuous at its edges, see
    `finite_jet.jet_edges`.
    """
    lattice, halves = at.system.lattice, sides(x)
    if lattice is None:
        return jnp.zeros((len(halves), 0))
    needed = []
    for i, side in enumerate(halves):
        met = _met(at, x, jets, i, side)
        if at.system.slender is not None:
            normal = normals(lattice, x.delta, side)
            field, (w, v) = at.system.slender.field, crossflow(body_motion(x, at, side), lattice.collocation[:, 0])
            met = field.shield * met + jnp.sum((w[:, None] * field.by_w + v[:, None] * field.by_v) * normal, axis=-1)
        needed.append(-met)
    return _strengths(at, jets, needed)


def _strengths(at: Setting, jets: Jets | None, needed: list[Array]) -> Float[Array, "h n"]:
    """Rings that bring these normal velocities of each half, and what edges of slipstreams make of their lift."""
    lattice, blown = at.system.lattice, at.system.blown
    assert lattice is not None
    halves = present(lattice, jnp.stack(needed))
    if jets is None or blown is None:
        return by_symmetry(lattice, solve, halves)
    edges = jax.tree.map(lambda v: FINITE_JET * v, jets.edges)
    return solve_blown(at.system.panels, lattice, blown, edges, halves)


def _met(at: Setting, x: Controls, jets: Jets | None, i: int, side: float) -> Array:
    """Normal velocities that the panels of a half meet in the stream and in slipstreams, there times mu.

    But for the lattice's own and the body's, see `circulation`.
    """
    lattice = at.system.lattice
    assert lattice is not None
    normal = normals(lattice, x.delta, side)
    met = jnp.sum(onset(lattice.collocation, x, at, side) * normal, axis=-1)
    if jets is None:
        return met
    faster = jets.velocity[i] @ wind(x, side)
    return (1.0 + faster) * (met + jnp.sum(jets.velocity[i] * normal, axis=-1))


def body_motion(x: Controls, at: Setting, side: float = 1.0) -> Crossflow:
    """Motion of the fuselage as a half sees it."""
    beta, yaw = (x.lateral[0], 2.0 * x.lateral[2] / at.b) if x.lateral.shape[0] else (0.0, 0.0)
    return Crossflow(x.alpha, side * beta, 2.0 * x.q_hat / at.c, side * yaw, at.flow.point[0])


def axis_upwash(at: Setting, x: Controls, jets: Jets | None = None) -> Array | None:
    """Upwash of the surfaces at the axis of a slender fuselage, as they would be without it."""
    lattice, slender = at.system.lattice, at.system.slender
    if lattice is None or slender is None:
        return None
    strengths = _strengths(at, jets, [-_met(at, x, jets, i, side) for i, side in enumerate(sides(x))])
    return slender.upwash @ both_parts(list(strengths))[0]


def unknowns(plan: RotorPlan | None, system: System, x: Controls) -> int:
    """Number of unknowns of the coupling: none where slipstreams meet neither surfaces nor other rotors."""
    if plan is None or (system.lattice is None and not plan.neighbours):
        return 0
    return rotor_halves(plan, len(sides(x)) == 2) * len(plan.groups) * of_a_rotor(plan)


def of_a_rotor(plan: RotorPlan) -> int:
    """Number of unknowns of one rotor: two induced velocities of every annulus, two forces across the shaft."""
    return 2 * plan.radial + 2


def rotor_halves(plan: RotorPlan, lateral: bool) -> int:
    """Halves whose rotors are solved; rotors in the plane of symmetry have no image."""
    return 2 if lateral and plan.sides == 2 else 1


def wake_of(flat: Float[Array, " u"], plan: RotorPlan, x: Controls) -> Wake:
    """The unknowns of the coupling as slipstreams."""
    each = flat.reshape(rotor_halves(plan, len(sides(x)) == 2), len(plan.groups), of_a_rotor(plan))
    return Wake(*jnp.split(each, [plan.radial, 2 * plan.radial], axis=-1))


def washes(
    flat: Float[Array, " u"], x: Controls, at: Setting, plan: RotorPlan | None, *, filaments: bool
) -> Washes | None:
    """What each slipstream of the given strength does; None where there is nothing that it meets."""
    lattice = turned(at, x).system.lattice
    if plan is None or at.rotors is None or not unknowns(plan, at.system, x):
        return None
    wake, air, disks = wake_of(flat, plan, x), winds(x), None
    if plan.neighbours:
        disks = NEIGHBOURS * at_other_disks(at.rotors, plan, wake, disk_points(at.rotors, plan), winds=air)
    if lattice is None:
        return Washes(None, disks, None)
    ends, n = lattice.across, lattice.chord.shape[0]
    if filaments:
        ends = jnp.concatenate([ends, jnp.stack([lattice.middles, lattice.arms])], axis=1)
    each = SLIPSTREAM * mean_slipstreams(at.rotors, plan, wake, *ends, winds=air)
    assert at.system.mirrored is not None
    strips = met_strips(at.system.panels, lattice, at.system.mirrored, at.flow.mach)
    edges = slipstream_edges(at.rotors, plan, wake, strips, winds=air)
    jets = Jets(each[:, :, :n], jax.tree.map(lambda v: SLIPSTREAM * v, edges))
    return Washes(jets, disks, each[:, :, n:] if filaments else None)


def together(each: Washes) -> Washes:
    """All slipstreams: what they do adds up."""
    return jax.tree.map(lambda v: jnp.sum(v, axis=1), each)


def respond(
    flat: Float[Array, " u"],
    x: Controls,
    at: Setting,
    plan: RotorPlan | None,
    phi: Found | None = None,
    *,
    wash: Washes | None = None,
) -> Response:
    """One pass: slipstreams of the given strength, the lattice in them, the rotors in its upwash.

    ``wash`` is what all slipstreams of this strength do, if that is known; ``phi`` what rotors have searched for.
    """
    if wash is None:
        each = washes(flat, x, at, plan, filaments=False)
        wash = None if each is None else together(each)
    at = turned(at, x)
    if plan is None or at.rotors is None:
        return Response(flat, circulation(at, x), None, None, axis_upwash(at, x))
    if wash is None:
        loads, wake = _disk_loads(at.rotors, at, x, None, None, plan=plan, phi=phi)
        return Response(flat, circulation(at, x), loads, wake)
    gamma = circulation(at, x, wash.jets)
    loads, wake = _disk_loads(at.rotors, at, x, gamma, wash.disks, plan=plan, phi=phi)
    answer = jnp.concatenate(wake, axis=-1).ravel()
    return Response(answer, gamma, loads, wake_of(flat, plan, x), axis_upwash(at, x, wash.jets), wash.filaments)


def _body_upwash(points: Float[Array, "m nr npsi 3"], at: Setting, x: Controls, side: float):
    """Velocity over the flight speed that a slender fuselage adds at the blade elements of a half."""
    assert at.system.slender is not None
    field, (w, v) = at.system.slender.at_disks, crossflow(body_motion(x, at, side), points[..., 0].ravel())
    return (w[:, None] * field.by_w + v[:, None] * field.by_v).reshape(points.shape)


def _disk_loads(
    rotors: Rotors, at: Setting, x: Controls, gamma, wash, *, plan: RotorPlan, phi
) -> tuple[RotorSolution, Wake]:
    """Rotors in the free stream, the rotation, the flow of surfaces and body, and what other slipstreams bring."""
    points = disk_points(rotors, plan)
    halves = sides(x)[: rotor_halves(plan, len(sides(x)) == 2)]
    stream = jnp.stack([onset(points, x, at, side) for side in halves])
    added = jnp.zeros_like(stream)
    even, odd = at.system.disk_velocity
    if even is not None:
        added += UPWASH * induced(even, odd, gamma)[: len(halves)]
    if at.system.slender is not None:
        added += UPWASH * jnp.stack([_body_upwash(points, at, x, side) for side in halves])
    if at.system.thickness is not None:
        added += at.system.thickness.at_disks
    if wash is not None:
        added += wash[: len(halves)]
    loads = rotor_loads(rotors, plan, at.flow.speed * (stream + added), pitch=x.theta, flow=at.flow, found=phi)
    return loads, wake_behind(loads, rotors, plan, at.flow, added)
