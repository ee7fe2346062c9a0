"""Coefficients of a lattice and their derivatives by the state, from one factorisation for each symmetry.

The wake runs along x, so the matrix does not depend on the state: the circulations' derivatives by incidence,
sideslip, rates and controls are further right-hand sides, and those of the forces follow from the product rule
(Drela, Flight Vehicle Aerodynamics, 2014, section 6.4). The gradient of a stability derivative by the geometry
is then a first derivative of these functions.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.fast_lattice import FastLattice, assemble, solve, velocities
from hera_om.physics.geometry import Panels, between
from hera_om.physics.lattice import shapes
from hera_om.physics.lattice_forces import both_halves, filament_strengths
from hera_om.physics.layout import Layout, layout

STATES = ("alpha", "beta", "p_hat", "q_hat", "r_hat")
"""Entries of a state before the control commands; angles in rad, rates over 2V/b, 2V/c and 2V/b."""
REVERSED = (1, 2, 4)
"""Those that the plane of symmetry reverses."""
COEFFICIENTS = ("CL", "CD", "CY", "Cl", "Cm", "Cn")
"""Lift and drag across and along the wind, force to starboard, moments: right wing down, nose up, nose right."""


class Reference(NamedTuple):
    """What coefficients refer to."""

    S: Array | float  # m^2
    c: Array | float  # m
    b: Array | float  # m
    point: Float[Array, " 3"]  # m


class Response(NamedTuple):
    """Coefficients in the order of `COEFFICIENTS`, and their derivatives by the chosen entries of the state."""

    values: Float[Array, " 6"]
    by: Float[Array, "6 k"]


class _Geometry(NamedTuple):
    """What the conditions and the forces need of all surfaces, in the order of `layout.Layout`."""

    normal_hinge: Float[Array, "2 k n 3"]
    points: Float[Array, "e 3"]  # of attack of the loaded filaments
    lines: Float[Array, "e 3"]  # vectors of the filaments
    weight: np.ndarray  # part of a filament that belongs to either half
    loaded: np.ndarray  # places of these filaments among all


class _Columns(NamedTuple):
    """Which of the columns (the state itself, then its derivatives) have a part in each symmetry."""

    count: int
    even: tuple[int, ...]
    odd: tuple[int, ...]


def response(
    surfaces: Sequence[Panels],
    state: Float[Array, " s"],
    reference: Reference,
    *,
    mach=0.0,
    by: Sequence[int] = (),
    kinds: Sequence[str] | None = None,
    reversed_entries: Sequence[int] = REVERSED,
    lateral: bool = False,
    chordwise_loads: bool = True,
) -> Response:
    """Coefficients at a state and their derivatives by chosen entries of it.

    Args:
        surfaces: starboard halves, and surfaces in the plane of symmetry.
        state: `STATES`, then the commands of the controls, rad.
        reference: reference quantities.
        mach: Mach number, below 1.
        by: entries of the state to differentiate by.
        kinds: how each surface meets the plane of symmetry, see `layout.layout`.
        reversed_entries: entries that the plane reverses, commands with opposite deflections among them.
        lateral: True if any of these is not zero at the state itself.
        chordwise_loads: whether chordwise filaments carry force too; in AVL only the bound ones do.

    Returns:
        Response; derivatives per radian and per unit of the rates. Valid where the lattice is.
    """
    plan = layout(shapes(surfaces), kinds, chordwise_loads=chordwise_loads)
    every = tuple(range(len(by) + 1))
    odd = tuple(i + 1 for i, entry in enumerate(by) if entry in reversed_entries)
    columns = _Columns(len(every), tuple(i for i in every if i not in odd), odd)
    columns = _Columns(len(every), every, every) if lateral else columns
    lattice = assemble(surfaces, mach, kinds=kinds, lateral=bool(columns.odd))
    geometry = _geometry(surfaces, plan)
    even, odd_part = _circulations(lattice, geometry, state, reference, by, columns)
    v = velocities(lattice, geometry.points, even, odd_part if columns.odd else None)
    v = jnp.moveaxis(v, 0, -1)
    split = even.shape[1]
    local = _halves(v[..., :split], v[..., split:], columns)
    halves = []
    strengths = [gamma[geometry.loaded] for gamma in _strengths(plan, even, odd_part, columns)]
    for side, induced, gamma in zip(_sides(columns), local, strengths, strict=True):
        air = _with_derivatives(lambda x, s=side: onset(geometry.points, x, reference, s), state, by)
        halves.append(_resultant(geometry, gamma, induced + air, reference, side))
    force, moment = both_halves([h[0] for h in halves]), both_halves([h[1] for h in halves], axial=True)
    return _coefficients(state, force, moment, reference, by)


def onset(
    points: Float[Array, "p 3"], state: Float[Array, " s"], reference: Reference, side: float = 1.0
) -> Float[Array, "p 3"]:
    """Free stream and rotation over the flight speed as a half sees them, V - omega x r.

    Args:
        points: m, on the starboard half.
        state: see `response`.
        reference: reference quantities.
        side: 1 for the starboard half, -1 for the port half as the plane of symmetry mirrors it.

    Returns:
        Velocities; body rates (p, q, r) about x forward, y starboard, z down are (-p, q, -r) in geometry axes.
    """
    q = 2.0 * state[3] / reference.c
    p, r = side * 2.0 * state[2] / reference.b, side * 2.0 * state[4] / reference.b
    arm = points - reference.point * jnp.asarray([1.0, side, 1.0])
    turn = jnp.cross(jnp.stack([-p, q, -r]), arm)
    return _wind(state[0], side * state[1]) - turn


def _wind(alpha, beta) -> Float[Array, " 3"]:
    """Direction of the free stream."""
    return jnp.stack([jnp.cos(alpha) * jnp.cos(beta), -jnp.sin(beta), jnp.sin(alpha) * jnp.cos(beta)])


def _sides(columns: _Columns) -> tuple[float, ...]:
    """The halves that have to be looked at."""
    return (1.0, -1.0) if columns.odd else (1.0,)


def _geometry(surfaces: Sequence[Panels], plan: Layout) -> _Geometry:
    """Arrays of all surfaces."""
    sizes = [s.normal[..., 0].size for s in surfaces]
    hinge = [s.normal_hinge.reshape(*s.normal_hinge.shape[:2], n, 3) for s, n in zip(surfaces, sizes, strict=True)]
    points, lines = [], []
    for s in surfaces:
        left, right, front, back = s.rings[:-1, :-1], s.rings[:-1, 1:], s.rings[:-1], s.rings[1:]
        points += [between(left, right, s.middle), (front + back) / 2]
        lines += [right - left, back - front]
    loaded = np.flatnonzero(plan.loaded)
    points, lines = (jnp.concatenate([a.reshape(-1, 3) for a in family])[loaded] for family in (points, lines))
    return _Geometry(jnp.concatenate(hinge, axis=2), points, lines, plan.weight[plan.inner[loaded]][:, None], loaded)


def _with_derivatives(function, state, by) -> Array:
    """Value of a function of the state and its derivatives by the chosen entries, on a new last axis."""
    if not by:
        return function(state)[..., None]
    jacobian = jax.jacfwd(function)(state)
    return jnp.concatenate([function(state)[..., None], jacobian[..., jnp.asarray(by)]], axis=-1)


def _circulations(lattice: FastLattice, geometry: _Geometry, state, reference, by, columns: _Columns):
    """Mirrored and reversed circulations of their columns, [n, columns]."""

    def wash(x, side):
        hinge = geometry.normal_hinge[0 if side > 0 else 1]
        turned = lattice.normal + jnp.tensordot(jnp.sin(x[len(STATES) :]), hinge, axes=1)
        return -jnp.sum(onset(lattice.collocation, x, reference, side) * turned, axis=-1)

    washes = [_with_derivatives(lambda x, s=side: wash(x, s), state, by) for side in _sides(columns)]
    even = (washes[0] + washes[-1])[:, jnp.asarray(columns.even)] / 2
    even = solve(lattice, even)
    if not columns.odd:
        return even, even[:, :0]
    odd = (washes[0] - washes[-1])[:, jnp.asarray(columns.odd)] / 2
    return even, solve(lattice, odd, odd=True)


def _strengths(plan: Layout, even, odd, columns: _Columns) -> list[Float[Array, "e c"]]:
    """Circulations of the filaments of each half, all columns."""
    halves = _halves(even, odd, columns)
    if not columns.odd:
        return [jax.vmap(lambda g: filament_strengths(plan, g), 1, 1)(halves[0])]
    full = (halves[0] - halves[1]) / 2
    by_column = jax.vmap(lambda g, o: filament_strengths(plan, g, o), 1, 1)
    return [by_column(h, s * full) for h, s in zip(halves, _sides(columns), strict=True)]


def _halves(even: Float[Array, "*s a"], odd: Float[Array, "*s b"], columns: _Columns) -> list[Array]:
    """What each half has of a mirrored and a reversed part, all columns."""

    def spread(part, places):
        at = {c: part[..., i] for i, c in enumerate(places)}
        return jnp.stack([at.get(c, jnp.zeros(even.shape[:-1])) for c in range(columns.count)], axis=-1)

    one, other = spread(even, columns.even), spread(odd, columns.odd)
    return [one + side * other for side in _sides(columns)]


def _resultant(geometry: _Geometry, gamma, local, reference: Reference, side) -> tuple[Array, Array]:
    """Force and moment of a half over dynamic pressure and their derivatives: dF = 2 Gamma V x l, [columns, 3]."""
    value = gamma[:, :1] * local[..., 0]
    change = gamma[:, None, 1:] * local[..., :1] + gamma[:, None, :1] * local[..., 1:]
    flow = geometry.weight[..., None] * jnp.concatenate([value[..., None], change], axis=-1)
    force = 2.0 * jnp.cross(flow, geometry.lines[..., None], axis=1)
    arm = geometry.points - reference.point * jnp.asarray([1.0, side, 1.0])
    return jnp.sum(force, axis=0).T, jnp.sum(jnp.cross(arm[..., None], force, axis=1), axis=0).T


def _coefficients(state, force, moment, reference: Reference, by) -> Response:
    """Coefficients and their derivatives from force and moment over dynamic pressure."""

    def coefficients(x, f, m):
        s, wind = reference.S, _wind(x[0], x[1])
        lift = f[2] * jnp.cos(x[0]) - f[0] * jnp.sin(x[0])
        roll, pitch, yaw = -m[0] / reference.b, m[1] / reference.c, -m[2] / reference.b
        return jnp.stack([lift, wind @ f, f[1], roll, pitch, yaw]) / s

    def along(i, df, dm):
        return jax.jvp(coefficients, (state, force[0], moment[0]), (jnp.eye(state.size)[i], df, dm))[1]

    values = coefficients(state, force[0], moment[0])
    if not by:
        return Response(values, jnp.zeros((6, 0)))
    return Response(values, jax.vmap(along, out_axes=1)(jnp.asarray(by), force[1:], moment[1:]))
