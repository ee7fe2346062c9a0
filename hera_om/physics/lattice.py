"""Steady vortex-ring lattice of any number of surfaces, by its starboard half.

Any flow about an aircraft with a plane of symmetry is the sum of one that the plane mirrors and one that it
reverses. Both have the same influence of a ring and differ in the sign of the image's: one pass of the kernel
gives two systems of half the size (`Half`). A surface in the plane itself (a fin) is its own image and takes
part in the second one only.

The wake runs along x by default, so that the matrices depend on geometry and Mach number alone: one factorisation
of each serves every incidence, rate, control angle and slipstream, all derivatives by them, and the adjoint. Equations:
Katz & Plotkin, Low-Speed Aerodynamics 2e, chapter 12; compressibility: Prandtl-Glauert as in AVL, the physical
boundary condition with the velocities of the stretched problem (see `vortex_kernel`).

Unknowns are ring circulations over the flight speed, in m. Valid for attached flow, small incidence and
subcritical Mach numbers (below about 0.7), away from the cores of other surfaces' wakes.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.linalg import lu_factor, lu_solve
from jaxtyping import Array, Float

from hera_om.physics.fast_lattice import EVEN, ODD, influence
from hera_om.physics.geometry import Panels, between
from hera_om.physics.layout import PLANE, SINGLE
from hera_om.physics.vortex_kernel import Arms, Filaments, arms, kernels

MIRROR = (1.0, -1.0, 1.0)
CORE_WIDTHS = 2.0
"""Core of the vortices of one component at the points of another, in widths of their strip, as in AVL."""


class Half(NamedTuple):
    """Influence in one of the two symmetries, and its factorised matrix."""

    matrix: Float[Array, "n n"]  # normal velocity at the collocation points
    lu: tuple  # factors and pivots; no derivatives
    velocity: Float[Array, "e 3 n"]  # velocity at the lattice's ``points`` per unit unknown


class Whole(NamedTuple):
    """System of both halves together, for surfaces without an image."""

    matrix: Float[Array, "m m"]  # m = 2 n: starboard unknowns, then those of the port half
    lu: tuple
    keep: Float[Array, " n"]  # 0 where the port half has no panel, else 1


class Lattice(NamedTuple):
    """Assembled lattice of n panels, e loaded filaments, s strips, t trailing nodes of all surfaces."""

    collocation: Float[Array, "n 3"]
    across: Float[Array, "2 n 3"]  # at each collocation point: middle of the strip, its width as a vector
    chord: Float[Array, " n"]  # of each panel's strip, m
    normal: Float[Array, "n 3"]
    normal_hinge: Float[Array, "2 k n 3"]  # derivatives by each command: starboard, and port as the plane mirrors it
    points: Float[Array, "e 3"]  # points of attack of the filaments, in the order of `layout.Layout`
    middles: Float[Array, "e 3"]  # their middles
    arms: Float[Array, "e 3"]  # vectors of the filaments, m
    strip_point: Float[Array, "s 3"]  # quarter-chord points of the strips
    strip_edge: Float[Array, "s 3"]  # vectors along their quarter-chord lines
    strip_chord: Float[Array, " s"]
    strip_width: Float[Array, " s"]
    trail: Float[Array, "t 2"]  # y and z of the trailing nodes
    trail_middle: Float[Array, "s 2"]
    even: Half  # flow that the plane of symmetry mirrors
    odd: Half | None  # flow that it reverses
    whole: Whole | None = None


def prandtl_glauert(mach):
    """beta = sqrt(1 - M^2)."""
    return jnp.sqrt(1.0 - mach**2)


def shapes(surfaces: Sequence[Panels]) -> list[tuple[int, int]]:
    """Chordwise and spanwise panels of each surface."""
    return [(s.collocation.shape[0], s.collocation.shape[1]) for s in surfaces]


def assemble(
    surfaces: Sequence[Panels],
    mach,
    elsewhere: Float[Array, "p 3"] | None = None,
    *,
    kinds: Sequence[str] | None = None,
    lateral: bool = False,
    components: Sequence[int] | None = None,
    wake_angle: Array | None = None,
) -> tuple[Lattice, tuple[Array, Array | None]]:
    """Influence matrices and factorisations of a lattice.

    Args:
        surfaces: starboard halves, each from the plane of symmetry outwards, and surfaces in that plane.
        mach: Mach number, below 1.
        elsewhere: further points whose velocities are wanted, m.
        kinds: how each surface meets the plane of symmetry, see `layout.layout`.
        lateral: whether the reversed flow is wanted too.
        wake_angle: of the wake lines above the x axis, rad; absent: they run along x.
        components: number of each surface's component; between components vortices have a core, as in AVL.

    Returns:
        Lattice, and the velocities at the further points per unit unknown [p, 3, n], in the mirrored flow and
        in the reversed one.
    """
    collocation, normal = _stack(surfaces, "collocation"), _stack(surfaces, "normal")
    points, middles, lines = (jnp.concatenate(v) for v in zip(*map(_filaments, surfaces), strict=True))
    extra = jnp.zeros((0, 3)) if elsewhere is None else elsewhere
    n, e = collocation.shape[0], points.shape[0]
    everywhere = jnp.concatenate([collocation, points, extra])
    owners = None if components is None else _owners(surfaces, components, extra.shape[0])
    beta = prandtl_glauert(mach)
    even, *reversed_part = _influence(everywhere, surfaces, beta, owners, wake_angle, lateral=lateral)
    odd = reversed_part[0] if lateral else None
    plane = marked(surfaces, kinds, PLANE)
    mirrored_flow = _half(even, normal, e, jnp.diag(jnp.asarray(plane)) if plane.any() else None)
    reversed_flow = None
    if odd is not None:
        odd = odd * jnp.asarray(1.0 - 0.5 * plane)  # its own image is there already
        reversed_flow = _half(odd, normal, e, None)
    edges = [s.strip_edges for s in surfaces]
    trail = [_trace(s.rings[-1], wake_angle) for s in surfaces]
    lattice = Lattice(
        collocation,
        jnp.concatenate([s.across.reshape(2, -1, 3) for s in surfaces], axis=1),
        jnp.concatenate(
            [jnp.tile(s.strip_chord, rows) for s, (rows, _) in zip(surfaces, shapes(surfaces), strict=True)]
        ),
        normal,
        jnp.concatenate([s.normal_hinge.reshape(2, s.normal_hinge.shape[1], -1, 3) for s in surfaces], axis=2)
        if surfaces[0].normal_hinge.shape[1]
        else jnp.zeros((2, 0, n, 3)),
        points,
        middles,
        lines,
        jnp.concatenate([between(q[:-1], q[1:], s.middle) for q, s in zip(edges, surfaces, strict=True)]),
        jnp.concatenate([q[1:] - q[:-1] for q in edges]),
        jnp.concatenate([s.strip_chord for s in surfaces]),
        jnp.concatenate([s.strip_width for s in surfaces]),
        jnp.concatenate(trail),
        jnp.concatenate([between(q[:-1], q[1:], s.middle) for q, s in zip(trail, surfaces, strict=True)]),
        mirrored_flow,
        reversed_flow,
        _whole(mirrored_flow, reversed_flow, marked(surfaces, kinds, SINGLE)),
    )
    return lattice, (even[n + e :], None if odd is None else odd[n + e :])


def marked(surfaces: Sequence[Panels], kinds: Sequence[str] | None, kind: str) -> np.ndarray:
    """1 for every panel of the surfaces of a kind, 0 for the others."""
    sizes = [a * b for a, b in shapes(surfaces)]
    return np.repeat([float(k == kind) for k in kinds or [""] * len(sizes)], sizes)


def _half(velocity: Float[Array, "p 3 n"], normal: Float[Array, "n 3"], e: int, idle) -> Half:
    """Matrix, factors and velocities at the points of attack; ``idle`` unknowns are held at zero."""
    n = normal.shape[0]
    matrix = jnp.einsum("pi,pin->pn", normal, velocity[:n])
    matrix = matrix if idle is None else matrix + idle
    return Half(matrix, lu_factor(jax.lax.stop_gradient(matrix)), velocity[n : n + e])


def _whole(even: Half, odd: Half | None, single: np.ndarray) -> Whole | None:
    """System of both halves where a surface has no image: there the unknowns of the port half are held at zero."""
    if not single.any() or odd is None:
        return None
    keep = jnp.asarray(1.0 - single)
    same, other = (even.matrix + odd.matrix) / 2, (even.matrix - odd.matrix) / 2
    port = [keep[:, None] * other, keep[:, None] * same + jnp.diag(1.0 - keep)]
    matrix = jnp.concatenate([jnp.concatenate(row, axis=1) for row in ([same, other], port)])
    return Whole(matrix, lu_factor(jax.lax.stop_gradient(matrix)), keep)


def by_symmetry(
    lattice: Lattice, by: Callable[[Half | Whole, Float[Array, " _"]], Float[Array, " _"]], halves: Float[Array, "h n"]
) -> Float[Array, "h n"]:
    """What a linear function of the systems, as `solve`, makes of a half, or of both halves.

    The port half is as the plane of symmetry mirrors it. Two systems of half the size, for the mirrored and the
    reversed part; one of full size where a surface has no image.
    """
    if len(halves) == 1:
        return by(lattice.even, halves[0])[None]
    assert lattice.odd is not None
    if lattice.whole is not None:
        return by(lattice.whole, halves.ravel()).reshape(2, -1)
    even, odd = by(lattice.even, (halves[0] + halves[1]) / 2), by(lattice.odd, (halves[0] - halves[1]) / 2)
    return jnp.stack([even + odd, even - odd])


def both_parts(values: Sequence[Array]) -> tuple[Array, Array | None]:
    """Mirrored and reversed part of what two halves have; one half has no reversed part."""
    if len(values) == 1:
        return values[0], None
    return (values[0] + values[1]) / 2, (values[0] - values[1]) / 2


def induced(even: Array, odd: Array | None, gamma: Float[Array, "h n"]) -> Float[Array, "h *p"]:
    """What circulations induce, by their influence in mirrored and in reversed flow."""
    mirrored, reversed_ = both_parts(list(gamma))
    if reversed_ is None:
        return (even @ mirrored)[None]
    assert odd is not None
    one, other = even @ mirrored, odd @ reversed_
    return jnp.stack([one + other, one - other])


def present(lattice: Lattice, halves: Float[Array, "h n"]) -> Float[Array, "h n"]:
    """Values of panels, zero where the port half has none."""
    if lattice.whole is None or len(halves) == 1:
        return halves
    return halves * jnp.stack([jnp.ones_like(lattice.whole.keep), lattice.whole.keep])


def solve(half: Half | Whole, rhs: Float[Array, "n *m"]) -> Float[Array, "n *m"]:
    """Circulations for right-hand sides; derivatives reuse the factorisation (implicit function theorem)."""

    def by_lu(transpose):
        return lambda _, b: lu_solve(half.lu, b, trans=transpose)

    return jax.lax.custom_linear_solve(lambda g: half.matrix @ g, rhs, by_lu(0), transpose_solve=by_lu(1))


class Owners(NamedTuple):
    """Components: of every point (-1: none), and of every surface."""

    points: np.ndarray
    surfaces: tuple[int, ...]


def _owners(surfaces: Sequence[Panels], components: Sequence[int], others: int) -> Owners:
    """Components of the collocation points, the points of attack and other points."""
    cuts = shapes(surfaces)
    panels = np.repeat(components, [a * b for a, b in cuts])
    filaments = np.repeat(components, [a * b + a * (b + 1) for a, b in cuts])
    return Owners(np.concatenate([panels, filaments, np.full(others, -1)]), tuple(components))


def _influence(points, surfaces: Sequence[Panels], beta, owners: Owners | None, angle, *, lateral: bool):
    """Velocities [p 3 n] per unit ring circulation in mirrored flow and, if wanted, in reversed flow.

    In blocks, at a third of the time; vortices with cores and turned wakes only in whole arrays.
    """
    if owners is None and angle is None:
        axes = jnp.broadcast_to(jnp.eye(3), (points.shape[0], 3, 3))
        mixtures = (EVEN, ODD) if lateral else (EVEN,)
        out = influence(points, axes, [s.rings for s in surfaces], beta=beta, mixtures=mixtures)
        return [v[: points.shape[0]] for v in out]
    own, image = ring_velocities(points, surfaces, beta, owners, _direction(angle, beta))
    return [own + image, own - image]


def ring_velocities(
    points, surfaces: Sequence[Panels], beta, owners: Owners | None = None, wake: Array | None = None
) -> tuple[Float[Array, "p 3 n"], Float[Array, "p 3 n"]]:
    """Velocity vectors at ``points`` per unit ring circulation: of the starboard half, and of its mirror image.

    The image of a half is the mirrored velocity at the mirrored point, so one call of the kernel gives both.
    With ``owners`` vortices have a core at the points of other components; ``wake`` is the unit vector along the
    wake lines in stretched coordinates, in the plane of symmetry.
    """
    count, mirror = points.shape[0], jnp.asarray(MIRROR)
    p = jnp.concatenate([points, points * mirror]) * _stretch(beta)
    axes = jnp.broadcast_to((jnp.eye(3) * _stretch(beta))[:, None, :], (3, *p.shape))
    weights = jnp.concatenate([jnp.cross(axes, jnp.broadcast_to(p, axes.shape)), axes], axis=-1)
    strange: list[np.ndarray | None] = [None] * len(surfaces)
    if owners is not None:
        strange = [np.tile((owners.points != c) & (owners.points >= 0), 2) for c in owners.surfaces]
    pairs = zip(surfaces, strange, strict=True)
    both = jnp.concatenate([_rings(*_project(weights, p, s, beta, other, wake)) for s, other in pairs], axis=-1)
    return jnp.moveaxis(both[:, :count], 0, 1), jnp.moveaxis(both[:, count:] * mirror[:, None, None], 0, 1)


def _stretch(beta):
    """Prandtl-Glauert: coordinates and the x velocity both take 1/beta along x."""
    return jnp.stack([1.0 / beta, jnp.ones_like(beta), jnp.ones_like(beta)])


def _stack(surfaces, name):
    """One array of all panels."""
    return jnp.concatenate([getattr(s, name).reshape(-1, 3) for s in surfaces])


def _direction(angle, beta):
    """Unit vector along the wake lines in stretched coordinates, None for the x axis."""
    if angle is None:
        return None
    line = jnp.stack([jnp.cos(angle), jnp.zeros_like(angle), jnp.sin(angle)]) * _stretch(beta)
    return line / jnp.linalg.norm(line)


def _trace(nodes: Float[Array, "t 3"], angle) -> Float[Array, "t 2"]:
    """Places of trailing nodes in a plane across the wake."""
    if angle is None:
        return nodes[:, 1:]
    return jnp.stack([nodes[:, 1], nodes[:, 2] * jnp.cos(angle) - nodes[:, 0] * jnp.sin(angle)], axis=-1)


def _project(weights, p, surface, beta, strange: np.ndarray | None, wake) -> tuple[Array, ...]:
    """Kernel times arm for the three families of filaments of one surface, directions first."""
    rings = surface.rings * _stretch(beta)
    k: Filaments = kernels(p, rings, wake)
    if strange is not None and strange.any():
        k = jax.tree.map(
            lambda one, f: jnp.where(strange.reshape(-1, *[1] * (one.ndim - 1)), f * one, one), k, _cores(p, rings)
        )
    a: Arms = arms(rings, wake)
    return tuple(ki * jnp.tensordot(weights, ai, axes=([-1], [-1])) for ki, ai in zip(k, a, strict=True))


def _cores(p: Float[Array, "p 3"], rings: Float[Array, "nc1 ns1 3"]) -> Filaments:
    """Factor h^2 / sqrt(h^4 + core^4) of every filament, h being the distance from its line.

    Leishman's fourth-power variant of Scully's core (Leishman, Principles of Helicopter Aerodynamics, section
    10.6), which AVL takes between components. On an edge between two strips the mean of their widths counts.
    """
    width = jnp.linalg.norm(rings[-1, 1:, 1:] - rings[-1, :-1, 1:], axis=-1)
    edge = jnp.concatenate([width[:1], (width[1:] + width[:-1]) / 2, width[-1:]])

    def factor(square, core):
        return square / jnp.sqrt(square**2 + (CORE_WIDTHS * core) ** 4)

    def distance(a, b):
        offset, line = p[:, None, None] - a, b - a
        return jnp.sum(jnp.cross(offset, line) ** 2, axis=-1) / jnp.sum(line**2, axis=-1)

    wake = jnp.sum((p[:, None, 1:] - rings[-1, :, 1:]) ** 2, axis=-1)
    bound = factor(distance(rings[:-1, :-1], rings[:-1, 1:]), width)
    return Filaments(bound, factor(distance(rings[:-1], rings[1:]), edge), factor(wake, edge))


def _rings(bound, chordwise, wake):
    """Filaments to rings: front minus rear bound line, right minus left chordwise line, wake last."""
    rear = jnp.pad(bound[..., 1:, :], ((0, 0), (0, 0), (0, 1), (0, 0)))
    ring = bound - rear + chordwise[..., 1:] - chordwise[..., :-1]
    ring = ring.at[..., -1, :].add(wake[..., 1:] - wake[..., :-1])
    return ring.reshape(*ring.shape[:2], -1)


def _filaments(surface: Panels):
    """Points of attack, middles and vectors of the bound filaments, then of the chordwise ones."""
    rings = surface.rings
    left, right, front, back = rings[:-1, :-1], rings[:-1, 1:], rings[:-1], rings[1:]
    along = (front + back) / 2
    points = [between(left, right, surface.middle), along]
    pairs = (points, [(left + right) / 2, along], [right - left, back - front])
    return tuple(jnp.concatenate([p.reshape(-1, 3) for p in pair]) for pair in pairs)
