"""The velocity that a rotor's slipstream adds to the flow: a contracting tube with axial and swirl parts."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike, smoothstep, soft_clip

SWIRL_RISE = 0.1
"""The swirl rises from nothing to its full value within this many radii ahead of and behind the disk
(choice)."""
HUB_BLEND = 0.25
"""The profiles fade to zero between 1 + and 1 - this fraction of the radius of the innermost element's
inner edge."""
LOADING_CENTRE, LOADING_HALF_RANGE = 0.25, 0.95
"""Limits of v / (V + v) in the contraction: exact from -0.51 (windmilling at a = 0.34) to 1.01 (static), held
within -0.7 and 1.2, so that the tube of a braking rotor widens to a finite radius."""
AXIS_CORE = 1e-6
"""Radius over rotor radius under which the distance from the axis is rounded off; the swirl is zero there."""


def _spline_curvatures(r: Float[Array, " nr"], values: Float[Array, "nr k"]) -> Float[Array, "nr k"]:
    """Second derivatives of the natural cubic spline through ``values`` at ``r``."""
    n = r.shape[0]
    h = jnp.diff(r)
    rise = jnp.diff(values, axis=0) / h[:, None]
    inner = jnp.arange(1, n - 1)
    matrix = jnp.eye(n).at[inner, inner].set((h[:-1] + h[1:]) / 3.0)
    matrix = matrix.at[inner, inner - 1].set(h[:-1] / 6.0).at[inner, inner + 1].set(h[1:] / 6.0)
    right = jnp.zeros_like(values).at[inner].set(jnp.diff(rise, axis=0))
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


def axial_development(x: Float[Array, "..."], radius: ScalarLike) -> Float[Array, "..."]:
    """Growth of the axial velocity along the axis: kappa = x / sqrt(x^2 + R^2), -1 far ahead to 1 far
    behind.
    """
    return x / jnp.sqrt(x**2 + radius**2)


def contraction(kappa: Float[Array, "..."], v_mean: ScalarLike, speed: ScalarLike) -> Float[Array, "..."]:
    """Radius of the stream tube over that at the disk, by continuity of the mean velocity V + v (1 + kappa).

    ``(R_s / R)^2 = (V + v) / (V + v (1 + kappa)) = 1 / (1 + loading kappa)`` with ``loading = v / (V +
    v)``, limited softly for rotors that brake beyond a = 0.34.
    """
    through = speed + v_mean
    positive = jnp.abs(through) > 1e-9
    loading = jnp.where(positive, v_mean / jnp.where(positive, through, 1.0), 0.0)
    limited = soft_clip((loading - LOADING_CENTRE) / LOADING_HALF_RANGE, 0.8)
    return 1.0 / jnp.sqrt(1.0 + (LOADING_CENTRE + LOADING_HALF_RANGE * limited) * kappa)


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
    edge_width: ScalarLike,
) -> Float[Array, "n 3"]:
    """Velocity that a rotor's slipstream adds to the flow at ``points``.

    With x the distance behind the disk along ``axis``, kappa = x / sqrt(x^2 + R^2), R_s(x) the radius of
    the stream tube by continuity and r_d = r R / R_s the radius at which a point's air passed the disk,

        axial  v_axial(r_d) (1 + kappa),    swirl  2 v_swirl(r_d) (R / R_s) H(x),

    so the axial velocity doubles far behind, and r v_t is conserved along the tube. H rises from 0 to 1 over
    ``+-SWIRL_RISE`` radii about the disk. Outside the tube there is nothing: the entrained flow there and
    ahead of the disk beyond the (widening) tube is small and left out, as is any deflection of the tube.

    Source: axial development of the semi-infinite vortex cylinder, McCormick, Aerodynamics of V/STOL Flight
        (1967),
    as used by Veldhuis, PhD thesis, TU Delft (2005); swirl by conservation of angular momentum, Glauert
    (1935).

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
        edge_width: width, m at the disk, over which the profile goes to zero, centred on the edge of the
            tube by a quintic step.

    Returns:
        Velocity in the axes of ``points``, m/s; twice differentiable in every argument.

    Validity: thrusting or lightly braking rotors (see ``contraction``); a stream nearly along the axis.
    """
    offset = points - hub
    x = offset @ axis
    radial = offset - x[:, None] * axis
    distance = jnp.sqrt(jnp.sum(radial**2, axis=1) + (AXIS_CORE * radius) ** 2)
    kappa = axial_development(x, radius)
    narrowing = contraction(kappa, disk_mean(r, v_axial, radius), speed)
    r_disk = distance / narrowing
    hub_edge = r[0] - 0.5 * (r[1] - r[0])
    inner = smoothstep((r_disk / hub_edge - 1.0 + HUB_BLEND) / (2.0 * HUB_BLEND))
    outer = 1.0 - smoothstep((r_disk - radius) / edge_width + 0.5)
    profile = _profile(r_disk, r, jnp.stack([v_axial, v_swirl], axis=1)) * (inner * outer)[:, None]
    axial = profile[:, 0] * (1.0 + kappa)
    rise = smoothstep(0.5 * (x / (SWIRL_RISE * radius) + 1.0))
    swirl = sense * 2.0 * profile[:, 1] * rise / narrowing / distance
    return axial[:, None] * axis + swirl[:, None] * jnp.cross(axis, radial)
