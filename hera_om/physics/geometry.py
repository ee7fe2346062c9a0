"""Lattice geometry of straight-segment lifting surfaces."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.core.spacing import chord_points, law_at, law_number
from hera_om.physics.airfoil import camber_line, thickness_growth

QUARTER = 0.25  # of the chord: where sections turn and strips have their points
CAMBER, FLAT = "camber", "flat"
Numbers = Array | np.ndarray


class Sections(NamedTuple):
    """Defining sections of a surface, from root to tip, geometry axes (x aft, y starboard, z up)."""

    x_le: Float[Array, " k"]  # leading edge, m
    y: Float[Array, " k"]  # m
    z: Float[Array, " k"]  # m
    chord: Float[Array, " k"]  # m
    twist: Float[Array, " k"]  # incidence of the section, nose up, rad


class Grid(NamedTuple):
    """How a surface is cut into panels; constant while its sections move."""

    weights: Float[Numbers, "ns1 k"]  # linear interpolation from the sections to the spanwise edges
    middle: Float[Numbers, " ns"]  # where in its strip the condition stands, 0 inboard to 1 outboard
    xi: Float[Numbers, " nc1"]  # chord fractions of the chordwise edges
    front: Float[Numbers, " nc"]  # where in its panel the vortex lies, 0 ahead to 1 behind
    rear: Float[Numbers, " nc"]  # where in its panel the condition stands
    camber: Float[Numbers, "k nc1"]  # camber height over chord at xi
    slope: Float[Numbers, "k nc"]  # camber slope at the collocation points
    growth: Float[Numbers, "k t"]  # of the thickness, see `airfoil.thickness_growth`


class Panels(NamedTuple):
    """Everything that the lattice needs of one surface; nc rows from nose to tail, ns strips."""

    rings: Float[Array, "nc1 ns1 3"]  # ring nodes: bound lines, then the trailing edge
    collocation: Float[Array, "nc ns 3"]
    across: Float[Array, "2 nc ns 3"]  # at each collocation point: middle of the strip, its width as a vector
    normal: Float[Array, "nc ns 3"]
    normal_hinge: Float[Array, "2 k nc ns 3"]  # derivative by each command, per rad; starboard, and port mirrored
    strip_edges: Float[Array, "ns1 3"]  # quarter-chord points of the strip edges
    middle: Float[Array, " ns"]  # see Grid
    strip_chord: Float[Array, " ns"]
    strip_width: Float[Array, " ns"]  # length of the strip in the y-z plane, m


def span_weights(y, n: int, law: float) -> tuple[np.ndarray, np.ndarray]:
    """Interpolation weights ``[n + 1, k]`` of spanwise edges that contain the k sections, and the middles.

    The strips are shared among the segments by their part of the spacing law, at least one each. The
    condition of a strip stands at the middle of its interval of the law's parameter, not of its width: with a
    law that follows the tip's square root, the induced drag of an elliptic load is then exact on any number
    of strips (as in AVL).
    """
    y = np.asarray(y, float)
    eta = (y - y[0]) / (y[-1] - y[0])
    fine = np.linspace(0.0, 1.0, 2001)
    spread = np.array([law_at(law, u) for u in fine])
    u = np.interp(eta, spread, fine)
    counts = _share(np.diff(u), n)
    rows = []
    for i, count in enumerate(counts):
        points = np.interp(np.linspace(u[i], u[i + 1], 2 * count + 1), fine, spread)
        rows.append((points - points[0]) / (points[-1] - points[0]))
    return segment_weights(rows)


def segment_weights(points) -> tuple[np.ndarray, np.ndarray]:
    """The same for given points of every segment: edges (even places) and middles (odd) of its strips, from 0 to 1."""
    k, rows, middle = len(points) + 1, [], []
    for i, at in enumerate(points):
        edges = np.asarray(at, float)[::2]
        middle.append((np.asarray(at)[1::2] - edges[:-1]) / np.diff(edges))
        block = np.zeros((len(edges), k))
        block[:, i], block[:, i + 1] = 1 - edges, edges
        rows.append(block[(0 if i == 0 else 1) :])
    return np.concatenate(rows), np.concatenate(middle)


def _share(lengths: np.ndarray, n: int) -> list[int]:
    """Whole numbers that sum to n, in proportion to ``lengths`` (largest remainder, at least one)."""
    if n < len(lengths):
        raise ValueError(f"{n} strips cannot resolve {len(lengths)} segments")
    exact = lengths / lengths.sum() * n
    counts = np.maximum(np.floor(exact).astype(int), 1)
    while counts.sum() != n:
        missing = n - counts.sum()
        rank = np.where((missing > 0) | (counts > 1), np.sign(missing) * (exact - counts), -np.inf)
        counts[np.argmax(rank)] += np.sign(missing)
    return counts.tolist()


def make_grid(y, airfoils, *, nc: int, ns: int, span: str, chord: str) -> Grid:
    """Cut a surface into nc x ns panels by laws of spacing, see `core.spacing`.

    Args:
        y: spanwise positions of the k sections, m (only their ratios matter).
        airfoils: k airfoils, see `airfoil.camber_line`.
        nc: panels along the chord.
        ns: panels along the span.
        span: law of spacing along the span.
        chord: the same along the chord.

    Returns:
        Grid of numpy arrays.
    """
    return cut(span_weights(y, ns, law_number(span)), airfoils, nc, law_number(chord))


def cut(span: tuple[np.ndarray, np.ndarray], airfoils, nc: int, law: float) -> Grid:
    """The grid with given spanwise weights and middles (`span_weights`), and nc panels by a law along the chord."""
    edges, vortices, conditions = (np.asarray(v) for v in chord_points(law, nc))
    width = np.diff(edges)
    camber = np.stack([camber_line(a, edges)[0] for a in airfoils])
    slope = np.stack([camber_line(a, conditions)[1] for a in airfoils])
    places = ((vortices - edges[:-1]) / width, (conditions - edges[:-1]) / width)
    return Grid(*span, edges, *places, camber, slope, np.stack([thickness_growth(a) for a in airfoils]))


def surface_mesh(sections: Sections, grid: Grid, shape: str = CAMBER) -> Float[Array, "nc1 ns1 3"]:
    """Corner points of the panels; places, chord, incidence and camber are linear from section to section.

    ``camber``: the points lie on the twisted camber surface, each section turned about its quarter chord.
    ``flat``: they lie on the untwisted chord surface, as in AVL, where camber and twist turn the normals.
    """
    x_le, y, z, chord, twist = (grid.weights @ s for s in sections)
    ahead = (grid.xi[:, None] - QUARTER) * chord
    if shape == FLAT:
        dx, dz = ahead, jnp.zeros_like(ahead)
    else:
        height = (grid.weights @ grid.camber).T * chord
        dx = ahead * jnp.cos(twist) + height * jnp.sin(twist)
        dz = height * jnp.cos(twist) - ahead * jnp.sin(twist)
    x = x_le + QUARTER * chord + dx
    return jnp.stack([x, jnp.broadcast_to(y, x.shape), z + dz], axis=-1)


def make_panels(sections: Sections, grid: Grid, shape: str = CAMBER) -> Panels:
    """Vortex rings, collocation points and normals of one surface, without controls.

    Rings after Katz & Plotkin, Low-Speed Aerodynamics 2e, section 12.3; see `controls` for deflections.
    """
    mesh = surface_mesh(sections, grid, shape)
    along = mesh[1:] - mesh[:-1]
    rings = jnp.concatenate([mesh[:-1] + grid.front[:, None, None] * along, mesh[-1:]])
    rear = mesh[:-1] + grid.rear[:, None, None] * along
    spans = jnp.stack([(rear[:, :-1] + rear[:, 1:]) / 2, rear[:, 1:] - rear[:, :-1]])
    collocation = between(rear[:, :-1], rear[:, 1:], grid.middle)
    across = _strip_directions(rings)
    bound, behind = rings[:-1, 1:] - rings[:-1, :-1], rear[:, 1:] - rear[:, :-1]
    lines = bound if shape == FLAT else behind  # AVL's normals stand on the bound filament
    normal = _normals(sections, grid, across, lines, ruled=shape == FLAT)
    middle = jnp.asarray(grid.middle)
    x_le, y, z, chord, _ = (jnp.asarray(grid.weights) @ s for s in sections)
    edges = jnp.stack([x_le + QUARTER * chord, y, z], axis=-1)
    return Panels(
        rings=rings,
        collocation=collocation,
        across=spans,
        normal=normal,
        normal_hinge=jnp.zeros((2, 0, *normal.shape)),
        strip_edges=edges,
        middle=middle,
        strip_chord=between(chord[:-1], chord[1:], middle),
        strip_width=jnp.sqrt(jnp.sum((edges[1:, 1:] - edges[:-1, 1:]) ** 2, axis=-1)),
    )


def between(left, right, share):
    """Points between the edges of the strips, at ``share`` of the way."""
    return left + (right - left) * share[:, None] if left.ndim > 1 else left + (right - left) * share


def _strip_directions(rings):
    """Unit vectors along the strips, projected on the y-z plane, ``[ns, 3]``."""
    d = rings[-1, 1:] - rings[-1, :-1]
    d = d * jnp.asarray([0.0, 1.0, 1.0])
    return d / jnp.linalg.norm(d, axis=-1, keepdims=True)


def _normals(sections, grid, across, lines, *, ruled: bool):
    """Unit normals at the collocation points, across the camber line and the spanwise ``lines``.

    The slope is that of the camber line at the point: with the mean slope of the panel the camber's lift
    would converge at first order only. ``ruled``: straight lines join the sections, as in AVL (its MAKESURF): chord
    times sine and chord times cosine of the incidence are linear, and chord times slope.
    """
    middle = between(grid.weights[:-1], grid.weights[1:], grid.middle)
    if ruled:
        chord = sections.chord
        twist = jnp.arctan2(middle @ (chord * jnp.sin(sections.twist)), middle @ (chord * jnp.cos(sections.twist)))
        slope = (middle @ (jnp.asarray(grid.slope) * chord[:, None])).T / (middle @ chord)
    else:
        twist, slope = middle @ sections.twist, (middle @ grid.slope).T
    angle = twist - jnp.arctan(slope)
    up = jnp.stack([jnp.zeros_like(across[:, 0]), -across[:, 2], across[:, 1]], axis=-1)
    along = jnp.cos(angle)[..., None] * jnp.asarray([1.0, 0.0, 0.0]) - jnp.sin(angle)[..., None] * up
    normal = jnp.cross(along, lines)
    return normal / jnp.linalg.norm(normal, axis=-1, keepdims=True)
