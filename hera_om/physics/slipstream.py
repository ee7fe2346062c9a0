"""The velocity that a rotor adds to the flow: its slipstream, and what its disk draws in around it."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.custom_derivatives import SymbolicZero
from jax.flatten_util import ravel_pytree
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike, smoothstep, soft_clip
from hera_om.physics.vortex_tube import disk_amplitudes, disk_velocity

DISK_CORE = 0.1
"""The disk is a layer of this many radii ahead of and behind its plane, over which swirl and vorticity rise from
nothing to all (choice); the field is exact outside it."""
ENTRAINMENT = 1.0
"""Share of the flow that the disk draws in, with which the axial velocity develops along the tube; zero leaves the
developed tube alone."""
SKEW = 1.0
"""Share of the tube's turn towards the free stream."""
CROSSFLOW = 1.0
"""Share of the flow across a skewed tube."""
TURN = 1.0
"""Share of the turn of the tube by the rotor's own force in the plane of its disk."""
HUB_BLEND = 0.25
"""The profiles fade to zero between 1 + and 1 - this fraction of the radius of the innermost element's
inner edge."""
LOADING_CENTRE, LOADING_HALF_RANGE = 0.25, 0.95
"""Limits of v / (V + v) in the contraction: exact from -0.51 (windmilling at a = 0.34) to 1.01 (static), held
within -0.7 and 1.2, so that the tube of a braking rotor widens to a finite radius."""
LEAST_HUB = 1e-3
"""Least radius of that edge over the rotor's, for blades that begin on the axis."""
AXIS_CORE = 1e-6
"""Radius over rotor radius under which the distance from the axis is rounded off; the swirl is zero there."""
NACELLE_LAYER = 0.2
"""Share of a nacelle's area over whose like outside of it the drift past it is rounded to nothing (choice)."""


def _spline_curvatures(r: Float[Array, " nr"], values: Float[Array, "nr k"]) -> Float[Array, "nr k"]:
    """Second derivatives of the natural cubic spline through ``values`` at ``r``."""
    n = r.shape[0]
    h = jnp.diff(r)
    rise = jnp.diff(values, axis=0) / h[:, None]
    inner = jnp.arange(1, n - 1)
    matrix = jnp.eye(n).at[inner, inner].set((h[:-1] + h[1:]) / 3.0)
    matrix = matrix.at[inner, inner - 1].set(h[:-1] / 6.0).at[inner, inner + 1].set(h[1:] / 6.0)
    right = jnp.pad(jnp.diff(rise, axis=0), ((1, 1), (0, 0)))
    return jnp.linalg.solve(matrix, right)


def _profile(x: Float[Array, " n"], r: Float[Array, " nr"], values: Float[Array, "nr k"]) -> Float[Array, "n k"]:
    """Natural cubic spline through ``values`` at ``r``, continued linearly, hence twice differentiable
    everywhere.
    """
    curvature = _spline_curvatures(r, values)
    i = jnp.clip(jnp.searchsorted(r, x) - 1, 0, r.shape[0] - 2)
    h = (r[i + 1] - r[i])[:, None]
    b = (x[:, None] - r[i][:, None]) / h
    bend = _bend(b) * curvature[i + 1] + _bend(1.0 - b) * curvature[i]
    return (1.0 - b) * values[i] + b * values[i + 1] + h**2 / 6.0 * bend


def _bend(t: Float[Array, "n k"]) -> Float[Array, "n k"]:
    """t^3 - t inside the interval, its tangents outside."""
    inside = jnp.clip(t, 0.0, 1.0)
    return inside**3 - inside + jnp.where(t < 0.0, -t, jnp.where(t > 1.0, 2.0 * (t - 1.0), 0.0))


def disk_mean(r: Float[Array, " nr"], values: Float[Array, " nr"], radius: ScalarLike) -> Float[Array, ""]:
    """Mean over the disk of a profile given at the mid-points of equal elements, nothing inside the hub."""
    return jnp.sum(values * r) * 2.0 * (r[1] - r[0]) / radius**2


def hub_edge(r: Float[Array, " nr"], radius: ScalarLike) -> Float[Array, ""]:
    """Inner edge of the innermost of equal elements with these mid-points."""
    return jnp.maximum(r[0] - 0.5 * (r[1] - r[0]), LEAST_HUB * radius)


def axial_development(x: Float[Array, "..."], radius: ScalarLike) -> Float[Array, "..."]:
    """Growth of the axial velocity along the axis: kappa = x / sqrt(x^2 + R^2), -1 far ahead to 1 far
    behind.
    """
    return x / jnp.sqrt(x**2 + radius**2)


def loading(v_mean: ScalarLike, speed: ScalarLike) -> Float[Array, ""]:
    """v / (V + v), limited softly for rotors that brake beyond a = 0.34."""
    through = speed + v_mean
    positive = jnp.abs(through) > 1e-9
    ratio = jnp.where(positive, v_mean / jnp.where(positive, through, 1.0), 0.0)
    return LOADING_CENTRE + LOADING_HALF_RANGE * soft_clip((ratio - LOADING_CENTRE) / LOADING_HALF_RANGE, 0.8)


def contraction(kappa: Float[Array, "..."], disk_loading: ScalarLike) -> Float[Array, "..."]:
    """Radius of the stream tube over that at the disk, by continuity of the mean velocity V + v (1 + kappa).

    ``(R_s / R)^2 = (V + v) / (V + v (1 + kappa)) = 1 / (1 + loading kappa)``, see `loading`.
    """
    return 1.0 / jnp.sqrt(1.0 + disk_loading * kappa)


def past_nacelle(r2: Float[Array, " n"], radius: ScalarLike, nacelle: ScalarLike) -> Float[Array, " n"]:
    """Share of the tube's drift across the shaft that a nacelle leaves, 1 - (a / r)^2 outside its radius a.

    Air that drifts across a tube around a cylinder flows around that: to first order its distance from the shaft
    changes by (1 - a^2 / r^2) of the drift's part in the direction of the radius. At the nacelle it does not change.

    Source: the cylinder in crossflow, any text on potential theory.

    Arguments:
        r2: square of the distance from the shaft, m^2.
        radius: of the rotor, m.
        nacelle: radius of the nacelle, m; 0 leaves all of the drift.
    """
    square = jnp.square(nacelle)
    past = square / jnp.maximum(r2 - square, (AXIS_CORE * radius) ** 2)
    return 1.0 / ((1.0 + past) * (1.0 + (NACELLE_LAYER * past) ** 2))


def beside_nacelle(kappa: Float[Array, "..."], nacelle: ScalarLike, hub: ScalarLike) -> Float[Array, "..."]:
    """What a nacelle wider than the hub adds to the square of a radius: all far behind, half at the disk (choice)."""
    return jnp.maximum(jnp.square(nacelle) - jnp.square(hub), 0.0) * (1.0 + kappa) / 2.0


def disk_layer(x: Float[Array, " n"], radius: ScalarLike) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Sign of x and distance from the disk, both rounded within ``DISK_CORE`` radii; there exact.

    The sign is a quintic step, the distance its integral, 5/16 of the core at the disk.
    """
    core = DISK_CORE * radius
    t = jnp.clip(0.5 * (x / core + 1.0), 0.0, 1.0)
    rounded = core * (1.0 - 2.0 * t + t**4 * (10.0 + t * (4.0 * t - 12.0)))
    return 2.0 * smoothstep(t) - 1.0, jnp.where(jnp.abs(x) < core, rounded, jnp.abs(x))


def skew(cross_stream: Float[Array, "*n"] | ScalarLike, v_mean: ScalarLike, speed: ScalarLike) -> Float[Array, "*n"]:
    """Slope of the tube's centre line from the shaft towards the stream: tan(chi) = V_cross / (V + v).

    Source: Coleman, Feingold and Stempin, NACA ARR L5E10 (1945); Glauert's momentum theory of the inclined disk.
    """
    through = speed + v_mean
    positive = jnp.abs(through) > 1e-9
    return SKEW * jnp.where(positive, cross_stream / jnp.where(positive, through, 1.0), 0.0)


def turn(
    cross_force: Float[Array, "3"] | ScalarLike, v_mean: ScalarLike, speed: ScalarLike
) -> tuple[Float[Array, "3"] | Float[Array, ""], Float[Array, "3"] | Float[Array, ""]]:
    """Velocity across the tube far behind a rotor that pushes across its shaft: of the tube, and of its surroundings.

    A long tube of speed V_j at the angle delta to a stream of speed V carries rho A_s V_j^2 delta across the stream;
    the stream flows around it as around a cylinder that moves by V delta, whose apparent mass is as much air as the
    cylinder holds. The force is N = rho A_s (V_j^2 + V^2) delta, and A_s V_j = A (V + v), so that

        V_j delta = N / (rho A (V + v)) V_j^2 / (V_j^2 + V^2),    V delta = V / V_j times that, V_j = V + 2 v .

    The thrust's part across the stream turns the tube by the same law, see `tilt`.

    Source: Ribner, NACA Report 820 (1945), for the shares of tube and surroundings.

    Arguments:
        cross_force: force on the air across the shaft over rho A, m^2/s^2.
        v_mean: mean induced axial velocity at the disk, m/s.
        speed: axial speed of the stream, m/s.
    """
    through, jet = speed + v_mean, speed + 2.0 * v_mean
    positive = jnp.abs(through) > 1e-9
    squares = (jet**2 + jnp.square(speed)) * through
    rate = TURN * jnp.where(positive, cross_force * jet / jnp.where(positive, squares, 1.0), 0.0)
    return rate * jet, rate * speed


def tilt(
    cross_stream: Float[Array, "3"] | ScalarLike, v_mean: ScalarLike, speed: ScalarLike
) -> tuple[Float[Array, "3"] | Float[Array, ""], Float[Array, "3"] | Float[Array, ""]]:
    """Velocity across the shaft far behind a disk in a stream with a part w across it: in the tube, and beside it.

    The thrust has the part T w / V across the stream, which turns the tube from the stream towards the shaft by the
    angle delta of `turn`. Across the shaft the air of the tube then has V_j (w / V - delta), and the stream flows
    around a cylinder that it meets with V delta. What that is more than w in the tube, and what flows around it, is

        V q   and   V_j q,    q = 2 v w / (V_j^2 + V^2) .

    Even rings parallel to the disk (Coleman) have v w / (V + v) for both, the same to first order in v / V.

    Source: Ribner, as in `turn`, for the shares; momentum for the rest.

    Arguments:
        cross_stream: velocity of the undisturbed stream across the shaft, m/s.
        v_mean: mean induced axial velocity at the disk, m/s.
        speed: axial speed of the stream, m/s.
    """
    jet = speed + 2.0 * v_mean
    squares = jet**2 + jnp.square(speed)
    positive = squares > 1e-9
    rate = CROSSFLOW * jnp.where(positive, 2.0 * v_mean * cross_stream / jnp.where(positive, squares, 1.0), 0.0)
    return rate * speed, rate * jet


def crossflow(s2: Float[Array, " n"]) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Velocity across a long skewed tube over that which is added inside, the same around it: a doublet's outside.

    The rings stay parallel to the disk and blow along the shaft, 2 (axis - slope) seen from the tube; its walls
    hold back half of the part across. With s = r / R and the unit vector e away from the centre line, the field of a
    uniform tube is slope for s < 1 and (slope - 2 (slope . e) e) / s^2 for s > 1; here its wall is rounded,

        u = (1 + s^8)^(-1/4) slope - 2 s^8 (1 + s^8)^(-5/4) (slope . e) e .

    Source: the transversely magnetised cylinder, any text on potential theory; the momentum across the stream is so
    shared in halves between tube and surroundings, as in Ribner, NACA Report 820 (1945).

    Arguments:
        s2: square of the distance from the centre line over R.

    Returns:
        Factors of slope, and of (slope . s e) s e.
    """
    s4 = s2**2
    wall = 1.0 / (1.0 + s4**2)
    fall = jnp.sqrt(jnp.sqrt(wall))
    return fall, -2.0 * s2 * s4 * wall * fall


def slipstream_velocity(
    points: Float[Array, "n 3"],
    *,
    hub: Float[Array, "3"],
    axis: Float[Array, "3"],
    radius: ScalarLike,
    r: Float[Array, " nr"],
    v_axial: Float[Array, " nr"],
    v_swirl: Float[Array, " nr"],
    sense: ScalarLike,
    speed: ScalarLike,
    edge_width: ScalarLike | Float[Array, " n"],
    cross_stream: Float[Array, "3"] | ScalarLike = 0.0,
    cross_force: Float[Array, "3"] | ScalarLike = 0.0,
    nacelle: ScalarLike = 0.0,
) -> Float[Array, "n 3"]:
    """Velocity that a rotor adds to the flow at ``points``: the mean flow of its vortex system.

    The tangential vorticity of a loaded disk forms concentric semi-infinite tubes, each as strong as the axial
    velocity changes across it. Their flow is that of a tube of air and of a disk of sinks,

        u = 2 v_axial(r_d) H(x) axis + u_disk(x, r),    swirl  2 v_swirl(r_d) (R / R_s) H(x),

    with x the distance behind the disk, H the step at the disk, R_s(x) the radius of the stream tube by
    continuity and r_d = r R / R_s the radius at which a point's air passed the disk; r is taken from the tube's
    centre line, which leaves the hub along the shaft's axis plus `skew`, less what flows around a nacelle
    (`past_nacelle`). u_disk is -v_axial just behind the disk and +v_axial just ahead: the velocity at the disk is
    v_axial, doubles behind, and on the axis of a uniform disk grows as 1 + x / sqrt(x^2 + R^2). Off the disk it is
    free of divergence and of vorticity and falls off as a sink's. Tip and root vortices leave no swirl ahead of the
    disk or outside the tube. In a stream at an angle to the shaft the walls of the skewed tube add half
    (1 + x / sqrt(x^2 + R^2)) times `tilt`, and a force across the shaft the same of `turn`, both with the flow around
    a cylinder outside the tube.

    Source: Branlard and Gaunaa, Wind Energy 18 (2015) 1973-1987 (tubes, root vortex); Conway, Journal of Fluid
    Mechanics 297 (1995) 327-355 (radial load); McCormick, Aerodynamics of V/STOL Flight (1967) (contraction).

    Arguments:
        points: where, m.
        hub: centre of the disk, m.
        axis: unit vector along the shaft, aft.
        radius: m.
        r: radii of the mid-points of equal blade elements, m.
        v_axial: mean induced axial velocity at the disk, m/s, as in ``RotorSolution``.
        v_swirl: mean induced swirl at the disk, m/s, likewise.
        sense: +1 or -1, turning about ``axis`` (``rotor.sense_sign``).
        speed: axial speed of the undisturbed stream at the disk, m/s.
        edge_width: width, m at the disk, one or by point, over which the profile goes to zero, centred on the edge
            of the tube by a quintic step.
        cross_stream: velocity of the undisturbed stream across the shaft, m/s.
        cross_force: force on the air across the shaft over rho pi R^2, m^2/s^2.
        nacelle: radius of a nacelle behind the disk, m: the air of the tube passes outside of it.

    Returns:
        Velocity in the axes of ``points``, m/s; twice differentiable in every argument.

    Validity: thrusting or lightly braking rotors (see ``contraction``); contraction and skew to first order, for
    v_axial up to about half the speed and streams within 20 degrees of the shaft.
    """
    v_mean = disk_mean(r, v_axial, radius)
    slope = jnp.broadcast_to(skew(cross_stream, v_mean, speed), (3,))
    half = 0.5 * (r[1] - r[0])
    amplitudes = ENTRAINMENT * disk_amplitudes(jnp.append(r - half, r[-1] + half), v_axial, radius)
    place = _Place(*map(jnp.asarray, (points, hub, axis, radius, r, edge_width, sense, nacelle)))
    inside, outside = (0.5 * jnp.broadcast_to(v, (3,)) for v in turn(cross_force, v_mean, speed))
    within, push = (0.5 * jnp.broadcast_to(v, (3,)) for v in tilt(cross_stream, v_mean, speed))
    profiles = jnp.stack([v_axial, v_swirl], axis=1)
    strength = _Strength(profiles, amplitudes, push, inside + within - push, outside)
    return _flow(place, _Shape(loading(v_mean, speed), slope), strength)


class _Place(NamedTuple):
    """Where the rotor and the points are, and the sense of rotation."""

    points: Array
    hub: Array
    axis: Array
    radius: Array
    r: Array
    edge_width: Array
    sense: Array
    nacelle: Array


class _Shape(NamedTuple):
    """Contraction and skew of the tube."""

    loading: Array
    slope: Array


class _Strength(NamedTuple):
    """What the flow is linear in."""

    profiles: Array  # axial and swirl velocity at the disk
    amplitudes: Array  # of the sinks
    push: Array  # across the tube, of its walls: as much inside as around it
    inside: Array  # across, of the tube: by the force across the shaft, and what walls add inside over that around it
    outside: Array  # and of the cylinder that its surroundings flow around


@jax.custom_jvp
def _flow(place: _Place, shape: _Shape, strength: _Strength) -> Float[Array, "n 3"]:
    """The velocity of `slipstream_velocity`; its rule costs little for many derivatives by the strength at once."""
    return _raw_flow(place, shape, strength)


def instantiated(primals, tangents):
    """Tangents of named tuples with zeros where a rule of derivatives is handed symbolic ones."""
    return tuple(
        type(p)(*[jnp.zeros_like(v) if isinstance(t, SymbolicZero) else t for v, t in zip(p, d, strict=True)])
        for p, d in zip(primals, tangents, strict=True)
    )


def _flow_rule(primals, tangents):
    """Linear in the strength; slopes by the four numbers of the shape once for all; the place only where it moves."""
    place, shape, strength = primals
    is_zero = [isinstance(t, SymbolicZero) for t in tangents[0]]
    d_place, d_shape, d_strength = instantiated(primals, tangents)
    numbers, unravel = ravel_pytree(shape)
    slopes = jax.jacfwd(lambda v: _raw_flow(place, unravel(v), strength))(numbers)
    change = _raw_flow(place, shape, d_strength) + slopes @ ravel_pytree(d_shape)[0]
    if not all(is_zero):
        change = change + jax.jvp(lambda p: _raw_flow(p, shape, strength), (place,), (d_place,))[1]
    return _raw_flow(place, shape, strength), change


_flow.defjvp(_flow_rule, symbolic_zeros=True)


def _raw_flow(place: _Place, shape: _Shape, strength: _Strength) -> Float[Array, "n 3"]:
    axis, radius, slope = place.axis, place.radius, shape.slope
    offset = place.points - place.hub
    x = offset @ axis
    radial = offset - x[:, None] * axis
    r2 = jnp.sum(radial**2, axis=1)
    sign, distance = disk_layer(x, radius)
    kappa = axial_development(x, radius)
    narrowing = contraction(kappa, shape.loading)
    drift = x * past_nacelle(r2, radius, place.nacelle)
    # The vector from the centre line is radial - drift slope: only its products with vectors are formed.
    inner2 = r2 - drift * (2.0 * radial @ slope - drift * (slope @ slope)) + (AXIS_CORE * radius) ** 2
    beside = beside_nacelle(kappa, place.nacelle, hub_edge(place.r, radius))
    at_disk = jnp.sqrt(jnp.maximum(inner2 - beside, (AXIS_CORE * radius) ** 2)) / narrowing
    tube = _tube_profile(at_disk, place.r, radius, place.edge_width, strength.profiles)
    along, inward = disk_velocity(distance, r2, radius, amplitudes=strength.amplitudes)
    axial = tube[:, 0] * (1.0 + sign) + sign * along
    swirl = place.sense * tube[:, 1] * (1.0 + sign) * at_disk / inner2
    square = (radius * narrowing) ** 2 + beside
    s2 = inner2 / square
    across, outward = crossflow(s2)
    wall = strength.push - strength.outside
    radially = (1.0 + kappa) * outward * (radial @ wall - drift * (slope @ wall)) / square
    within = (1.0 + kappa) / (1.0 + jnp.minimum(s2, 1e3) ** 8)
    parts = [axial, inward + radially, swirl, -drift * radially, -drift * swirl]
    vectors = [axis, radial, jnp.cross(axis, radial), slope, jnp.cross(axis, slope)]
    parts += [(1.0 + kappa) * across, (1.0 + kappa) * (across + s2 * outward), within]
    vectors += [strength.push, strength.outside, strength.inside - strength.outside]
    return sum((part[:, None] * vector for part, vector in zip(parts, vectors, strict=True)), jnp.zeros(3))


def _tube_profile(r_disk, r, radius, edge_width, values: Float[Array, "nr k"]) -> Float[Array, "n k"]:
    """Profiles given at ``r``, fading to zero at the hub and at the edge."""
    inner = smoothstep((r_disk / hub_edge(r, radius) - 1.0 + HUB_BLEND) / (2.0 * HUB_BLEND))
    outer = 1.0 - smoothstep((r_disk - radius) / edge_width + 0.5)
    return _profile(r_disk, r, values) * (inner * outer)[:, None]
