"""Load factor of a discrete gust by CS 25.341(a): a rigid aeroplane that heaves, with unsteady lift."""

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.beam_loads import STANDARD_GRAVITY

ScalarLike = Float[Array, ""] | float | int

# CS 25.341(a)(5)(i): reference gust velocities, m/s EAS, at altitudes in m, at V_C.
REFERENCE_ALTITUDE = np.array([0.0, 4572.0, 18288.0])
REFERENCE_VELOCITY = np.array([17.07, 13.41, 6.36])
GRADIENTS = np.geomspace(9.0, 107.0, 9)  # m, CS 25.341(a)(3)
LARGEST_GRADIENT = 107.0
_RELIEF_ALTITUDE = 76200.0  # m, CS 25.341(a)(6)
SEA_LEVEL_DENSITY = 1.225  # kg/m3, ISO 2533
_STEPS = 240

# Indicial lift of Jones, NACA Report 681: 1 - sum a exp(-b s), s in half chords; Wagner's and Kuessner's functions.
WAGNER = np.array([[0.165, 0.0455], [0.335, 0.300]])
KUESSNER = np.array([[0.500, 0.130], [0.500, 1.000]])


def reference_gust(altitude: ScalarLike) -> Float[Array, ""]:
    """Reference gust velocity at V_C, m/s EAS. CS 25.341(a)(5)(i)."""
    return jnp.interp(jnp.asarray(altitude, float), REFERENCE_ALTITUDE, REFERENCE_VELOCITY)


def profile_alleviation(
    altitude: ScalarLike, *, ceiling: ScalarLike, landing_ratio: ScalarLike, zero_fuel_ratio: ScalarLike
) -> Float[Array, ""]:
    """Flight profile alleviation factor F_g at an altitude. CS 25.341(a)(6).

    (F_gz + F_gm) / 2 at sea level, F_gz = 1 - Z_mo / 76200 m, F_gm = sqrt(R2 tan(pi R1 / 4)); 1 at Z_mo, linear
    between them.

    Args:
        altitude: m, up to the ceiling.
        ceiling: greatest operating altitude Z_mo, m.
        landing_ratio: R1, landing over take-off mass.
        zero_fuel_ratio: R2, zero-fuel over take-off mass.
    """
    by_mass = jnp.sqrt(zero_fuel_ratio * jnp.tan(0.25 * jnp.pi * landing_ratio))
    ground = 0.5 * (1.0 - ceiling / _RELIEF_ALTITUDE + by_mass)
    return ground + (1.0 - ground) * altitude / ceiling


def alleviation(mass_ratio: ScalarLike, gradient: ScalarLike) -> Float[Array, ""]:
    """Gust alleviation factor K: largest lift over that of the full gust at once, without motion.

    A rigid aeroplane that heaves without pitching through U (1 - cos(pi s / H)) / 2, 0 < s < 2 H:
    2 mu dv/ds = g - w, where g and w are gust and heave velocity seen through Kuessner's and Wagner's functions
    (Bisplinghoff, Ashley, Halfman, Aeroelasticity, ch. 10); by Runge-Kutta of fourth order.

    Args:
        mass_ratio: mu = 2 m / (rho c a S).
        gradient: H in half chords.

    Returns:
        K. Pratt's formula 0.88 mu / (5.3 + mu) is this for H of 12.5 chords.
    """
    step = 2.0 * gradient / _STEPS

    def gust(s: Float[Array, ""]) -> Float[Array, ""]:
        return 0.5 * (1.0 - jnp.cos(jnp.pi * s / gradient))

    def felt(s, x):
        return gust(s) - KUESSNER[:, 0] @ x[1:3] - (x[0] - WAGNER[:, 0] @ x[3:])

    def rate(s, x):
        heave = felt(s, x) / (2.0 * mass_ratio)
        rise = 0.5 * jnp.pi / gradient * jnp.sin(jnp.pi * s / gradient)
        lag = jnp.concatenate([rise - KUESSNER[:, 1] * x[1:3], heave - WAGNER[:, 1] * x[3:]])
        return jnp.concatenate([heave[None], lag])

    def advance(x, s):
        k1 = rate(s, x)
        k2 = rate(s + step / 2, x + step / 2 * k1)
        k3 = rate(s + step / 2, x + step / 2 * k2)
        k4 = rate(s + step, x + step * k3)
        new = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return new, felt(s + step, new)

    _, history = lax.scan(advance, jnp.zeros(5), step * jnp.arange(_STEPS))
    return jnp.max(history)


def gust_factor(
    mass: ScalarLike,
    *,
    lift_slope: ScalarLike,
    area: ScalarLike,
    chord: ScalarLike,
    altitude: ScalarLike,
    V_C: ScalarLike,
    ceiling: ScalarLike,
    landing_ratio: ScalarLike,
    zero_fuel_ratio: ScalarLike,
) -> Float[Array, ""]:
    """Increment of the load factor at V_C: the largest over gradients, at sea level and at an altitude.

    Delta n = rho_0 V_C U_ds a S K / (2 m g), U_ds = U_ref F_g (H / 107 m)^(1/6). CS 25.341(a)(4).

    Args:
        mass: kg.
        lift_slope: dCL / d alpha, 1/rad.
        area: m2.
        chord: mean chord, m.
        altitude: m, below the ceiling.
        V_C: m/s EAS.
        ceiling: greatest operating altitude, m.
        landing_ratio: landing over take-off mass.
        zero_fuel_ratio: zero-fuel over take-off mass.

    Returns:
        Delta n of gusts upwards; downwards it is the same. Errors: rigid, no pitching, gradients from a list.
    """
    heights = jnp.stack([jnp.zeros(()), jnp.asarray(altitude, float)])
    density = SEA_LEVEL_DENSITY * (1.0 - 2.25577e-5 * heights) ** 4.25588  # ISO 2533, troposphere
    share = (GRADIENTS / LARGEST_GRADIENT) ** (1.0 / 6.0)

    def largest(height, rho):
        relief = profile_alleviation(
            height, ceiling=ceiling, landing_ratio=landing_ratio, zero_fuel_ratio=zero_fuel_ratio
        )
        mu = 2.0 * mass / (rho * chord * lift_slope * area)
        k = jax.vmap(lambda h: alleviation(mu, h))(2.0 * GRADIENTS / chord)
        return reference_gust(height) * relief * jnp.max(share * k)

    velocity = jnp.max(jax.vmap(largest)(heights, density))
    return SEA_LEVEL_DENSITY * V_C * velocity * lift_slope * area / (2.0 * mass * STANDARD_GRAVITY)
