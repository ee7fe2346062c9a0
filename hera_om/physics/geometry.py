"""Lattice geometry of straight-segment lifting surfaces."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.airfoil import camber_line

QUARTER = 0.25  # the bound vortex lies at a quarter of its panel (Pistolesi), the condition at three quarters
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
    camber: Float[Numbers, "k nc1"]  # camber height over chord at xi
    slope: Float[Numbers, "k nc"]  # camber slope at the collocation points
    hinge_share: Float[Numbers, "nc ns"]  # part of each panel behind the hinge line, times the control's gain


class Panels(NamedTuple):
    """Everything that the lattice needs of one surface; nc rows from nose to tail, ns strips."""

    rings: Float[Array, "nc1 ns1 3"]  # ring nodes: bound lines, then the trailing edge
    collocation: Float[Array, "nc ns 3"]
    across: Float[Array, "2 nc ns 3"]  # at each collocation point: middle of the strip, its width as a vector
    normal: Float[Array, "nc ns 3"]
    normal_hinge: Float[Array, "nc ns 3"]  # derivative of the normal by the control angle, per rad
    strip_edges: Float[Array, "ns1 3"]  # quarter-chord points of the strip edges
    middle: Float[Array, " ns"]  # see Grid
    strip_chord: Float[Array, " ns"]
    strip_width: Float[Array, " ns"]  # length of the strip in the y-z plane, m


def spacing(name: str, n: int) -> np.ndarray:
    """n + 1 points from 0 to 1: ``uniform``, ``cosine`` (dense at both ends) or ``sine`` (dense at 1)."""
    u = np.linspace(0.0, 1.0, n + 1)
    shapes = {"uniform": u, "cosine": (1 - np.cos(np.pi * u)) / 2, "sine": np.sin(np.pi * u / 2)}
    return shapes[name]


def span_weights(y, n: int, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """Interpolation weights ``[n + 1, k]`` of spanwise edges that contain the k sections, and the middles.

    The strips are shared among the segments by their part of the spacing law, at least one each. The
    condition of a strip stands at the middle of its interval of the law's parameter, not of its width: with a
    law that follows the tip's square root, the induced drag of an elliptic load is then exact on any number
    of strips (as in AVL).
    """
    y = np.asarray(y, float)
    k = len(y)
    eta = (y - y[0]) / (y[-1] - y[0])
    fine = np.linspace(0.0, 1.0, 2001)
    law = spacing(kind, 2000)
    u = np.interp(eta, law, fine)
    counts = _share(np.diff(u), n)
    rows, middle = [], []
    for i, count in enumerate(counts):
        both = np.interp(np.linspace(u[i], u[i + 1], 2 * count + 1), fine, law)
        local = both[::2]
        middle.append((both[1::2] - local[:-1]) / np.diff(local))
        t = (local - local[0]) / (local[-1] - local[0])
        block = np.zeros((count + 1, k))
        block[:, i], block[:, i + 1] = 1 - t, t
        rows.append(block[(0 if i == 0 else 1) :])
    return np.concatenate(rows), np.concatenate(middle)


def _share(lengths: np.ndarray, n: int) -> list[int]:
    """Whole numbers that sum to n, in proportion to ``lengths`` (largest remainder, at least one)."""
    if n < len(lengths):
        raise ValueError(f"{n} strips cannot resolve {len(lengths)} segments")
    exact = lengths / lengths.sum() * (n - len(lengths))
    counts = np.floor(exact).astype(int) + 1
    for i in np.argsort(np.floor(exact) - exact)[: n - counts.sum()]:
        counts[i] += 1
    return counts.tolist()


def make_grid(y, airfoils, *, nc: int, ns: int, span: str, chord: str) -> Grid:
    """Cut a surface into nc x ns panels.

    Args:
        y: spanwise positions of the k sections, m (only their ratios matter).
        airfoils: k airfoil names.
        nc: panels along the chord.
        ns: panels along the span.
        span: name of the spacing law along the span.
        chord: the same along the chord.

    Returns:
        Grid of numpy arrays, without controls.
    """
    xi = spacing(chord, nc)
    weights, middle = span_weights(y, ns, span)
    at = xi[:-1] + (1 - QUARTER) * np.diff(xi)
    camber = np.stack([camber_line(a, xi)[0] for a in airfoils])
    slope = np.stack([camber_line(a, at)[1] for a in airfoils])
    return Grid(weights, middle, xi, camber, slope, np.zeros((nc, ns)))


def hinge_share(grid: Grid, y: Float[Array, " k"], *, ends, hinge, gain) -> Float[Array, "nc ns"]:
    """Share of every panel that lies behind a hinge line, times the control's gain.

    Args:
        grid: cut of the surface.
        y: spanwise positions of its sections, m.
        ends: inner and outer end of the control, m.
        hinge: hinge line, fraction of the chord.
        gain: deflection per unit of the command.
    """
    edges = grid.weights @ y
    along = jnp.clip((grid.xi[1:] - jnp.maximum(grid.xi[:-1], hinge)) / jnp.diff(grid.xi), 0.0, 1.0)
    inner, outer = jnp.maximum(edges[:-1], ends[0]), jnp.minimum(edges[1:], ends[1])
    across = jnp.clip((outer - inner) / jnp.diff(edges), 0.0, 1.0)
    return gain * along[:, None] * across[None, :]


def surface_mesh(sections: Sections, grid: Grid, shape: str = CAMBER) -> Float[Array, "nc1 ns1 3"]:
    """Corner points of the panels.

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
    """Vortex rings, collocation points and normals of one surface.

    Rings after Katz & Plotkin, Low-Speed Aerodynamics 2e, section 12.3; the deflection of a control turns the
    normals of the panels behind its hinge (the share of a panel that the hinge cuts), as in AVL.
    """
    mesh = surface_mesh(sections, grid, shape)
    along = mesh[1:] - mesh[:-1]
    rings = jnp.concatenate([mesh[:-1] + QUARTER * along, mesh[-1:]])
    rear = mesh[:-1] + (1 - QUARTER) * along
    collocation = between(rear[:, :-1], rear[:, 1:], grid.middle)
    spans = jnp.stack([(rear[:, :-1] + rear[:, 1:]) / 2, rear[:, 1:] - rear[:, :-1]])
    across = _strip_directions(rings)
    lines = jnp.broadcast_to(across, collocation.shape) if shape == FLAT else rear[:, 1:] - rear[:, :-1]
    normal = _normals(sections, grid, across, lines)
    middle = jnp.asarray(grid.middle)
    hinge = jnp.asarray(grid.hinge_share)[..., None] * jnp.cross(jnp.broadcast_to(across, normal.shape), normal)
    x_le, y, z, chord, _ = (jnp.asarray(grid.weights) @ s for s in sections)
    edges = jnp.stack([x_le + QUARTER * chord, y, z], axis=-1)
    width = jnp.sqrt(jnp.sum((edges[1:, 1:] - edges[:-1, 1:]) ** 2, axis=-1))
    return Panels(
        rings,
        collocation,
        spans,
        normal,
        hinge,
        edges,
        middle,
        between(chord[:-1], chord[1:], middle),
        width,
    )


def between(left, right, share):
    """Points between the edges of the strips, at ``share`` of the way."""
    return left + (right - left) * share[:, None] if left.ndim > 1 else left + (right - left) * share


def _strip_directions(rings):
    """Unit vectors along the strips, projected on the y-z plane, ``[ns, 3]``."""
    d = rings[-1, 1:] - rings[-1, :-1]
    d = d * jnp.asarray([0.0, 1.0, 1.0])
    return d / jnp.linalg.norm(d, axis=-1, keepdims=True)


def _normals(sections, grid, across, lines):
    """Unit normals at the collocation points, across the camber line and the spanwise ``lines``.

    The slope is that of the camber line at the point: with the mean slope of the panel the camber's lift
    would converge at first order only.
    """
    middle = between(grid.weights[:-1], grid.weights[1:], grid.middle)
    angle = (middle @ sections.twist) - jnp.arctan(middle @ grid.slope).T
    up = jnp.stack([jnp.zeros_like(across[:, 0]), -across[:, 2], across[:, 1]], axis=-1)
    along = jnp.cos(angle)[..., None] * jnp.asarray([1.0, 0.0, 0.0]) - jnp.sin(angle)[..., None] * up
    normal = jnp.cross(along, lines)
    return normal / jnp.linalg.norm(normal, axis=-1, keepdims=True)
