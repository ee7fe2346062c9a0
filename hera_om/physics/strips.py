"""Strips of all surfaces: their panels, what they shed, and how slipstreams meet them."""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.geometry import Panels, between
from hera_om.physics.lattice import Lattice


class Strips(NamedTuple):
    """Strips that slipstreams meet; u nodes of their edges, on the half itself and then on its image."""

    point: Float[Array, "n 3"]  # m
    along: Float[Array, "n 3"]  # unit vector along the strip, across x
    chord: Float[Array, " n"]  # m
    nodes: Float[Array, "n u"]  # length along the surface from the strip to the nodes, where vortices trail, m
    own: Float[Array, "n u"]  # 1 where they are those of the strip's surface, else 0


def strip_of_panels(surfaces: Sequence[Panels]) -> tuple[np.ndarray, np.ndarray]:
    """Index of every panel's strip, and of every strip's last panel, whose ring has the circulation of the strip."""
    first, panel, parts, last = 0, 0, [], []
    for panels in surfaces:
        rows, strips = panels.normal.shape[:2]
        parts.append(np.tile(first + np.arange(strips), rows))
        first, panel = first + strips, panel + rows * strips
        last.append(panel - strips + np.arange(strips))
    return np.concatenate(parts), np.concatenate(last)


def shed(surfaces: Sequence[Panels], own: Float[Array, " s"], other: Float[Array, " s"]) -> Float[Array, " u"]:
    """Steps of the circulation along the span at the nodes of a half, then at those of the other half.

    Args:
        surfaces: of the half.
        own: circulation of its strips.
        other: of those of the other half, as the plane of symmetry mirrors it.
    """
    return jnp.concatenate([_steps(surfaces, own), -_steps(surfaces, other)])


def _steps(surfaces: Sequence[Panels], strength: Float[Array, " s"]) -> Float[Array, " t"]:
    ends = np.cumsum([0, *(p.strip_width.shape[0] for p in surfaces)])
    none = jnp.zeros(1)
    return jnp.concatenate([jnp.diff(strength[a:b], prepend=none, append=none) for a, b in pairwise(ends)])


def met_strips(surfaces: Sequence[Panels], lattice: Lattice, mirrored: Float[Array, " m"]) -> Strips:
    """The strips of m surfaces.

    Args:
        surfaces: of a half.
        lattice: made of them.
        mirrored: 1 for every surface that has an image, else 0.

    Returns:
        Strips. A surface is taken as straight across the plane of symmetry.
    """
    along = lattice.strip_edge * jnp.asarray([0.0, 1.0, 1.0])
    arcs = [p.strip_edges[0, 1] + jnp.append(0.0, jnp.cumsum(p.strip_width)) for p in surfaces]
    middles = jnp.concatenate([between(e[:-1], e[1:], p.middle) for e, p in zip(arcs, surfaces, strict=True)])
    counts = np.array([e.shape[0] for e in arcs])
    own = np.repeat(np.eye(len(counts)), counts, axis=1)[np.repeat(np.arange(len(counts)), counts - 1)]
    edges = jnp.concatenate(arcs)
    both = jnp.concatenate([edges - middles[:, None], -edges - middles[:, None]], axis=1)
    image = own * jnp.repeat(mirrored, counts, total_repeat_length=own.shape[1])
    return Strips(
        point=lattice.strip_point,
        along=along / jnp.linalg.norm(along, axis=1, keepdims=True),
        chord=lattice.strip_chord,
        nodes=jnp.where(jnp.tile(own, 2) > 0.0, both, 1.0),
        own=jnp.concatenate([jnp.asarray(own), image], axis=1),
    )
