"""International Standard Atmosphere up to 20 km, with Sutherland's viscosity."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

ScalarLike = Float[Array, ""] | float | int

# ICAO Doc 7488/3 (1993), table A and section 2; the same values as U.S. Standard Atmosphere 1976, tables 2
# and 4.
STANDARD_GRAVITY = 9.80665  # m/s2
TEMPERATURE_SEA_LEVEL = 288.15  # K
PRESSURE_SEA_LEVEL = 101325.0  # Pa
LAPSE_RATE = -0.0065  # K/m, from sea level to the tropopause
TROPOPAUSE = 11000.0  # m, geopotential
GAS_CONSTANT = 287.05287  # J/(kg K)
HEAT_CAPACITY_RATIO = 1.4
# U.S. Standard Atmosphere 1976, Eq. 51: mu = beta T^1.5 / (T + S).
SUTHERLAND_BETA = 1.458e-6  # kg/(s m K^0.5)
SUTHERLAND_TEMPERATURE = 110.4  # K


class Atmosphere(NamedTuple):
    """State of the air: K, Pa, kg/m3, m/s, Pa s."""

    temperature: Float[Array, ""]
    pressure: Float[Array, ""]
    density: Float[Array, ""]
    sound_speed: Float[Array, ""]
    viscosity: Float[Array, ""]


def isa(altitude: ScalarLike) -> Atmosphere:
    """State of the standard atmosphere at a geopotential altitude.

    Troposphere ``T = T0 + L h``, ``p = p0 (T / T0)^(-g / (L R))``; above 11 km ``T`` is constant and
    ``p = p11 exp(-g (h - h11) / (R T11))``; ``rho = p / (R T)``, ``a = sqrt(gamma R T)``.

    Source: ICAO Doc 7488/3, section 2; viscosity by U.S. Standard Atmosphere 1976, Eq. 51.

    Args:
        altitude: geopotential altitude, m.

    Returns:
        Temperature, pressure, density, speed of sound and dynamic viscosity.

    Valid from -2 to 20 km. Analytic on each side of the tropopause; at 11 km the standard itself has a kink
    in temperature and density (pressure is smooth), and the derivative there is the stratosphere's.
    """
    altitude = jnp.asarray(altitude, dtype=float)
    below = altitude < TROPOPAUSE
    temperature = TEMPERATURE_SEA_LEVEL + LAPSE_RATE * jnp.where(below, altitude, TROPOPAUSE)
    exponent = -STANDARD_GRAVITY / (LAPSE_RATE * GAS_CONSTANT)
    above = jnp.where(below, 0.0, altitude - TROPOPAUSE)
    decay = jnp.exp(-STANDARD_GRAVITY * above / (GAS_CONSTANT * temperature))
    pressure = PRESSURE_SEA_LEVEL * (temperature / TEMPERATURE_SEA_LEVEL) ** exponent * decay
    return Atmosphere(
        temperature=temperature,
        pressure=pressure,
        density=pressure / (GAS_CONSTANT * temperature),
        sound_speed=jnp.sqrt(HEAT_CAPACITY_RATIO * GAS_CONSTANT * temperature),
        viscosity=SUTHERLAND_BETA * temperature**1.5 / (temperature + SUTHERLAND_TEMPERATURE),
    )
