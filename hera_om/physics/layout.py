"""Where panels, filaments and strips of several surfaces stand in the flat arrays of a lattice."""

from typing import NamedTuple

import numpy as np


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


def layout(shapes: list[tuple[int, int]]) -> Layout:
    """Index arrays of surfaces with (nc, ns) panels each, roots on the symmetry plane."""
    n, total_strips = sum(a * b for a, b in shapes), sum(b for _, b in shapes)
    parts: dict[str, list[np.ndarray]] = {f: [] for f in Layout._fields[2:]}
    panel = strip = node = 0
    for nc, ns in shapes:
        ring = panel + np.arange(nc * ns).reshape(nc, ns)
        row = strip + np.arange(ns)
        none = np.full((nc, 1), n)
        ahead = np.vstack([np.full((1, ns), n), ring[:-1]])
        left, right = np.hstack([none, ring]), np.hstack([ring, none])
        left[:, 0] = right[:, 0] = n  # on the symmetry plane the image cancels the root's filament
        edge_in, edge_out = np.r_[row[0], row], np.r_[row, row[-1]]
        parts["plus"] += [ring.ravel(), left.ravel()]
        parts["minus"] += [ahead.ravel(), right.ravel()]
        parts["inner"] += [np.tile(row, nc), np.tile(edge_in, nc)]
        parts["outer"] += [np.tile(row, nc), np.tile(edge_out, nc)]
        parts["share"] += [np.ones(nc * ns), np.full(nc * (ns + 1), 0.5)]
        parts["last"].append(ring[-1])
        parts["trail_plus"].append(np.r_[total_strips, row])
        parts["trail_minus"].append(np.r_[row, total_strips])
        parts["node"].append(node + np.arange(ns))
        panel, strip, node = panel + nc * ns, strip + ns, node + ns + 1
    arrays = {k: np.concatenate(v) if v else np.zeros(0, int) for k, v in parts.items()}
    return Layout(tuple(a * b for a, b in shapes), tuple(b for _, b in shapes), **arrays)
