"""Where lattice and rotors agree, and how that moves: the coupled system reduced to the rotors' unknowns."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.aero_cases import RotorPlan
from hera_om.physics.coupling import (
    Controls,
    Response,
    Setting,
    Washes,
    of_a_rotor,
    respond,
    rotor_halves,
    sides,
    together,
    unknowns,
    washes,
)
from hera_om.physics.disks import Found, made_by

TOLERANCE = 1e-12  # of the induced velocities over the flight speed
MAX_ITERATIONS = 60  # of the coupling; the residual is an output, so that a failure is seen


class Root(NamedTuple):
    """Equilibrium found without derivatives."""

    # by half and rotor: axial, then swirl over flight speed by radius, then the force across the shaft
    flat: Float[Array, " u"]
    phi: Found | None  # inflow angles of the blade elements there, rad; speed and pitch of the rotors


class Equilibrium(NamedTuple):
    """Lattice and rotors in equilibrium at a state, and its first derivatives by the state."""

    answer: Response
    by: Response  # last axis: alpha, q_hat, delta, theta, lateral
    residual: Array  # of the induced velocities over the flight speed


class Known(NamedTuple):
    """What carries derivatives through an equilibrium found before; none of it is differentiated itself."""

    root: Root
    inverse: Float[Array, "u u"]  # of the Jacobian of answer - unknowns
    shift: Float[Array, "u s"]  # unknowns by the state
    by_unknowns: Response


def as_vector(x: Controls):
    """A state as one vector, and the way back."""
    ends = np.cumsum([2, x.delta.shape[0], x.theta.shape[0]])

    def unpack(v):
        return Controls(v[0], v[1], *jnp.split(v[2:], ends[1:] - 2))

    return jnp.concatenate([jnp.stack([x.alpha, x.q_hat]), x.delta, x.theta, x.lateral]), unpack


def find_root(x: Controls, at: Setting, plan: RotorPlan | None) -> Root:
    """Equilibrium of lattice and rotors, without derivatives.

    The upwash changes a rotor's loading by a few percent and the loading the upwash by less: plain iteration
    gains more than a digit a step and needs one compiled copy of the model.
    """
    x, at = lax.stop_gradient((x, at))
    n = unknowns(plan, at.system, x)
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
    each = jnp.zeros((rotor_halves(plan, len(sides(x)) == 2), len(plan.groups)))
    blank = Found(jnp.zeros((*each.shape, plan.radial, plan.azimuthal)), each, each)
    _, flat, phi, _ = lax.while_loop(unfinished, step, (start - 1.0, start, blank, 0))
    return Root(flat, phi)


def _answer(flat, x: Controls, at: Setting, plan: RotorPlan) -> tuple[Array, Found | None]:
    """Induced velocities that the rotors answer with, and what has been searched for."""
    answer = respond(flat, x, at, plan)
    loads = answer.loads
    return answer.flat, None if loads is None else Found(loads.phi, loads.omega, loads.pitch)


def settle(root: Root, x: Controls, at: Setting, plan: RotorPlan | None) -> tuple[Equilibrium, Known]:
    """The equilibrium at a root: with J the answer's Jacobian, (J - 1) d unknowns = - d answer by the state."""
    n = root.flat.shape[0]
    answer, every = linearised(root, x, at, plan)
    inverse = jnp.linalg.inv(every.flat[:, :n] - jnp.eye(n)) if n else jnp.zeros((0, 0))
    shift = -inverse @ every.flat[:, n:]
    by_unknowns = jax.tree.map(lambda d: d[..., :n], every)
    by = jax.tree.map(lambda d: d[..., n:] + d[..., :n] @ shift, every)
    residual = jnp.max(jnp.abs(answer.flat - root.flat), initial=0.0)
    return Equilibrium(answer, by, residual), Known(root, inverse, shift, by_unknowns)


def carried(known: Known, x: Controls, at: Setting, plan: RotorPlan | None) -> Equilibrium:
    """The known equilibrium as a function of everything, to be differentiated once.

    One Newton step for the unknowns and one for their derivatives by the state: the values stay what they are, the
    derivatives become exact (implicit function theorem), at the cost of a pass for each entry of the state.
    """
    root, inverse = known.root, known.inverse
    flat = root.flat - inverse @ (respond(root.flat, x, at, plan, root.phi).flat - root.flat)
    first, unpack = as_vector(x)

    def whole(flat, v):
        x = unpack(v)
        each = washes(flat, x, at, plan, filaments=True)
        return respond(flat, x, at, plan, root.phi, wash=None if each is None else together(each))

    def along(d_flat, d_state):
        return jax.jvp(whole, (flat, first), (d_flat, d_state))

    answer, by = jax.vmap(along, in_axes=1, out_axes=(None, -1))(known.shift, jnp.eye(first.shape[0]))
    step = inverse @ (by.flat - known.shift)
    by = jax.tree.map(lambda d, slope: d - slope @ step, by, known.by_unknowns)
    return Equilibrium(answer, by, jnp.max(jnp.abs(answer.flat - flat), initial=0.0))


def linearised(root: Root, x: Controls, at: Setting, plan: RotorPlan | None) -> tuple[Response, Response]:
    """The answer at a root and its derivatives by all unknowns, then by the state, on a new last axis.

    A slipstream depends on its own rotor alone, so that one pass serves the same unknown of all rotors.
    """
    first, unpack = as_vector(x)
    n, s = root.flat.shape[0], first.shape[0]
    if plan is None or n == 0:
        by = jax.jacfwd(lambda v: respond(root.flat, unpack(v), at, plan, root.phi))(first)
        return respond(root.flat, x, at, plan, root.phi), by
    halves, lateral = rotor_halves(plan, len(sides(x)) == 2), x.lateral.shape[0]
    c = of_a_rotor(plan)
    seeds = np.broadcast_to(np.eye(c)[:, None, None], (c, halves, len(plan.groups), c))
    turning = [0, s - lateral] if lateral else [0]  # slipstreams feel the direction of the stream alone

    def field(v):
        return washes(v[:n], unpack(v[n:]), at, plan, filaments=True)

    def push(seed):
        return jax.jvp(field, (jnp.concatenate([root.flat, first]),), (seed,))

    rows = [np.pad(seeds.reshape(-1, n), ((0, 0), (0, s))), np.eye(n + s)[n + np.array(turning)]]
    each, by_each = jax.vmap(push, out_axes=(None, 0))(jnp.asarray(np.concatenate(rows)))
    by_unknowns = _of_each_rotor(jax.tree.map(lambda d: d[:c], by_each), plan, len(sides(x)))
    by_stream = jax.tree.map(lambda d: jnp.sum(d[c:], axis=2), by_each)
    by_state = jax.tree.map(lambda d: jnp.zeros((s, *d.shape[1:])).at[np.array(turning)].set(d), by_stream)
    by_wash = jax.tree.map(lambda *rows: jnp.concatenate(rows), by_unknowns, by_state)

    def rest(wash, v):
        return respond(v[:n], unpack(v[n:]), at, plan, root.phi, wash=wash)

    def along(d_wash, d):
        return jax.jvp(rest, (together(each), jnp.concatenate([root.flat, first])), (d_wash, d))

    return jax.vmap(along, out_axes=(None, -1))(by_wash, jnp.eye(n + s))


def _of_each_rotor(by: Washes, plan: RotorPlan, halves: int) -> Washes:
    """Changes of the whole by every unknown, from changes of all slipstreams by one unknown of each rotor."""
    whose = jnp.asarray(made_by(plan, halves), float)

    def spread(d):
        out = jnp.einsum("abhk,chk...->abch...", whose, d)
        return out.reshape(-1, *out.shape[3:])

    return jax.tree.map(spread, by)
