"""Lift and drag of the sections of a turning blade beyond stall: delay by rotation."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.section_polar import smoothstep

DU_SELIG = (1.6, 0.1267)
"""Numbers of Du and Selig's lift factor; their a, b, d are one."""
EGGERS = 0.12
"""Ratio of the drag to the lift of the added force in Eggers's axes (Eggers, Chaney and Digumarthi, 2003)."""
FADE_START, FADE_END = 0.5236, 1.3615
"""Incidence from zero lift, rad, over which the delay fades out: 30 to 78 degrees, as in AirfoilPrep, NREL."""
FACTOR_RISE = 0.05
"""Below this the factor is rounded off to a floor of zero (choice)."""
LEAST_RATIO = 1e-3
"""Floor of the speed ratio, at which the delay has long vanished."""


def delayed(cl, cd, *, alpha, lift_line, chord_ratio, radius_ratio, speed_ratio):
    """Coefficients with the stall delay by rotation.

    The lift moves from ``cl`` towards the lift line ``cl_p = m (alpha - alpha0)`` of attached flow by the factor

        f = (1.6 (c/r) / 0.1267 (1 - q) / (1 + q) - 1) / 2 pi,   q = (c/r)^(R / (Lambda r)),

    not below zero, with ``Lambda = omega R / sqrt(V^2 + (omega R)^2)``; the drag changes by the lift's change
    times ``(sin(alpha) - 0.12 cos(alpha)) / (cos(alpha) + 0.12 sin(alpha))``. Nothing changes in attached flow.

    Source: Du and Selig, AIAA 98-0021 (1998), eq. 18; Eggers, Chaney and Digumarthi, AIAA 2003-0519; both as in
        AirfoilPrep, NREL.

    Arguments:
        cl: lift coefficients without rotation.
        cd: drag coefficients likewise.
        alpha: incidence, rad.
        lift_line: slope m (1/rad) and zero-lift incidence (rad).
        chord_ratio: chord over the local radius.
        radius_ratio: local radius over the tip radius.
        speed_ratio: Lambda, 0 at rest.

    Returns:
        cl, cd.

    Validity: fitted to windmills in stall of up to 30 degrees; c / r up to about one.
    """
    slope, alpha0 = lift_line
    share = delay_factor(chord_ratio, radius_ratio, speed_ratio)
    from_zero = jnp.abs(alpha - alpha0)
    fade = 1.0 - smoothstep((from_zero - FADE_START) / (FADE_END - FADE_START))
    within = jnp.where(fade > 0.0, alpha, 0.0)  # the drag's ratio has a pole at 83 degrees
    gain = fade * share * (slope * (within - alpha0) - cl)
    sine, cosine = jnp.sin(within), jnp.cos(within)
    return cl + gain, cd + gain * (sine - EGGERS * cosine) / (cosine + EGGERS * sine)


def delay_factor(chord_ratio, radius_ratio, speed_ratio) -> Float[Array, "..."]:
    """Du and Selig's factor f, rounded off to a floor of zero."""
    exponent = 1.0 / (jnp.maximum(speed_ratio, LEAST_RATIO) * radius_ratio)
    q = chord_ratio**exponent
    f = (DU_SELIG[0] * chord_ratio / DU_SELIG[1] * (1.0 - q) / (1.0 + q) - 1.0) / (2.0 * jnp.pi)
    return f * smoothstep(f / FACTOR_RISE)
