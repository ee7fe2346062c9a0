"""Strips of all surfaces: their panels, what they shed, and how slipstreams meet them."""

from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.geometry import Panels, between
from hera_om.physics.lattice import Lattice, prandtl_glauert


class Strips(NamedTuple):
    """Strips of one surface as slipstreams meet them; u nodes of their edges, on the half itself, then on its image."""

    point: Float[Array, "n 3"]  # m
    along: Float[Array, "n 3"]  # unit vector along the strip, across x
    chord: Float[Array, " n"]  # over sqrt(1 - M^2), m
    nodes: Float[Array, "n u"]  # length along the surface from the strip to the nodes, where vortices trail, m
    there: Float[Array, " u"]  # 1 where there is such a node, 0 on an image that the surface does not have


def strip_of_panels(surfaces: Sequence[Panels]) -> tuple[np.ndarray, np.ndarray]:
    """Index of every panel's strip, and of every strip's last panel, whose ring has the circulation of the strip."""
    first, panel, parts, last = 0, 0, [], []
    for panels in surfaces:
        rows, strips = panels.normal.shape[:2]
        parts.append(np.tile(first + np.arange(strips), rows))
        first, panel = first + strips, panel + rows * strips
        last.append(panel - strips + np.arange(strips))
    return np.concatenate(parts), np.concatenate(last)


def shed(own: Float[Array, " n"], other: Float[Array, " n"]) -> Float[Array, " u"]:
    """Steps of the circulation of a surface along the span, at the nodes of a half and then at those of its image.

    Args:
        own: circulation of its strips.
        other: of those of the other half, as the plane of symmetry mirrors it.
    """
    return jnp.concatenate([_steps(own), -_steps(other)])


def _steps(strength: Float[Array, " n"]) -> Float[Array, " n1"]:
    none = jnp.zeros(1)
    return jnp.diff(strength, prepend=none, append=none)


def by_surface(surfaces: Sequence[Panels], strips: Float[Array, "*h n"]) -> list[Float[Array, "*h _"]]:
    """What all strips have, surface by surface."""
    return jnp.split(strips, np.cumsum([p.strip_width.shape[0] for p in surfaces])[:-1], axis=-1)


def met_strips(
    surfaces: Sequence[Panels], lattice: Lattice, mirrored: Float[Array, " m"], mach: Float[Array, ""] | float
) -> tuple[Strips, ...]:
    """The strips of m surfaces.

    Args:
        surfaces: of a half.
        lattice: made of them.
        mirrored: 1 for every surface that has an image, else 0.
        mach: Mach number.

    Returns:
        Strips of each. A surface is taken as straight across the plane of symmetry.
    """
    along = lattice.strip_edge * jnp.asarray([0.0, 1.0, 1.0])
    along = along / jnp.linalg.norm(along, axis=1, keepdims=True)
    out, first = [], 0
    for panels, image in zip(surfaces, mirrored, strict=True):
        edges = panels.strip_edges[0, 1] + jnp.append(0.0, jnp.cumsum(panels.strip_width))
        middles = between(edges[:-1], edges[1:], panels.middle)[:, None]
        here = slice(first, first + len(middles))
        there = jnp.concatenate([jnp.ones_like(edges), image * jnp.ones_like(edges)])
        nodes = jnp.concatenate([edges - middles, -edges - middles], axis=1)
        chord = lattice.strip_chord[here] / prandtl_glauert(mach)
        out.append(Strips(lattice.strip_point[here], along[here], chord, nodes, there))
        first = here.stop
    return tuple(out)
