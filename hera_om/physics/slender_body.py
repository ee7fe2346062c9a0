"""Lift, side force and moments of a fuselage by slender-body theory, and its interference with the lattice.

The fuselage has its nose at the origin, its axis along x, and elliptic sections (see `fuselage.Fuselage`).
Division of labour with a lattice that runs through the fuselage, so that nothing counts twice:

- the body carries the lift of its nose, to the leading edge of the wing root, and of its tail, behind the
  trailing edge; between the two it carries nothing in pitch;
- the lattice inside the body stands for the lift that wing and body carry over to each other. There it sees
  no onset flow (`BodyField.shield`), because a closed surface in a stream has none inside; outside it sees
  the upwash of the body. In the limit of a slender wing this is the theory's lift to the second order of
  body radius over semi-span; without the shield it would be 13 % too high at a tenth.

Crossflow is ``(w, v)``: the components of the stream along z (up) and y (starboard) over flight speed.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.fuselage import Fuselage, apparent_mass_factors, fineness_ratio
from hera_om.physics.section_polar import smoothstep

ScalarLike = Float[Array, ""] | float | int

SEPARATION_OFFSET, SEPARATION_SLOPE = 0.378, 0.527
"""Station where potential crossflow ends, x0 / l = 0.378 + 0.527 x1 / l, x1 where the section shrinks fastest:
USAF DATCOM (1978), section 4.2.1.1, figure 4.2.1.1-20b."""
BLEND = 0.15
"""Half width, in body radii, over which the flow changes from inside to outside of the skin (choice)."""
UPWASH = 1.0
"""Share of the body's upwash outside; 0 switches it off."""
SHIELD = 1.0
"""Share of the onset that the body keeps from the lattice inside; 0 switches it off."""
FINITE_LENGTH = 1.0
"""1: Munk's k2 - k1 of the body's fineness; 0: an infinitely slender body."""
MEAN_POINTS = 8
"""Points of the mean over a strip's width."""
GAUSS = 4
"""Points of the quadrature a piece: exact for the body's own areas with a linear crossflow."""
_NODES, _WEIGHTS = (v / 2.0 for v in np.polynomial.legendre.leggauss(GAUSS))


class Crossflow(NamedTuple):
    """Motion of the body: angles in rad, rates over flight speed in rad/m, about the station ``x_ref``."""

    alpha: ScalarLike
    beta: ScalarLike  # wind from starboard
    pitch: ScalarLike  # q / V, nose up
    yaw: ScalarLike  # r / V, nose to starboard
    x_ref: ScalarLike  # m


class BodyLoads(NamedTuple):
    """Force (m^2) and moment (m^3) over dynamic pressure, geometry axes, moment about ``Crossflow.x_ref``."""

    force: Float[Array, " 3"]
    moment: Float[Array, " 3"]  # y: nose up positive; z: nose to port positive (Cn is its negative)


class BodyField(NamedTuple):
    """What p points of a lattice see of the body. Only for the boundary condition, not for forces."""

    shield: Float[Array, " p"]  # factor on every other onset: 1 outside, 0 inside
    by_w: Float[Array, "p 3"]  # velocity per unit crossflow along z at the body's station
    by_v: Float[Array, "p 3"]  # the same along y


def crossflow(flow: Crossflow, x: Float[Array, "..."]) -> tuple[Array, Array]:
    """Crossflow (w, v) at stations: ``w = alpha + q (x - x_ref) / V``, ``v = -beta + r (x - x_ref) / V``.

    Source: kinematics of a rigid body in the body's axes, small angles. p adds nothing on the axis.

    Args:
        flow: motion of the body.
        x: stations, m, any shape.

    Returns:
        w, v over flight speed, of the shape of ``x``.
    """
    arm = x - flow.x_ref
    return flow.alpha + flow.pitch * arm, -flow.beta + flow.yaw * arm


def area_share(body: Fuselage, x: Float[Array, "..."]) -> Float[Array, "..."]:
    """Area of the section over the largest: paraboloid nose, cylinder, conical tail; zero off the body."""
    nose = x / body.nose_length
    tail = jnp.maximum((body.length - x) / body.tail_length, 0.0) ** 2
    return jnp.clip(jnp.minimum(nose, tail), 0.0, 1.0)


def crossflow_areas(body: Fuselage, x: Float[Array, "..."]) -> tuple[Array, Array]:
    """Apparent areas in flow along z, ``pi a^2``, and along y, ``pi b^2``; a, b are half width and height.

    Source: apparent mass of an ellipse, Lamb, Hydrodynamics (6th edition), article 71.
    """
    share = jnp.pi / 4.0 * area_share(body, x)
    return share * body.width**2, share * body.height**2


def separation_station(body: Fuselage) -> Float[Array, ""]:
    """Station behind which separation leaves no potential crossflow force (see `SEPARATION_OFFSET`), m."""
    return jnp.asarray(SEPARATION_OFFSET * body.length + SEPARATION_SLOPE * (body.length - body.tail_length))


def finite_length_factor(body: Fuselage) -> Float[Array, ""]:
    """Munk's k2 - k1 (NACA Report 184, 1924), 1 for an infinitely slender body."""
    k1, k2 = apparent_mass_factors(fineness_ratio(body))
    return 1.0 + FINITE_LENGTH * (k2 - k1 - 1.0)


def segment_loads(
    area: Callable[[Array], Array], flow: Callable[[Array], Array], breaks: Array, *, x_ref: ScalarLike
) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Force and moment of a piece of a slender body in a crossflow that changes along it.

    ``dN/dx = 2 q d(A w)/dx`` with the apparent area A, hence ``N = 2 q [A w]`` between the ends and
    ``M = 2 q (int A w dx - [(x - x_ref) A w])``. With A w zero at both ends M is Multhopp's sum,
    ``q / 36.5 sum(w_f^2 dbeta/dalpha dx)`` per degree, since pi / 2 in radians is 1 / 36.5 in degrees.

    Source: Munk, NACA Report 184 (1924); Ashley & Landahl, Aerodynamics of Wings and Bodies, section 6-6;
    Multhopp, NACA TM 1036 (1942); the rates: Lighthill, J. Fluid Mech. 9 (1960), steady turning.

    Args:
        area: apparent area (m^2) by station.
        flow: crossflow over flight speed by station.
        breaks: ends of the smooth pieces, m [k + 1].
        x_ref: moment reference, m.

    Returns:
        Force along the crossflow over dynamic pressure (m^2), moment (m^3, positive when the force ahead of
        ``x_ref`` is).

    Valid for small crossflow and sections that change slowly; no viscous crossflow (Allen), which is small
    below about 8 degrees.
    """
    length = breaks[1:] - breaks[:-1]
    nodes = (breaks[1:] + breaks[:-1])[:, None] / 2.0 + length[:, None] * jnp.asarray(_NODES)
    integral = jnp.sum(length[:, None] * jnp.asarray(_WEIGHTS) * area(nodes) * flow(nodes))
    ends = jnp.stack([breaks[0], breaks[-1]])
    load = 2.0 * area(ends) * flow(ends) * jnp.asarray([-1.0, 1.0])
    return jnp.sum(load), 2.0 * integral - jnp.sum((ends - x_ref) * load)


def load_distribution(body: Fuselage, x: Float[Array, " n"], *, flow: Crossflow) -> Float[Array, "2 n"]:
    """Force per length over dynamic pressure along z and y of the bare body, ``2 k d(A w)/dx``, m.

    Source, range: as `segment_loads`; for a structure of the fuselage or a picture. Zero behind
    `separation_station`.

    Args:
        body: dimensions, m.
        x: stations, m.
        flow: motion of the body.

    Returns:
        Along z and along y, m.
    """

    def transport(at):
        areas, (w, v) = crossflow_areas(body, at), crossflow(flow, at)
        return jnp.stack([areas[0] * w, areas[1] * v])

    slope = jax.jvp(transport, (x,), (jnp.ones_like(x),))[1]
    return 2.0 * finite_length_factor(body) * jnp.where(x < separation_station(body), slope, 0.0)


def bare_body_loads(body: Fuselage, *, flow: Crossflow) -> BodyLoads:
    """Loads of the body alone, from the nose to `separation_station`; see `segment_loads`.

    Args:
        body: dimensions, m.
        flow: motion of the body.

    Returns:
        BodyLoads.
    """
    breaks = _breaks(body, 0.0, separation_station(body))
    return _resultant(body, _bare(body, flow, breaks, 0), _bare(body, flow, breaks, 1))


def axis_points(body: Fuselage, *, x_le: ScalarLike, x_tail: ScalarLike) -> Float[Array, "m 3"]:
    """Points of the axis where `body_loads` wants the lattice's velocity: ahead of the wing, then the tail.

    Args:
        body: dimensions, m.
        x_le: leading edge of the wing root, m.
        x_tail: station of the horizontal tail, or the end of the body, m.

    Returns:
        Points [m, 3], m; the last one is at the tail.
    """
    breaks = _fore(body, x_le)
    nodes = (breaks[1:] + breaks[:-1])[:, None] / 2.0 + jnp.diff(breaks)[:, None] * jnp.asarray(_NODES)
    x = jnp.append(nodes.ravel(), x_tail)
    return jnp.stack([x, jnp.zeros_like(x), jnp.zeros_like(x)], axis=-1)


def body_loads(
    body: Fuselage,
    *,
    flow: Crossflow,
    root: tuple[ScalarLike, ScalarLike],
    x_tail: ScalarLike,
    induced: Float[Array, " m"],
) -> BodyLoads:
    """Loads of the body in the flow of a wing: Multhopp's method with the velocities of the lattice.

    Pitch: ahead of the wing root ``w + w_induced``, of which the induced part gives a couple and no force
    (its reaction is on the wing); along the root nothing, where the lattice carries the load; behind it the
    crossflow rises in proportion from zero at the trailing edge to ``w + w_induced`` at the tail. Sideslip and
    yaw: the bare body.

    Source: Multhopp, NACA TM 1036 (1942); Etkin & Reid, Dynamics of Flight 3e, appendix B.10; Nelson, Flight
    Stability and Automatic Control 2e, section 2.3, eqs. 2.29-2.31. There a chart gives the upwash and the
    local incidence behind the wing is linear as well.

    Args:
        body: dimensions, m.
        flow: motion of the body.
        root: leading and trailing edge of the wing root, m.
        x_tail: station of the tail, m, behind the root.
        induced: z velocities of the lattice over flight speed at `axis_points` [m].

    Returns:
        BodyLoads.

    Valid as `segment_loads`; the wing root must lie on the body and end ahead of the tail.
    """
    x_le, x_te = root
    fore = _fore(body, x_le)

    x = axis_points(body, x_le=x_le, x_tail=x_tail)[:-1, 0]
    weights = (jnp.diff(fore)[:, None] * jnp.asarray(_WEIGHTS)).ravel()
    couple = 2.0 * jnp.sum(weights * crossflow_areas(body, x)[0] * induced[:-1])

    def behind(at):
        return (crossflow(flow, at)[0] + induced[-1]) * (at - x_te) / (x_tail - x_te)

    base = separation_station(body)
    own = _bare(body, flow, fore, 0)
    breaks = _breaks(body, x_te, jnp.maximum(base, x_te))
    aft = segment_loads(lambda at: crossflow_areas(body, at)[0], behind, breaks, x_ref=flow.x_ref)
    lift = own[0] + aft[0], own[1] + aft[1] + couple
    return _resultant(body, lift, _bare(body, flow, _breaks(body, 0.0, base), 1))


def body_field(body: Fuselage, points: Float[Array, "p 3"]) -> BodyField:
    """Shield and upwash of the body at points of a lattice, smooth across its skin.

    Outside the two-dimensional doublet of a cylinder in crossflow, in flow along z
    ``w = mu (y^2 - z^2) / r^4, v = -2 mu y z / r^4``: at the side of a circular body the incidence is
    ``alpha (1 + a^2 / y^2)``. ``mu = a (a + b) / 2`` in flow along z and ``b (a + b) / 2`` along y: exact far
    from an ellipse, everywhere for a circle. Inside the skin's vorticity cancels the stream: shield 0.

    The boundary condition of a panel becomes ``shield V.n + (w by_w + v by_v).n + induced = 0`` with all of
    V.n (camber, twist, rates, slipstream). Leave the field out of Kutta and Joukowski's force: its reaction
    is on the body, and only so is the near-field drag that of the Trefftz plane.

    Source: Nielsen, Missile Aerodynamics, sections 2-5 and 5-3; Lamb, Hydrodynamics (6th edition), articles
    68 and 71; the lattice inside and the lift of the combination: NACA Report 1307 (1957), and the page on
    theory.

    Args:
        body: dimensions, m.
        points: collocation points, m; the wing and tail may lie anywhere.

    Returns:
        BodyField.

    Valid for cross-sections near a circle (at the side of an ellipse of axes 1.1 to 1 the incidence is 7 % too
    small) and surfaces away from nose and tail tip; the wake of wing and body on the body's crossflow is left
    out.
    """
    x, y, z = points[:, 0], points[:, 1], points[:, 2]
    share = area_share(body, x)
    there = share > 0.0
    safe = jnp.where(there, share, 1.0)
    a, b = (jnp.sqrt(safe) * d / 2.0 for d in (body.width, body.height))
    outside = jnp.where(there, _outside(y / a, z / b), 1.0)
    r2 = y**2 + z**2
    far = jnp.where(there & (r2 < (0.5 * jnp.minimum(a, b)) ** 2), a * b, jnp.where(r2 > 0.0, r2, 1.0))
    strength = jnp.where(there, UPWASH * outside * (a + b) / 2.0, 0.0) / far**2
    along, across, none = (y**2 - z**2) * strength, -2.0 * y * z * strength, jnp.zeros_like(x)
    by_w = a[:, None] * jnp.stack([none, across, along], axis=-1)
    by_v = b[:, None] * jnp.stack([none, -along, across], axis=-1)
    return BodyField(1.0 - SHIELD * (1.0 - outside), by_w, by_v)


def mean_body_field(body: Fuselage, middles: Float[Array, "p 3"], widths: Float[Array, "p 3"]) -> BodyField:
    """`body_field` averaged over the width of strips, so that it matters little where a strip meets the skin.

    Args:
        body: dimensions, m.
        middles: middles of the strips' lines through the collocation points, m (``Lattice.across[0]``).
        widths: their widths as vectors, m (``Lattice.across[1]``).

    Returns:
        BodyField of the collocation points.
    """
    points = middles + (jnp.arange(MEAN_POINTS)[:, None, None] + 0.5) / MEAN_POINTS * widths - widths / 2.0
    fields = body_field(body, points.reshape(-1, 3))
    return BodyField(*(jnp.mean(v.reshape(MEAN_POINTS, -1, *v.shape[1:]), axis=0) for v in fields))


def _outside(y, z) -> Array:
    """Smooth step from 0 inside the unit circle to 1 outside; of the squared radius, to be smooth at 0."""
    inner, outer = (1.0 - BLEND) ** 2, (1.0 + BLEND) ** 2
    return smoothstep((y**2 + z**2 - inner) / (outer - inner))


def _breaks(body: Fuselage, start, end) -> Array:
    """Ends of nose, cylinder and tail between two stations."""
    joints = jnp.stack([jnp.asarray(body.nose_length, float), jnp.asarray(body.length - body.tail_length, float)])
    ends = [jnp.asarray(start, float), jnp.asarray(end, float)]
    return jnp.stack([ends[0], *jnp.clip(joints, ends[0], ends[1]), ends[1]])


def _fore(body: Fuselage, x_le) -> Array:
    """Ends of nose and cylinder ahead of the wing, whose root begins on the cylinder."""
    return _breaks(body, 0.0, x_le)[jnp.asarray([0, 1, 3])]


def _bare(body: Fuselage, flow: Crossflow, breaks, plane: int) -> tuple[Array, Array]:
    """Force and moment of the body's own crossflow along z (plane 0) or y (1)."""
    return segment_loads(
        lambda x: crossflow_areas(body, x)[plane], lambda x: crossflow(flow, x)[plane], breaks, x_ref=flow.x_ref
    )


def _resultant(body: Fuselage, lift, side) -> BodyLoads:
    """Both planes together; a force to starboard ahead of the reference turns the nose to starboard, -z."""
    k, zero = finite_length_factor(body), jnp.zeros(())
    return BodyLoads(k * jnp.stack([zero, side[0], lift[0]]), k * jnp.stack([zero, lift[1], -side[1]]))
