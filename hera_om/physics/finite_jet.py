"""What the edges of a round jet do to a wing that passes through it."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike

ANSWER_WIDTH = (0.110, 0.162)
ANSWER_POWERS = (0.451, 0.542)
ANSWER_SIZE = (0.556, 3.385, 0.0843, 10.0, 0.185)
"""Fits to the integral of `edge_answer`: 7 % of its value on the axis, 1 % of its integral along the span."""
BOUND_CENTRE = 0.6
"""Place along the wing whose bound vortices count most for another, over the distance of that from the axis."""
BOUND_MIDDLE = (0.53, 7.0)
"""Least answer to bound vortices about the middle of the chord over that about the quarter point, and how soon."""
BOUND_INTERPLAY = 0.25
"""Share of what edges do to each other that counts for bound vortices, whose flow is not one of planes across the jet
(choice, by boundary elements: lift of layered jets within 1.5 % to mu = 1.35, 7 % at 2; with 0 within 3.5 and 13 %,
with 0.5 within 3.5 and 10 %)."""
LEG_REACH = (1.7, 0.2)
LEG_SHARE = 0.5
"""Fits to how far behind the lift an edge has its whole answer to what trails, and to its mean over a plate."""
LEG_MIDDLE = 30.0
"""Fit to how much less that is for lift about the middle of the chord: from 2 / 3 to 1 / 2."""
LEAST_REACH = 1e-12
"""Keeps that reach differentiable."""
STILL = 1e-12
"""Keeps the strength of an edge between air that both rests defined."""
EDGE_ROUNDING = 0.02
"""Rounds off, in squares of the radius, what is inside and outside of an edge: by half a percent of it (choice)."""


class JetEdges(NamedTuple):
    """Downwash that the edges of a jet answer with, by strip, see `jet_edges`."""

    shed: Float[Array, "n u"]  # to a unit vortex that leaves the wing at a node, 1/m
    moment: Float[Array, "n u"]  # the same to the moment of the lift about the quarter point, see `chord_shares`
    others: Float[Array, " n"]  # to a unit downwash of all other surfaces


def reflection(
    inside: Float[Array, "..."] | ScalarLike, outside: Float[Array, "..."] | ScalarLike = 1.0
) -> Float[Array, "..."]:
    """Strength of the image in an edge, k = (mu_in^2 - mu_out^2) / (mu_in^2 + mu_out^2), from the squares of mu.

    Pressure and flow angle are the same on both sides of the edge; 0 without a jet, 1 for a jet in still air.

    Source: Glauert, The Lift and Drag of a Wing Spanning a Free Jet, ARC R&M 1603 (1934), for still air; Koning,
    in Durand, Aerodynamic Theory IV (1935), division M, for any ratio.
    """
    square = jnp.asarray(inside)
    return (square - outside) / (square + outside + STILL)


def edge_answer(eta2: Float[Array, "..."], radius: Float[Array, "..."] | ScalarLike) -> Float[Array, "..."]:
    """Downwash of a round edge of strength one, over the normal velocity that a wing of infinite span meets.

    The wing's flow is plane; the edge answers with sources -2 k times the normal velocity of it, whose upwash, weighted
    along the chord by the plate's pressure in either direction of flow, is k times this. Integrals by quadrature
    (`tests/physics/test_finite_jet.py`), here as

        S = A(rho) [(1 - eta^2)^2 + b eta^2]^-p (1 + q eta^2)^(2 p - 3/2),   b = b_1 / (rho^2 + b_2) ,
        A = a_1 asinh(a_2 rho) / (rho sqrt(rho^2 + a_3) (1 + a_4 rho^a_5)) .

    Arguments:
        eta2: square of the distance from the axis over the radius of the edge.
        radius: rho, of the edge over the chord, 0.15 to 6; broadcasts.

    Returns:
        S, positive.
    """
    (b_1, b_2), (p, q), (a_1, a_2, a_3, a_4, a_5) = ANSWER_WIDTH, ANSWER_POWERS, ANSWER_SIZE
    rho2 = jnp.asarray(radius) ** 2
    shape = ((1.0 - eta2) ** 2 + b_1 / (rho2 + b_2) * eta2) ** -p * (1.0 + q * eta2) ** (2.0 * p - 1.5)
    size = a_1 * jnp.arcsinh(a_2 * radius) / (radius * jnp.sqrt(rho2 + a_3) * (1.0 + a_4 * radius**a_5))
    return size * shape


def chord_shares(
    xi: Float[Array, " nc1"], front: Float[Array, " nc"], rear: Float[Array, " nc"]
) -> Float[Array, "2 nc"]:
    """Weights of the panels of a strip: of normal velocities in the circulation, of rings in the moment of the lift.

    In plane flow the first give circulation over pi and the chord. The second give the moment of the lift about the
    quarter point over a quarter of the chord: 0 of a plate, the circulation of lift about the middle of the chord.

    Arguments:
        xi: chord fractions of the panels' edges.
        front: where in its panel the vortex lies, 0 ahead to 1 behind.
        rear: where in its panel the condition stands.
    """
    bound, met = (xi[:-1] + part * jnp.diff(xi) for part in (front, rear))
    plane = 1.0 / (2.0 * jnp.pi * (met[:, None] - bound))
    arm = (bound - 0.25) / 0.25
    return jnp.stack([jnp.linalg.solve(plane.T, jnp.ones_like(met)) / jnp.pi, arm - jnp.append(arm[1:], 0.0)])


def jet_edges(
    place: Float[Array, " n"],
    height: Float[Array, " n"],
    nodes: Float[Array, "n u"],
    chord: Float[Array, " n"],
    *,
    radius: Float[Array, "n s"],
    excess: Float[Array, "n s"],
) -> JetEdges:
    """All effects of the edges of a jet whose speed varies along its radius in steps.

    With Phi = V phi, the local speed times the potential, Phi is continuous at an edge, and with it the lift per span
    rho V Gamma, not the circulation; what jumps is dPhi / dn / V^2. A lattice for the lift therefore has the matrix of
    the plain stream, -mu (V + u) . n on the right, and the edges' downwash there too, which is linear in the lift. An
    edge answers to a vortex that leaves the wing at y' (all lifts are sums of such steps) in two parts:

    * to the vortex that trails, `trailing_answer`;
    * to the bound vortices that end there, `bound_answer`.

    Strengths are k = (mu_in^2 - mu_out^2) / (mu_in^2 + mu_out^2) of every step, and steps answer to each other, see
    `_together`. The downwash of other surfaces, whose vortices run through the jet far ahead and behind, hardly
    changes across it: inside an edge it is k times more, outside k (R / y)^2.

    Source: Koning (see `reflection`) and Rethorst, Aerodynamics of Nonuniform Flows as Related to an Airfoil Extending
    through a Circular Jet, J. Aero. Sci. 25 (1958), for the problem. The forms here are integrals of first order;
    nothing measured entered.

    Arguments:
        place: of every strip along the wing from the axis of the jet, m.
        height: of the strip above the axis, across the wing, m.
        nodes: of what the surface sheds, along the wing from the strip, m.
        chord: of the wing there, over sqrt(1 - M^2), m.
        radius: of the steps there, from the innermost out, m; the excess is what is inside.
        excess: mu^2 - 1.

    Returns:
        JetEdges.

    Validity: against boundary elements (`tests/physics/round_jet.py`), outer radius over chord 0.35 to 2, mu 0.9 to
    1.5: total added lift within 3 %, anywhere within 5 % of its largest (camber 8 %); of incidence in a part of the jet
    or outside of it alone within 6 % of what the whole wing gains. At mu = 2 total 7 %, anywhere 10 %; beyond 3
    useless. Wing near the axis, one chord across the jet.
    """
    square = jnp.pad(1.0 + excess, ((0, 0), (0, 1)), constant_values=1.0)
    k = reflection(square[:, :-1], square[:, 1:])
    among, bound_among = _together(k, radius), _together(k, radius, BOUND_INTERPLAY)
    y, z, c, r = (a.reshape(a.shape[0], 1, -1) for a in (place, height, chord, radius))
    v = y + nodes[..., None]
    trailing, less_trailing = trailing_answer(y, v, z, radius=r, chord=c)
    bound, less_bound = bound_answer(y, v, z, radius=r, chord=c)
    away = r**2 * _larger((v**2 + z**2) / r**2)
    trailing_k = away * jnp.einsum("nij,nuj->nui", among, 1.0 / away)
    even_k = jnp.sum(among, axis=2)[:, None]
    bound_k = jnp.sum(bound_among, axis=2)[:, None]
    return JetEdges(
        -jnp.sum(trailing_k * trailing + bound_k * bound, axis=2),
        jnp.sum(trailing_k * less_trailing + bound_k * less_bound, axis=2),
        jnp.sum(even_k / _larger((y**2 + z**2) / r**2), axis=2)[:, 0],
    )


def trailing_answer(
    y: Float[Array, "..."],
    v: Float[Array, "..."],
    z: Float[Array, "..."],
    *,
    radius: Float[Array, "..."],
    chord: Float[Array, "..."],
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    """Downwash of an edge of strength one by what trails from the wing, and how much less for lift at mid-chord.

    In planes across the jet a vortex at y' is answered, at y inside, as if by one at y' if that is outside, else by its
    image at R^2 / y'; at y outside by (R / y)^2 of the answer at R^2 / y. At the wing, where the vortex begins, half of
    that is there and with the distance d behind the lift more, (1 + d / sqrt(d^2 + l^2)) / 2, averaged over the
    chord by a plate's pressure in either direction of flow. At a plane wall l is twice the distance, exactly; of a
    cylinder it is nearly the same at all d, and here

        l = p sqrt(1 + a / (p / R + b)),    p the distance of y from that vortex or image, both as seen from inside .

    Arguments:
        y: place along the wing from the axis, m.
        v: of the vortex, m.
        z: height of the wing above the axis, m.
        radius: of the edge, m.
        chord: m.

    Returns:
        Of a unit vortex, 1/m; both broadcast. With the second times the moment of the lift (`chord_shares`) the first
        becomes that of lift about the middle of the chord. Within 7 % of quadrature, 12 % where both are outside.
    """
    place, vortex = _larger((y**2 + z**2) / radius**2), _larger((v**2 + z**2) / radius**2)
    apart = 1.0 - (y * v + z**2) / (radius**2 * place * vortex)
    image = v / (4.0 * jnp.pi * radius**2 * place * vortex * apart)
    a, b = LEG_REACH
    p2 = apart**2 * place * vortex
    reach2 = (radius / chord) ** 2 * p2 * (1.0 + a / (jnp.sqrt(p2 + LEAST_REACH) + b))
    more = image * 0.5 / jnp.sqrt(reach2 + LEG_SHARE)
    return image + more, more * (0.5 - 1.0 / (6.0 + LEG_MIDDLE * reach2))


def bound_answer(
    y: Float[Array, "..."],
    v: Float[Array, "..."],
    z: Float[Array, "..."],
    *,
    radius: Float[Array, "..."],
    chord: Float[Array, "..."],
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    """Downwash of an edge of strength one by bound vortices that end at y', as `trailing_answer`.

    `edge_answer` times the share of the bound vortices around the axis that are on this side of y'. The answer to one
    of them alone is within a factor of two for radii of half a chord and more.
    """
    ahead = v - BOUND_CENTRE * y / _larger((y**2 + z**2) / radius**2)
    whole = edge_answer((y**2 + z**2) / radius**2, radius / chord) / (jnp.pi * chord)
    least, slope = BOUND_MIDDLE
    less = (1.0 - least) * (1.0 - 1.0 / (1.0 + slope * radius / chord))
    answer = whole * 0.5 * ahead / jnp.sqrt(ahead**2 + radius**2)
    return answer, answer * less


def _larger(square: Float[Array, "..."]) -> Float[Array, "..."]:
    """The square, or 1 where that is more, rounded off."""
    return 0.5 * (1.0 + square + jnp.sqrt((square - 1.0) ** 2 + EDGE_ROUNDING**2))


def _together(k: Float[Array, "n s"], r: Float[Array, "n s"], share: float = 1.0) -> Float[Array, "n s s"]:
    """Answers of edges among each other to the normal velocity n that each meets, of flow that is even across the jet.

    An edge adds its answer to the normal velocity inside and takes (R / y)^2 of it outside; with ``share`` of that,

        s_i = k_i (n_i + sum_(j > i) s_j - sum_(j < i) (R_j / R_i)^2 s_j) .

    Returns:
        s by n.
    """
    count = k.shape[1]
    i, one = jnp.arange(count), jnp.eye(count)
    within = -((r[:, None, :] / r[:, :, None]) ** 2)
    others = jnp.where(i[:, None] < i, 1.0, jnp.where(i[:, None] > i, within, 0.0))
    rows = jnp.concatenate([one - share * k[:, :, None] * others, one * k[:, None, :]], axis=2)
    # Gauss and Jordan without pivots, as every leading part is the system of fewer edges: LAPACK on batches within a
    # loop can stop XLA's threads for good.
    for p in range(count):
        pivot = rows[:, p] / rows[:, p, p, None]
        rows = (rows - rows[:, :, p, None] * pivot[:, None]).at[:, p].set(pivot)
    return rows[:, :, count:]
