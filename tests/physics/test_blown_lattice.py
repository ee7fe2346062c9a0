"""A lattice whose strips answer to its own lift: solved by factors as one dense system of both halves is."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.blown_lattice import make_blown, solve_blown
from hera_om.physics.finite_jet import JetEdges
from hera_om.physics.geometry import Sections, make_grid, make_panels
from hera_om.physics.lattice import assemble
from hera_om.physics.layout import FREE, PLANE, ROOTED, SINGLE

SHAPES = ((2, 4), (1, 3))
PANELS = 11


def lattice_of(kinds, chord=1.0, **how):
    """A wing and a smaller surface above and behind it, upright in the plane of symmetry."""
    one, panels = jnp.ones(2), []
    for (nc, ns), kind, x, y, z in zip(SHAPES, kinds, (0.0, 3.0), (0.0, 0.5), (0.0, 0.6), strict=False):
        ends = (0.0 * one, z + jnp.array([0.0, 1.5])) if kind == PLANE else (y + jnp.array([0.0, 3.0]), z * one)
        surface = Sections(x * one, *ends, chord * one, 0.0 * one)
        grid = make_grid([0.0, 4.0], ["flat"] * 2, nc=nc, ns=ns, span="cosine", chord="uniform")
        panels.append(make_panels(surface, grid))
    return panels, assemble(panels, jnp.asarray(0.2), kinds=kinds, **how)[0]


def edges_of(kinds, halves):
    """Large, and alike in nothing; 0 where a surface has no image."""
    rng = np.random.default_rng(3)

    def one(ns, kind):
        there = np.repeat([1.0, float(kind in (ROOTED, FREE))], ns + 1)
        shed, moment = 0.15 * rng.standard_normal((2, halves, ns, 2 * (ns + 1))) * there
        return JetEdges(jnp.asarray(shed), jnp.asarray(moment), jnp.asarray(0.2 * rng.standard_normal((halves, ns))))

    return [one(ns, kind) for (_, ns), kind in zip(SHAPES, kinds, strict=False)]


def shares(n):
    return jnp.asarray(np.random.default_rng(4).standard_normal((2, n)))


def by_one_system(lattice, weights, edges, needed):
    """The definition written out: every ring alone, what it brings everywhere and what edges answer."""
    h, n = needed.shape
    even, shapes = np.asarray(lattice.even.matrix), SHAPES[: len(edges)]
    odd = even if h == 1 else np.asarray(lattice.odd.matrix)
    same, other = (even + odd) / 2, (even - odd) / 2
    direct = same if h == 1 else np.block([[same, other], [other, same]])
    surface = np.repeat(range(len(shapes)), [nc * ns for nc, ns in shapes])
    local = np.concatenate([np.tile(np.arange(ns), nc) for nc, ns in shapes])
    last = np.concatenate([np.arange(nc * ns) >= (nc - 1) * ns for nc, ns in shapes])

    def answer(i, row, half, panel):
        k = surface[row]
        if surface[panel] != k:
            mates = (surface == k) & (local == local[row])
            met = weights[0, mates] @ direct[i * n : i * n + n, half * n + panel][mates]
            return -edges[k].others[i, local[row]] * met
        own, image = i == half, h == 1 or i != half
        inner, outer = local[panel], local[panel] + 1
        steps = np.zeros(edges[k].shed.shape[-1])
        steps[[inner, outer]] += [own, -own]
        steps[np.array([inner, outer]) + SHAPES[k][1] + 1] += [-image, image]
        both = last[panel] * edges[k].shed[i] + weights[1, panel] * edges[k].moment[i]
        return both[local[row]] @ steps

    every = [(i, p) for i in range(h) for p in range(n)]
    answers = np.array([[answer(*to, *of) for of in every] for to in every])
    keep = np.ones(n) if lattice.whole is None else np.asarray(lattice.whole.keep)
    there = np.concatenate([np.ones(n), keep])[: h * n] > 0
    lift = np.zeros(h * n)
    lift[there] = np.linalg.solve((direct - answers)[np.ix_(there, there)], needed.ravel()[there])
    return lift.reshape(h, n)


@pytest.mark.parametrize(
    "kinds,halves", [((ROOTED,), 1), ((ROOTED, FREE), 1), ((ROOTED,), 2), ((ROOTED, FREE), 2), ((ROOTED, SINGLE), 2)]
)
def test_lifts_are_those_of_one_dense_system(kinds, halves):
    panels, lattice = lattice_of(kinds, lateral=halves == 2)
    weights = shares(lattice.chord.shape[0])
    needed = np.random.default_rng(5).standard_normal((halves, weights.shape[1]))
    if lattice.whole is not None:
        needed[1] *= lattice.whole.keep
    edges = edges_of(kinds, halves)
    blown = jax.jit(
        lambda e: solve_blown(panels, lattice, make_blown(panels, lattice, weights), e, jnp.asarray(needed))
    )
    found, still = blown(edges), blown(jax.tree.map(jnp.zeros_like, edges))
    expected = by_one_system(lattice, np.asarray(weights), jax.tree.map(np.asarray, edges), needed)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-11)
    assert np.max(np.abs(found - still)) > 0.1 * np.max(np.abs(found))


def test_a_fin_in_the_plane_of_symmetry_carries_nothing_in_mirrored_flow():
    kinds = (ROOTED, PLANE)
    panels, lattice = lattice_of(kinds, lateral=True)
    blown = make_blown(panels, lattice, shares(PANELS))
    one = jnp.concatenate([jnp.ones(8), jnp.zeros(3)])
    mirrored = jax.tree.map(lambda v: jnp.concatenate([v, v]), edges_of(kinds, 1))
    found = solve_blown(panels, lattice, blown, mirrored, jnp.stack([one, one]))
    np.testing.assert_allclose(found[0], found[1], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(found[:, 8:], 0.0, atol=1e-13)
    assert np.min(np.abs(found[:, :8])) > 0.0


@pytest.mark.parametrize("kinds,halves", [((ROOTED, FREE), 1), ((ROOTED, SINGLE), 2)])
def test_derivatives_come_from_the_same_factors(kinds, halves, check_derivatives):
    """By the edges, by what is needed, by geometry, which the matrices hold."""
    edges, base = edges_of(kinds, halves), np.random.default_rng(6).standard_normal((halves, PANELS))

    def lifts(x):
        panels, lattice = lattice_of(kinds, 1.0 + x[2], lateral=halves == 2)
        keep = 1.0 if lattice.whole is None else jnp.stack([jnp.ones(PANELS), lattice.whole.keep])
        blown = make_blown(panels, lattice, shares(PANELS))
        scaled = jax.tree.map(lambda v: (1.0 + x[0]) * v, edges)
        return solve_blown(panels, lattice, blown, scaled, keep * (base + x[1] * jnp.arange(PANELS) / 10)).ravel()

    check_derivatives(lifts, np.array([0.1, 0.3, 0.2]))
