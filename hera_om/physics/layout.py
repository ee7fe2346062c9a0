"""Where panels, filaments and strips of several surfaces stand in the flat arrays of a lattice."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

ROOTED, FREE, PLANE, SINGLE = "rooted", "free", "plane", "single"
"""How a surface meets the plane of symmetry: with its root on it, not at all, lying in it, or without any image."""


class Layout(NamedTuple):
    """Index arrays of numpy integers; index ``n`` of a padded array means nothing there.

    The e filaments are, surface by surface, the bound ones [nc, ns] and then the chordwise ones [nc, ns + 1].
    """

    counts: tuple[int, ...]  # panels of each surface
    strips: tuple[int, ...]  # strips of each surface
    plus: np.ndarray  # [e] ring that adds to a filament's circulation
    minus: np.ndarray  # [e] ring that takes from it
    inner: np.ndarray  # [e] strip that gets a filament's load, or half of it
    outer: np.ndarray  # [e] strip that gets the other half
    share: np.ndarray  # [e] part of the load for ``inner``
    last: np.ndarray  # [s] rings at the trailing edge
    trail_plus: np.ndarray  # [t] strips on either side of every trailing node
    trail_minus: np.ndarray  # [t]
    node: np.ndarray  # [s] inner trailing node of every strip
    root: np.ndarray  # [r] filaments on the plane of symmetry, whose image cancels them in mirrored flow
    root_ring: np.ndarray  # [r] the rings that they belong to
    loaded: np.ndarray  # [e] 1 where the force on a filament counts, else 0
    weight: np.ndarray  # [s] part of a strip that belongs to a half: 1/2 in the plane of symmetry
    image: np.ndarray  # [s] 1 where the port half has the strip too, 0 where it has not


def layout(
    shapes: Sequence[tuple[int, int]], kinds: Sequence[str] | None = None, *, chordwise_loads: bool = True
) -> Layout:
    """Index arrays of surfaces with (nc, ns) panels each; all are rooted unless ``kinds`` says otherwise.

    Without ``chordwise_loads`` only the bound filaments carry force, as in AVL.
    """
    n, total_strips = sum(a * b for a, b in shapes), sum(b for _, b in shapes)
    parts: dict[str, list[np.ndarray]] = {f: [] for f in Layout._fields[2:]}
    panel = strip = node = filament = 0
    for (nc, ns), kind in zip(shapes, kinds or [ROOTED] * len(shapes), strict=True):
        ring = panel + np.arange(nc * ns).reshape(nc, ns)
        row = strip + np.arange(ns)
        none = np.full((nc, 1), n)
        ahead = np.vstack([np.full((1, ns), n), ring[:-1]])
        left, right = np.hstack([none, ring]), np.hstack([ring, none])
        along = filament + nc * ns + np.arange(nc * (ns + 1)).reshape(nc, ns + 1)
        if kind == ROOTED:
            left[:, 0] = right[:, 0] = n
            parts["root"].append(along[:, 0])
            parts["root_ring"].append(ring[:, 0])
        edge_in, edge_out = np.r_[row[0], row], np.r_[row, row[-1]]
        parts["plus"] += [ring.ravel(), left.ravel()]
        parts["minus"] += [ahead.ravel(), right.ravel()]
        parts["inner"] += [np.tile(row, nc), np.tile(edge_in, nc)]
        parts["outer"] += [np.tile(row, nc), np.tile(edge_out, nc)]
        parts["loaded"] += [np.ones(nc * ns), np.full(nc * (ns + 1), float(chordwise_loads))]
        parts["share"] += [np.ones(nc * ns), np.full(nc * (ns + 1), 0.5)]
        parts["last"].append(ring[-1])
        parts["trail_plus"].append(np.r_[total_strips, row])
        parts["trail_minus"].append(np.r_[row, total_strips])
        parts["node"].append(node + np.arange(ns))
        parts["weight"].append(np.full(ns, 0.5 if kind == PLANE else 1.0))
        parts["image"].append(np.full(ns, 0.0 if kind == SINGLE else 1.0))
        panel, strip, node, filament = panel + nc * ns, strip + ns, node + ns + 1, along[-1, -1] + 1
    arrays = {k: np.concatenate(v) if v else np.zeros(0, int) for k, v in parts.items()}
    return Layout(tuple(a * b for a, b in shapes), tuple(b for _, b in shapes), **arrays)
