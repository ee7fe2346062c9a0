"""Polars of attached flow continued to higher Mach numbers and to the full circle of incidence, in numpy."""

import jax.numpy as jnp
import numpy as np

from hera_om.physics.section_polar import prandtl_glauert

CD_MAX, CD_MAX_SLOPE = 1.11, 0.018
"""Drag of a blade square to the flow, 1.11 + 0.018 AR (Viterna and Corrigan, NASA CP-2230, 1982, eq. 3)."""
AR_MAX = 50.0
"""Aspect ratio at which that drag reaches the 2.01 of an infinite plate and stays there (same source)."""
REVERSED_LIFT = 0.7
"""Lift of a section in reversed flow over that of the same section ahead (AirfoilPrep, NREL: Hansen 2012)."""
STEP = np.radians(5.0)
"""Distance of the added incidences, rad (choice)."""


def full_incidence(alpha, cl, cd, *, aspect_ratio=None, extend=True):
    """A polar over -180 to 180 degrees: as given where it reaches, the flat-plate law of stalled blades beyond.

    Beyond the last incidence alpha_s of the table, with c_max = 1.11 + 0.018 AR,

        cl = c_max sin(2 alpha) / 2 + A cos^2(alpha) / sin(alpha),   cd = c_max sin^2(alpha) + B cos(alpha),

    A and B such that cl and cd are continuous at alpha_s. Past 90 degrees, the flow from behind, they are those
    of 180 degrees less, the lift -0.7 times; within alpha_s of 180 degrees the lift falls to zero linearly and
    the drag to the least one of the table. Negative incidences likewise, mirrored.

    Source: Viterna and Corrigan, NASA CP-2230 (1982), eqs. 1-5; reversed flow after AirfoilPrep, NREL.

    Arguments:
        alpha: increasing incidences, rad [na], stalled or nearly so at both ends.
        cl: lift coefficients [na, ...].
        cd: drag coefficients, same shape.
        aspect_ratio: of the blade, tip radius over the chord at 75 % radius.
        extend: whether to continue a table that ends short of 180 degrees.

    Returns:
        alpha, cl, cd over -pi to pi.

    Raises:
        ValueError: the table ends short of 180 degrees and must not be extended, or has no aspect ratio for it, or
            does not reach from below -1 to above 1 degree.
    """
    alpha, cl, cd = (np.asarray(v, float) for v in (alpha, cl, cd))
    if alpha[0] <= -np.pi + 1e-9 and alpha[-1] >= np.pi - 1e-9:
        return alpha, cl, cd
    reach = f"the polar covers {np.degrees(alpha[0]):.4g} to {np.degrees(alpha[-1]):.4g} deg"
    if not extend:
        raise ValueError(f"{reach}, a blade needs -180 to 180 deg, and it is not to be extended")
    if aspect_ratio is None:
        raise ValueError(f"{reach}: to extend it to 180 deg, the aspect ratio of the blade is needed")
    if not np.radians(-90.0) < alpha[0] < np.radians(-1.0) or not np.radians(1.0) < alpha[-1] < np.radians(90.0):
        raise ValueError(f"{reach}: an extension needs ends between 1 and 90 deg on either side of zero")
    cd_max = CD_MAX + CD_MAX_SLOPE * min(float(aspect_ratio), AR_MAX)
    rest = np.min(cd, axis=0)
    above = _stalled(alpha[-1], cl[-1], cd[-1], cd_max=cd_max, rest=rest)
    below = _stalled(-alpha[0], -cl[0], cd[0], cd_max=cd_max, rest=rest)
    whole = np.concatenate([-below[0][::-1], alpha, above[0]])
    lift = np.concatenate([-below[1][::-1], cl, above[1]])
    return whole, lift, np.concatenate([below[2][::-1], cd, above[2]])


def _stalled(end, cl_end, cd_end, *, cd_max, rest):
    """Incidences beyond ``end`` up to pi with lift and drag there."""
    first = STEP * (np.floor(end / STEP + 0.3) + 1.0)
    alpha = np.append(np.arange(first, np.pi - 0.5 * STEP, STEP), np.pi)
    folded = np.where(alpha > 0.5 * np.pi, np.pi - alpha, alpha)
    inner = folded < end
    column = (-1,) + (1,) * np.ndim(cl_end)
    at = np.where(inner, end, folded).reshape(column)
    sine, cosine = np.sin(at), np.cos(at)
    a = (cl_end - cd_max * np.sin(end) * np.cos(end)) * np.sin(end) / np.cos(end) ** 2
    b = (cd_end - cd_max * np.sin(end) ** 2) / np.cos(end)
    lift = cd_max * sine * cosine + a * cosine**2 / sine
    drag = cd_max * sine**2 + b * cosine
    share = np.where(inner, folded / end, 1.0).reshape(column)
    sign = np.where(alpha > 0.5 * np.pi, -REVERSED_LIFT, 1.0).reshape(column)
    return alpha, sign * share * lift, np.maximum(rest + share * (drag - rest), rest)


def with_mach_numbers(alpha, cl, cd, mach):
    """An incompressible polar at several Mach numbers: its incidences from zero lift shrink by Prandtl and Glauert.

    ``cl(alpha, M) = cl(alpha0 + (alpha - alpha0) / sqrt(1 - M^2), 0)`` and the drag likewise: the slope grows, the
    largest lift coefficient stays, and stall comes earlier. There is no drag rise.

    Source: Prandtl-Glauert, Katz and Plotkin, Low-Speed Aerodynamics 2e, section 4.1; the rest is a choice.

    Arguments:
        alpha: increasing incidences, rad [na], zero lift among them.
        cl: lift coefficients [na, nre].
        cd: drag coefficients, same shape.
        mach: increasing Mach numbers [nm].

    Returns:
        alpha, cl, cd: the incidences that every Mach number reaches [na'], coefficients [na', nre, nm].
    """
    alpha, cl, cd = (np.asarray(v, float) for v in (alpha, cl, cd))
    factors = np.asarray(prandtl_glauert(jnp.asarray(mach, float)))
    zero = np.array([_zero_lift(alpha, column) for column in cl.T])
    low, high = (zero + (end - zero) / factors.max() for end in (alpha[0], alpha[-1]))
    kept = alpha[(alpha >= low.max()) & (alpha <= high.min())]
    shape = (len(kept), len(zero), len(factors))
    lift, drag = np.empty(shape), np.empty(shape)
    for j, a0 in enumerate(zero):
        for k, factor in enumerate(factors):
            at = a0 + (kept - a0) * factor
            lift[:, j, k], drag[:, j, k] = np.interp(at, alpha, cl[:, j]), np.interp(at, alpha, cd[:, j])
    return kept, lift, drag


def _zero_lift(alpha, lift) -> float:
    """Incidence at which the lift first rises through zero."""
    i = int(np.flatnonzero((lift[:-1] <= 0.0) & (lift[1:] > 0.0))[0])
    return alpha[i] - lift[i] * (alpha[i + 1] - alpha[i]) / (lift[i + 1] - lift[i])
