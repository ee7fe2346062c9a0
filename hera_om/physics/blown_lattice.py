"""A lattice in slipstreams: its equations with what their edges answer to its own lift, solved by its factors.

The edges' downwash is the same along a strip, so that it adds to the matrix a term of as low a rank as there are
strips, which Woodbury's formula brings in: slipstreams change, the factorisation does not.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.linalg import lu_solve
from jaxtyping import Array, Float

from hera_om.physics.finite_jet import JetEdges
from hera_om.physics.geometry import Panels
from hera_om.physics.lattice import Lattice, by_symmetry, induced, present, shapes
from hera_om.physics.strips import by_surface, shed, strip_of_panels


class Blown(NamedTuple):
    """What a lattice needs besides its matrices where slipstreams meet it."""

    shares: Float[Array, "2 n"]  # of each panel in its strip, see `finite_jet.chord_shares`
    others: tuple[Array, Array | None] | None  # [s n] normal velocity of strips by other surfaces; by symmetry
    # lifts of all panels by the normal velocity of each strip, of a half and of both; no derivatives
    lifts: tuple[Float[Array, "s 1 n"], Float[Array, "s2 2 n"] | None]


def make_blown(surfaces: Sequence[Panels], lattice: Lattice, shares: Float[Array, "2 n"]) -> Blown:
    """What slipstreams need of a lattice.

    Args:
        surfaces: panels that the lattice was made of.
        lattice: of any kind of surfaces.
        shares: see `finite_jet.chord_shares`, by panel.
    """
    strip, last = strip_of_panels(surfaces)
    owner = np.repeat(np.arange(len(surfaces)), [a * b for a, b in shapes(surfaces)])
    foreign = None
    if len(surfaces) > 1:
        mean = jnp.zeros((len(last), len(strip))).at[strip, np.arange(len(strip))].set(shares[0])
        other = jnp.asarray((owner[:, None] != owner).astype(float))
        odd = None if lattice.odd is None else mean @ (other * lattice.odd.matrix)
        foreign = (mean @ (other * lattice.even.matrix), odd)

    def lifts(halves):
        each = jnp.eye(halves * len(last)).reshape(-1, halves, len(last))
        return jax.vmap(lambda v: _by_factors(lattice, present(lattice, v[:, strip])))(each)

    return Blown(shares, foreign, (lifts(1), None if lattice.odd is None else lifts(2)))


def solve_blown(
    surfaces: Sequence[Panels], lattice: Lattice, blown: Blown, edges: Sequence[JetEdges], needed: Float[Array, "h n"]
) -> Float[Array, "h n"]:
    """Lifts of the rings that bring the normal velocities ``needed`` and those that edges make of the lifts.

    Args:
        surfaces: of a half.
        lattice: made of them.
        blown: made of both.
        edges: of all slipstreams together at each surface, see `finite_jet.jet_edges`; axes [h ...].
        needed: by the stream and the slipstreams, of each half.

    Returns:
        Strengths of the rings; exact derivatives of any order by all of it, from the same factors.
    """
    strip, last = strip_of_panels(surfaces)
    h, s = len(needed), len(last)
    answer = _answer(surfaces, blown, edges)

    def spread(downwash):
        return present(lattice, downwash[:, strip])

    def equations(lift):
        return by_symmetry(lattice, lambda part, v: part.matrix @ v, lift) - spread(answer(lift))

    lifts = blown.lifts[h - 1]
    assert lifts is not None
    among = jax.vmap(lambda v: answer(v).ravel(), out_axes=1)(lifts)
    inverse = jax.lax.stop_gradient(jnp.linalg.inv(jnp.eye(h * s) - among))

    def by_factors(_, b):
        plain = _by_factors(lattice, b)
        return plain + jnp.tensordot(inverse @ answer(plain).ravel(), lifts, axes=1)

    def by_transpose(_, b):
        plain = _by_factors(lattice, b, trans=1)
        downwash = inverse.T @ jax.linear_transpose(spread, jnp.zeros((h, s)))(plain)[0].ravel()
        back = jax.linear_transpose(answer, b)(downwash.reshape(h, s))[0]
        return plain + _by_factors(lattice, back, trans=1)

    return jax.lax.custom_linear_solve(equations, needed, by_factors, transpose_solve=by_transpose)


def _answer(
    surfaces: Sequence[Panels], blown: Blown, edges: Sequence[JetEdges]
) -> Callable[[Float[Array, "h n"]], Float[Array, "h s"]]:
    """Downwash of the edges at the strips, as a function of the lifts."""
    strip, last = strip_of_panels(surfaces)

    def answer(lift):
        gamma = lift[:, last]
        moment = jnp.zeros_like(gamma).at[:, strip].add(blown.shares[1] * lift)
        pairs = zip(edges, by_surface(surfaces, gamma), by_surface(surfaces, moment), strict=True)
        own = jnp.concatenate([_of_surface(*each) for each in pairs], axis=1)
        if blown.others is None:
            return own
        return own - jnp.concatenate([e.others for e in edges], axis=1) * induced(*blown.others, lift)

    return answer


def _of_surface(edges: JetEdges, gamma: Float[Array, "h n"], moment: Float[Array, "h n"]) -> Float[Array, "h n"]:
    """Answer to what one surface sheds, by its circulation and the moment of its lift."""

    def side(edges, *halves):
        return edges.shed @ shed(*(h[0] for h in halves)) + edges.moment @ shed(*(h[1] for h in halves))

    both = jnp.stack([gamma, moment], axis=1)
    return jax.vmap(side)(edges, both, both[::-1])


def _by_factors(lattice: Lattice, halves: Float[Array, "h n"], trans: int = 0) -> Float[Array, "h n"]:
    """Solutions without edges; factors carry no derivatives."""
    return by_symmetry(lattice, lambda part, v: lu_solve(part.lu, v, trans=trans), halves)
