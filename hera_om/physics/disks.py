"""Rotors of an aircraft as a set: their disks in the flow, their loads, their slipstreams at any point."""

from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jax.flatten_util import ravel_pytree
from jaxtyping import Array, Bool, Float

from hera_om.physics.aero_cases import FAILURES, Flow, RotorPlan, Rotors
from hera_om.physics.finite_jet import JetEdges, jet_edges
from hera_om.physics.lattice import MIRROR, prandtl_glauert
from hera_om.physics.nacelle import held_up, nacelle_drag
from hera_om.physics.rotor import Blade, RotorSolution, blade_elements, element_points, solve_rotor
from hera_om.physics.slipstream import (
    axial_development,
    beside_nacelle,
    contraction,
    disk_mean,
    hub_edge,
    instantiated,
    loading,
    past_nacelle,
    skew,
    slipstream_velocity,
)
from hera_om.physics.strips import Strips
from hera_om.physics.windmilling import Known, feathering_pitch, windmilling_speed

EDGE_WIDTH = 0.1
"""Width of the slipstream's edge over the rotor radius: the shear layer of a propeller jet half a diameter
to a diameter behind its disk (choice; see the limits of `slipstream`)."""


SMEARED = 0.8
"""Least width of that edge over the width of a strip: twice the distance of the points where a strip samples it."""
TINY = 1e-12
"""Keeps the length of a segment along the stream differentiable, m."""
INFLOW_TURN = 1.0
"""Share of the turn of slipstreams by what other parts do at the disk; 0 leaves that of the stream."""
STEPS = 4
"""Steps of the profile of a slipstream as its edges answer (choice)."""
STRIPS_BLOCK, POINTS_BLOCK = 16, 240
"""Most strips and points taken together: what many derivatives at once need of them then stays in the cache."""
GAUSS_POINTS = (-0.5 * 0.6**0.5, 0.0, 0.5 * 0.6**0.5)
GAUSS_WEIGHTS = (5 / 18, 8 / 18, 5 / 18)


class Found(NamedTuple):
    """What has been searched for in a solution of all rotors."""

    phi: Float[Array, "h m nr npsi"]
    omega: Float[Array, "h m"]
    pitch: Float[Array, "h m"]


class Wake(NamedTuple):
    """What a slipstream is made of: mean induced velocities at the disk over the flight speed.

    Of the m rotors of the starboard half and, in lateral flow, of the port half as the plane mirrors it.
    """

    axial: Float[Array, "h m nr"]
    swirl: Float[Array, "h m nr"]
    side: Float[Array, "h m 2"]  # force on the air in the plane of the disk over rho A V^2, shaft axes y and z


def wake_behind(
    loads: RotorSolution, rotors: Rotors, plan: RotorPlan, flow: Flow, turned: Float[Array, "h m nr npsi 3"]
) -> Wake:
    """What rotors with such loads (forces in geometry axes) leave behind.

    What surfaces and others do at a disk (``turned``, velocity over the flight speed) gives the air a slope there that
    the thrust, along the shaft, takes part of away: w across the shaft acts as a force
    rho A (V + v) (V / V_j) (V_j - V) w. The potential is continuous through the disk, so that behind it V_j phi inside
    less V phi outside of the tube is (V_j - V) times that at the disk; the stream's own part is `slipstream.tilt`.
    """
    axes = shaft_axes(rotors.incidence)
    force = jnp.einsum("hmi,mji->hmj", loads.force, axes[:, 1:])
    pressure = flow.density * flow.speed**2 * jnp.pi * rotors.radius[:, None] ** 2
    axial = loads.v_axial / flow.speed
    r = blades(rotors, plan).r
    weight = r / jnp.sum(r, axis=1, keepdims=True)
    slope = INFLOW_TURN * jnp.einsum("mr,hmrpi,mji->hmj", weight / plan.azimuthal, turned, axes[:, 1:])
    v_mean = jax.vmap(jax.vmap(disk_mean), in_axes=(None, 0, None))(r, axial, rotors.radius)[..., None]
    return Wake(
        axial,
        loads.v_swirl / flow.speed,
        2.0 * v_mean * (1.0 + v_mean) / (1.0 + 2.0 * v_mean) * slope - force / pressure,
    )


def shaft_axes(incidence: Float[Array, " m"]) -> Float[Array, "m 3 3"]:
    """Unit vectors of the shaft axes (x aft along the shaft, y, z) as rows, in geometry axes."""
    c, s, zero = jnp.cos(incidence), jnp.sin(incidence), jnp.zeros_like(incidence)
    rows = [[c, zero, -s], [zero, zero + 1.0, zero], [s, zero, c]]
    return jnp.stack([jnp.stack(row, axis=-1) for row in rows], axis=-2)


def blades(rotors: Rotors, plan: RotorPlan) -> Blade:
    """Blade elements of every rotor, leading axis m."""

    def one(radius, hub_radius, r, chord, twist, polar):
        return blade_elements(radius, hub_radius, r, chord, twist, polar=polar, n=plan.radial)

    return jax.vmap(one)(rotors.radius, rotors.hub_radius, rotors.r, rotors.chord, rotors.twist, rotors.polar)


def disk_points(rotors: Rotors, plan: RotorPlan) -> Float[Array, "m nr npsi 3"]:
    """Points of all blade elements in geometry axes, m."""
    local = jax.vmap(lambda b: element_points(b.r, plan.azimuthal))(blades(rotors, plan))
    return rotors.hub[:, None, None, :] + jnp.einsum("mrpi,mij->mrpj", local, shaft_axes(rotors.incidence))


def rotor_loads(
    rotors: Rotors,
    plan: RotorPlan,
    velocity: Float[Array, "h m nr npsi 3"],
    *,
    pitch: Float[Array, " g"],
    flow: Flow,
    found: Found | None = None,
) -> RotorSolution:
    """Every rotor in the given stream (geometry axes, m/s); forces and moments in geometry axes too.

    A failed rotor turns at the speed without torque (windmilling), stands still at its pitch (stopped) or at the
    pitch without torque (feathered), all in the stream that it is in.

    ``found``, the answer to the same values found before, saves the search for it. The results have the leading
    axes [h, m] of the streams; forces hold what the nacelle pays for the thrust that it brings, the thrust does not.
    """
    halves, m = velocity.shape[:2]
    axes = jnp.tile(shaft_axes(rotors.incidence), (halves, 1, 1))
    local = jnp.einsum("mij,mrpj->mrpi", axes, velocity.reshape(halves * m, *velocity.shape[2:]))
    own = blades(rotors, plan)
    behind = jax.vmap(partial(held_up, beta=prandtl_glauert(flow.mach)))
    slow = behind(own.r, hub_radius=rotors.hub_radius, nacelle_radius=rotors.nacelle_radius)

    def one(blade, stream, angle, rotor, slow, known):
        phi = None if known is None else known.phi
        out = solve_rotor(blade, stream, pitch=angle, omega=rotor.omega, phi=phi, **_case(rotor, plan, flow))
        thrust = rotor.blades * jnp.mean(out.blade_thrust, axis=1) * blade.dr
        speed = jnp.mean(stream[..., 0], axis=1) / (1.0 - slow)
        drag = nacelle_drag(thrust, slow, speed=speed, v_axial=out.v_axial)
        return out._replace(force=out.force.at[0].add(drag))

    every = (own, pitch[jnp.asarray(plan.groups)], rotors, slow)
    blade, angle, rotor, slow = jax.tree.map(lambda v: jnp.concatenate([v] * halves), every)
    local = local.at[..., 0].multiply(1.0 - slow[:, :, None])
    known = None if found is None else Found(*[v.reshape(halves * m, *v.shape[2:]) for v in found])
    if plan.failed:
        angle, omega = _failed(blade, local, angle, rotor=rotor, known=known, plan=plan, flow=flow)
        rotor = rotor._replace(omega=omega)
    out = jax.vmap(one)(blade, local, angle, rotor, slow, known)
    force, moment = (jnp.einsum("mi,mij->mj", v, axes) for v in (out.force, out.moment))
    return jax.tree.map(lambda v: v.reshape(halves, m, *v.shape[1:]), out._replace(force=force, moment=moment))


def _case(rotor: Rotors, plan: RotorPlan, flow: Flow) -> dict[str, Any]:
    """What `solve_rotor` takes beside blade, stream, pitch and speed."""
    return {
        "radius": rotor.radius,
        "hub_radius": rotor.hub_radius,
        "n_blades": rotor.blades,
        "density": flow.density,
        "sound_speed": flow.sound_speed,
        "viscosity": flow.viscosity,
        "sense": rotor.sense,
        "tip_loss": plan.tip_loss,
        "hub_loss": plan.hub_loss,
        "stall_delay": plan.stall_delay,
    }


def _failed(blade: Blade, local, angle, *, rotor: Rotors, known: Found | None, plan: RotorPlan, flow: Flow):
    """Pitch and speed of all rotors [h m], of those that have failed what has become of them."""
    m, count = len(plan.groups), angle.shape[0]
    places = {s: np.array([h * m + k for h, k, of in plan.failed if of == s], int) for s in FAILURES}
    free, feathered, stopped = (places[s][places[s] < count] for s in FAILURES)

    def speed(blade, stream, angle, rotor, known):
        at = None if known is None else Known(known.omega, known.phi)
        return windmilling_speed(blade, stream, pitch=angle, known=at, **_case(rotor, plan, flow))

    def edge_on(blade, stream, _, rotor, known):
        at = None if known is None else Known(known.pitch, known.phi)
        return feathering_pitch(blade, stream, known=at, **_case(rotor, plan, flow))

    def of(places):
        return jax.tree.map(lambda v: v[places], (blade, local, angle, rotor, known))

    omega = rotor.omega.at[np.concatenate([feathered, stopped])].set(0.0)
    if free.size:
        omega = omega.at[free].set(jax.vmap(speed)(*of(free)))
    if feathered.size:
        angle = angle.at[feathered].set(jax.vmap(edge_on)(*of(feathered)))
    return angle, omega


def mean_slipstreams(
    rotors: Rotors,
    plan: RotorPlan,
    wake: Wake,
    middles: Float[Array, "p 3"],
    spans: Float[Array, "p 3"],
    *,
    winds: Float[Array, "h 3"],
) -> Float[Array, "h k p 3"]:
    """`slipstreams` averaged along segments given by middles and vectors, by Gauss's rule with three points.

    A strip is as wide as a good part of a disk. Sampled at one point, what a slipstream does to it would
    jump as edges of disks pass that point: noise of two drag counts on 32 strips, which an optimiser exploits.
    The edge is smeared over what lies between the points, so that derivatives of derivatives are smooth too.
    """
    blur = SMEARED * jnp.linalg.norm(spans[:, 1:] + TINY, axis=1)

    def add(total, point):
        place, weight = point
        return total + weight * slipstreams(rotors, plan, wake, middles + place * spans, winds=winds, blur=blur), None

    k = len(plan.groups) * plan.sides
    points = (jnp.asarray(GAUSS_POINTS), jnp.asarray(GAUSS_WEIGHTS))
    return jax.lax.scan(add, jnp.zeros((len(winds), k, *middles.shape)), points)[0]


def slipstreams(
    rotors: Rotors,
    plan: RotorPlan,
    wake: Wake,
    points: Float[Array, "p 3"],
    *,
    winds: Float[Array, "h 3"],
    blur: Float[Array, " p"] | None = None,
) -> Float[Array, "h k p 3"]:
    """Velocity over the flight speed that each of k slipstreams adds at ``points`` of the starboard half, or of each.

    The port half is the starboard one as the plane mirrors it, so a half's own slipstreams, the first m, are seen
    at the points and those of the other half at the mirrored points. ``winds`` are the directions of the free
    stream as the halves see it, ``blur`` (m) what widens the edges of the slipstreams at each point.
    """
    smeared = jnp.zeros(points.shape[0]) if blur is None else blur

    def one(at, smeared, slip):
        axis = slip.axes[0]
        speed = axis @ slip.wind
        return slipstream_velocity(
            at,
            hub=slip.hub,
            axis=axis,
            radius=slip.radius,
            r=slip.r,
            v_axial=slip.axial,
            v_swirl=slip.swirl,
            sense=slip.sense,
            speed=speed,
            edge_width=jnp.sqrt((EDGE_WIDTH * slip.radius) ** 2 + smeared**2),
            cross_stream=slip.wind - speed * axis,
            cross_force=slip.side @ slip.axes[1:],
            nacelle=slip.nacelle,
        )

    mirror = jnp.asarray(MIRROR)
    both = (points, smeared), (points * mirror, smeared)
    own, other = _seen(one, rotors, plan, wake, *both, winds=winds, block=POINTS_BLOCK)
    return _by_halves(plan, own, other * mirror, len(winds))


class _Slipstream(NamedTuple):
    """One rotor of one half and what its slipstream is made of."""

    hub: Array
    axes: Array
    radius: Array
    sense: Array
    nacelle: Array
    r: Array
    axial: Array
    swirl: Array
    side: Array
    wind: Array


def _seen(
    one, rotors: Rotors, plan: RotorPlan, wake: Wake, at: tuple, image: tuple, *, winds: Float[Array, "h 3"], block: int
):
    """``one`` of every slipstream of every half [h m n ...], at places and at their images in the plane of symmetry.

    ``one(*at, slipstream)`` has a row for each of the n places that the arrays of ``at`` describe.
    """
    halves, n = wake.axial.shape[0], at[0].shape[0]
    axes, r = shaft_axes(rotors.incidence), blades(rotors, plan).r
    of_rotor = (rotors.hub, axes, rotors.radius, rotors.sense, rotors.nacelle_radius, r)
    every = jax.tree.map(lambda v: jnp.concatenate([v] * halves), of_rotor)
    strength = jax.tree.map(lambda v: v.reshape(-1, *v.shape[2:]), tuple(wake))
    wind = jnp.repeat(winds[:halves], rotors.sense.shape[0], axis=0)
    cases = _Slipstream(*(*every, *strength, wind))
    both = tuple(jnp.concatenate(pair) for pair in zip(at, image, strict=True))
    each = jax.lax.map(lambda slip: _in_blocks(lambda *part: one(*part, slip), both, block), cases)
    each = jax.tree.map(lambda v: v.reshape(halves, -1, *v.shape[1:]), each)
    return jax.tree.map(lambda v: v[:, :, :n], each), jax.tree.map(lambda v: v[:, :, n:], each)


def _in_blocks(function, vectors: tuple, most: int):
    """A function of rows in equal blocks of at most so many; the last row fills the last block."""
    n = vectors[0].shape[0]
    count = -(-n // most)
    if count < 2:
        return function(*vectors)
    size = -(-n // count)
    filled = [jnp.pad(v, ((0, count * size - n), *((0, 0),) * (v.ndim - 1)), mode="edge") for v in vectors]
    out = jax.lax.map(lambda part: function(*part), [v.reshape(count, size, *v.shape[1:]) for v in filled])
    return jax.tree.map(lambda v: v.reshape(count * size, *v.shape[2:])[:n], out)


def _by_halves(plan: RotorPlan, own: Array, other: Array, halves: int) -> Array:
    """All slipstreams that each half sees: its own, then those of the other half."""
    if plan.sides == 1:  # rotors in the plane of symmetry have no image
        return jnp.concatenate([own, other])[:halves]
    return jnp.concatenate([own, other[::-1]], axis=1)


def made_by(plan: RotorPlan, halves: int) -> Bool[np.ndarray, "a m h k"]:
    """Which of the k slipstreams at each half, the last two axes, are those of a rotor of a half, the first two."""
    m = len(plan.groups)
    if plan.sides == 1:
        return np.tile(np.eye(m, dtype=bool)[None, :, None], (1, 1, halves, 1))
    own, other = np.eye(halves, dtype=bool), np.eye(halves, dtype=bool)[::-1]
    rotor = np.eye(m, dtype=bool)
    return np.concatenate([np.einsum("ah,bk->abhk", half, rotor) for half in (own, other)], axis=3)


def at_other_disks(
    rotors: Rotors, plan: RotorPlan, wake: Wake, points: Float[Array, "m nr npsi 3"], *, winds: Float[Array, "h 3"]
) -> Float[Array, "h k m nr npsi 3"]:
    """Velocity over the flight speed at the disks of each half by each slipstream, none at a disk by its own."""
    field = slipstreams(rotors, plan, wake, points.reshape(-1, 3), winds=winds)
    each = field.reshape(*field.shape[:2], *points.shape)
    return (1.0 - jnp.eye(each.shape[1], points.shape[0]))[:, :, None, None, None] * each


def slipstream_edges(
    rotors: Rotors, plan: RotorPlan, wake: Wake, strips: tuple[Strips, ...], *, winds: Float[Array, "h 3"]
) -> tuple[JetEdges, ...]:
    """What the edges of each slipstream do to the strips of each surface, axes [h k n].

    Annuli are taken together by `STEPS`; what is inside the hub or the nacelle is as the stream.
    """
    groups = np.array_split(np.arange(plan.radial), min(STEPS, plan.radial))
    last = np.array([g[-1] for g in groups])
    member = np.stack([np.isin(np.arange(plan.radial), g) for g in groups]).astype(float)

    def one(point, along, chord, nodes, slip):
        area = member * slip.r
        half = 0.5 * (slip.r[1] - slip.r[0])
        axial, v_mean = (area @ slip.axial) / jnp.sum(area, axis=1), disk_mean(slip.r, slip.axial, slip.radius)
        speed = slip.axes[0] @ slip.wind
        jet = _Jet(axial, skew(slip.axes[1:] @ slip.wind, v_mean, speed), loading(v_mean, speed))
        ends = jnp.append(hub_edge(slip.r, slip.radius), slip.r[last] + half)
        place = _Met(point, along, chord, nodes, slip.hub, slip.axes, slip.radius, ends, slip.nacelle)
        return _edges(jet, place)

    def of(each):
        point, along = each.point * jnp.asarray(MIRROR), each.along * jnp.asarray(MIRROR)
        both = (each.point, each.along, each.chord, each.nodes), (point, along, each.chord, each.nodes)
        seen = _seen(one, rotors, plan, wake, *both, winds=winds, block=STRIPS_BLOCK)
        edges = jax.tree.map(lambda own, other: _by_halves(plan, own, other, len(winds)), *seen)
        return edges._replace(shed=each.there * edges.shed, moment=each.there * edges.moment)

    return tuple(of(each) for each in strips)


class _Met(NamedTuple):
    """Strips and the geometry of the rotor whose slipstream they meet."""

    point: Array
    along: Array
    chord: Array
    nodes: Array
    hub: Array
    axes: Array
    radius: Array
    ends: Array  # of the steps of the profile at the disk, m
    nacelle: Array


class _Jet(NamedTuple):
    """What the edges of a slipstream depend on but for geometry: few numbers, by which `_edges` has its slopes."""

    axial: Float[Array, " s"]  # mean velocity of every step at the disk over the flight speed
    skew: Float[Array, " 2"]  # slope of the tube along the shaft's axes y and z
    loading: Float[Array, ""]


@jax.custom_jvp
def _edges(jet: _Jet, met: _Met) -> JetEdges:
    """Edges of one slipstream at strips."""
    return _raw_edges(jet, met)


def _raw_edges(jet: _Jet, met: _Met) -> JetEdges:
    offset, axis = met.point - met.hub, met.axes[0]
    x = offset @ axis
    radial = offset - x[:, None] * axis
    drift = x * past_nacelle(jnp.sum(radial**2, axis=1), met.radius, met.nacelle)
    across = radial - drift[:, None] * (jet.skew @ met.axes[1:])
    grown = axial_development(x, met.radius)
    narrowing = contraction(grown, jet.loading)[:, None] * met.ends
    return jet_edges(
        jnp.sum(across * met.along, axis=1),
        jnp.sum(across * jnp.cross(axis, met.along), axis=1),
        met.nodes,
        met.chord,
        radius=jnp.sqrt(narrowing**2 + beside_nacelle(grown, met.nacelle, met.ends[0])[:, None]),
        excess=jnp.pad((1.0 + (1.0 + grown)[:, None] * jet.axial) ** 2 - 1.0, ((0, 0), (1, 0))),
    )


def _edges_rule(primals, tangents):
    """Slopes by the few numbers of a jet once for all directions, as `slipstream` has them; geometry where it moves.

    By the steps apart from the others: they change strengths alone, which costs little.
    """
    jet, met = primals
    still = [isinstance(t, SymbolicZero) for t in tangents[1]]
    d_jet, d_met = instantiated(primals, tangents)
    place, unpack = ravel_pytree(jet[1:])
    by_axial = jax.jacfwd(lambda v: _raw_edges(jet._replace(axial=v), met))(jet.axial)
    by_place = jax.jacfwd(lambda v: _raw_edges(_Jet(jet.axial, *unpack(v)), met))(place)
    d_place = ravel_pytree(d_jet[1:])[0]
    change = jax.tree.map(lambda a, b: a @ d_jet.axial + b @ d_place, by_axial, by_place)
    if all(still):
        return _raw_edges(jet, met), change
    found, moved = jax.jvp(lambda m: _raw_edges(jet, m), (met,), (d_met,))
    return found, jax.tree.map(jnp.add, moved, change)


_edges.defjvp(_edges_rule, symbolic_zeros=True)
