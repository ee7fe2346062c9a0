"""What the edges of a round jet do to a wing that passes through it."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike

ANSWER_WIDTH = (0.110, 0.162)
ANSWER_POWERS = (0.451, 0.542)
ANSWER_SIZE = (0.556, 3.385, 0.0843, 10.0, 0.185)
"""Fits to the integral of `edge_answer`: 7 % of its value on the axis, 1 % of its integral along the span."""
MIDDLE = 0.6
"""Answer to lift about the middle of the chord, as of camber, over that to lift about the quarter point: 0.64 to 0.53
for R / c from 0.35 to 1 by the same integral, a half for high jets."""
CENTRE = 0.69
"""Share of the relief that is not there near the axis; with `_bubble` within 3 % of boundary elements in full jets."""
BUBBLE_ROUNDING = 0.1
"""Rounds `_bubble` off at the edge of the jet (choice)."""
LEAST_EXCESS = 1e-18
"""Keeps the weighted mean of an excess of pressure that is zero everywhere defined."""


class JetEdges(NamedTuple):
    """What the edges of a jet do to a wing, see `jet_edges`."""

    bound: Float[Array, " n"]  # of the normal velocity that the bound vortices make in the plain stream, taken back
    trailing: Float[Array, " n"]  # the same of the downwash of all that trails
    images: Float[Array, "n t"]  # velocity taken back by the lift that ends at every node of the strips, 1/m
    relief: Float[Array, " n"]  # of the lift that the jet adds, not there


def reflection(velocity_ratio: Float[Array, "..."] | ScalarLike) -> Float[Array, "..."]:
    """Strength of the image in the edge of a jet, k = (mu^2 - 1) / (mu^2 + 1), mu = V_jet / V.

    Pressure and flow angle are the same on both sides of the edge; 0 without a jet, 1 for a jet in still air.

    Source: Glauert, The Lift and Drag of a Wing Spanning a Free Jet, ARC R&M 1603 (1934), for still air; Koning,
    in Durand, Aerodynamic Theory IV (1935), division M, for any ratio.
    """
    square = jnp.asarray(velocity_ratio) ** 2
    return (square - 1.0) / (square + 1.0)


def edge_answer(eta: Float[Array, "..."], radius: Float[Array, "..."] | ScalarLike) -> Float[Array, "..."]:
    """Downwash of a round edge of strength one, over the normal velocity that a wing of infinite span meets.

    The wing's flow is plane; the edge answers with sources -2 k times the normal velocity of it, whose upwash, weighted
    along the chord by the plate's pressure in either direction of flow, is k times this. Integrals by quadrature
    (`tests/physics/test_finite_jet.py`), here as

        S = A(rho) [(1 - eta^2)^2 + b eta^2]^-p (1 + q eta^2)^(2 p - 3/2),   b = b_1 / (rho^2 + b_2) ,
        A = a_1 asinh(a_2 rho) / (rho sqrt(rho^2 + a_3) (1 + a_4 rho^a_5)) .

    Arguments:
        eta: distance from the axis over the radius of the edge.
        radius: rho, of the edge over the chord, 0.15 to 6; broadcasts.

    Returns:
        S, positive.
    """
    (b_1, b_2), (p, q), (a_1, a_2, a_3, a_4, a_5) = ANSWER_WIDTH, ANSWER_POWERS, ANSWER_SIZE
    rho2, eta2 = jnp.asarray(radius) ** 2, eta**2
    shape = ((1.0 - eta2) ** 2 + b_1 / (rho2 + b_2) * eta2) ** -p * (1.0 + q * eta2) ** (2.0 * p - 1.5)
    size = a_1 * jnp.arcsinh(a_2 * radius) / (radius * jnp.sqrt(rho2 + a_3) * (1.0 + a_4 * radius**a_5))
    return size * shape


def chord_shares(
    xi: Float[Array, " nc1"], front: Float[Array, " nc"], rear: Float[Array, " nc"]
) -> Float[Array, "2 nc"]:
    """Weights of the panels of a strip: of normal velocities in the circulation, of rings in the answer of edges.

    In plane flow the first give circulation over pi and the chord. The second give what edges answer to, of a plate
    its circulation; lift about the middle of the chord, as of camber, is answered `MIDDLE` times as much.

    Arguments:
        xi: chord fractions of the panels' edges.
        front: where in its panel the vortex lies, 0 ahead to 1 behind.
        rear: where in its panel the condition stands.
    """
    bound, met = (xi[:-1] + part * jnp.diff(xi) for part in (front, rear))
    plane = 1.0 / (2.0 * jnp.pi * (met[:, None] - bound))
    weight = 1.0 - (1.0 - MIDDLE) * (bound - 0.25) / 0.25
    return jnp.stack([jnp.linalg.solve(plane.T, jnp.ones_like(met)) / jnp.pi, weight - jnp.append(weight[1:], 0.0)])


def trailing_images(
    place: Float[Array, " n"], nodes: Float[Array, "n t"], radius: Float[Array, " n"]
) -> Float[Array, "n t"]:
    """Downwash along a wing by the image of a vortex in an edge less that by the vortex itself.

    Times 2 pi, for unit circulation: 1/m. In planes across the jet the conditions at the edge are those of a
    dielectric cylinder. Its answer to a vortex at y' is at y inside k times the flow of one at y', or at R^2 / y' if y'
    is inside; at y outside it is (R / y)^2 times the answer at R^2 / y.

    Arguments:
        place: of the strips along the wing from the axis of the jet, m.
        nodes: of the trailing vortices from each strip on, m.
        radius: of the edge at the strips, m.
    """
    y, radius = place[:, None], radius[:, None]
    vortex = y + nodes
    inside, inverse = y / _beyond(y / radius), vortex / radius**2 / _beyond(vortex / radius)
    return 1.0 / nodes - inverse / (1.0 - inside * inverse)


def _beyond(eta: Float[Array, "..."]) -> Float[Array, "..."]:
    """1 inside the jet, eta^2 outside, rounded off at the edge."""
    return (1.0 + eta**16) ** 0.125


def jet_edges(
    distance: Float[Array, " n"],
    chord: Float[Array, " n"],
    *,
    radius: Float[Array, "n nr1"],
    excess: Float[Array, "n nr"],
    share: Float[Array, " nr"],
    images: Float[Array, "n t"],
) -> JetEdges:
    """All effects of the edges of a jet whose speed varies along its radius in steps.

    With Phi = V phi, the local speed times the potential, Phi is continuous at an edge, and with it the lift per span
    rho V Gamma, not the circulation; what jumps is dPhi / dn / V^2. A lattice for the lift therefore has the matrix of
    the plain stream, -mu (V + u) . n on the right, and the edges' answer:

    * to the bound vortices of the wing in the plain stream, `edge_answer` of every step, d(mu^2) mu_1^2 / (mu_1^2 + 1)
      strong, which takes from the right-hand side, by the `chord_shares` of the strip;
    * to its trailing vortices, whose downwash w hardly changes across the jet, as to a plane flow across a cylinder:
      inside w grows by k = (mu^2 - 1) / (mu^2 + 1), outside by k (R / y)^2, d(mu^2) / (mu_1^2 + 1) of every step; of
      vortices inside the jet their images count instead, see `trailing_images`;
    * to the lift that the jet adds, whose trailing vortices stand at the edges: outside 1 - K of it remains, near the
      axis 1 - 0.31 K, alike for loads that are even and odd about the axis, with

        K = k + k (1 - k) (1 - mean / peak),    k of the peak .

    Source: Koning (see `reflection`) and Rethorst, Aerodynamics of Nonuniform Flows as Related to an Airfoil Extending
    through a Circular Jet, J. Aero. Sci. 25 (1958), for the problem; the forms here are fitted to boundary elements
    (`tests/physics/round_jet.py`), to nothing measured.

    Arguments:
        distance: of every place from the centre line, m.
        chord: of the wing there, m.
        radius: of the steps there, from the innermost out, m.
        excess: mu^2 - 1 between the steps; none inside the first and outside the last.
        share: of the disk's area between the steps.
        images: see `trailing_images`.

    Returns:
        JetEdges.

    Validity: outer radius over chord 0.35 to 2, mu 1 to 1.5: total added lift within 3 % in full jets, 5 % in such as
    propellers blow and 8 % in hollow ones, within 15 % of its largest anywhere; within 5 % with aspect ratios 6 and
    12, and with camber; one chord across the jet, wing near the axis.
    """
    square = jnp.sum(share * excess**2, axis=1)
    peak = jnp.sum(share * excess**3, axis=1) / (square + LEAST_EXCESS)
    k = peak / (peak + 2.0)
    relief = k + (1.0 - k) * (peak - excess @ share) / (peak + 2.0)
    steps = -jnp.diff(excess, axis=1, prepend=0.0, append=0.0)
    each = edge_answer(distance[:, None] / radius, radius / chord[:, None])
    bound = (1.0 + peak) / (2.0 + peak) * jnp.sum(steps * each, axis=1)
    trailing = jnp.sum(steps / _beyond(distance[:, None] / radius), axis=1) / (2.0 + peak)
    relieved = relief * (1.0 - CENTRE * _bubble(distance / radius[:, -1]))
    half_lines = images / (4.0 * jnp.pi)  # what trails begins at the wing: half of the plane flow
    return JetEdges(bound, trailing, trailing[:, None] * half_lines, relieved)


def _bubble(eta: Float[Array, " n"]) -> Float[Array, " n"]:
    """(1 - eta^4)^(3/4) inside the jet, nothing outside, rounded off at the edge."""
    inside = 1.0 - eta**4
    return (0.5 * (inside + jnp.sqrt(inside**2 + BUBBLE_ROUNDING**2))) ** 0.75
