"""Cruise range by the paper's Eq. 6 with two ways to spend saved mass, and the pull-up pitch rate."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.atmosphere import STANDARD_GRAVITY

ScalarLike = Float[Array, ""] | float | int


class CruiseRange(NamedTuple):
    """Range in m by both fuel options, weights in N at start and end, and m flown per J of shaft energy."""

    range_fixed_takeoff: Float[Array, ""]
    W_i_fixed_takeoff: Float[Array, ""]
    W_f_fixed_takeoff: Float[Array, ""]
    range_fixed_fuel: Float[Array, ""]
    W_i_fixed_fuel: Float[Array, ""]
    W_f_fixed_fuel: Float[Array, ""]
    range_per_shaft_energy: Float[Array, ""]


def breguet_range(
    speed: ScalarLike, c_s: ScalarLike, L_over_D: ScalarLike, *, W_i: ScalarLike, W_f: ScalarLike
) -> Float[Array, ""]:
    """Breguet's range at constant speed and lift-to-drag ratio.

    ``R = U / c_s * L/D * ln(W_i / W_f)``.

    Source: Granata et al., Aerosp. Sci. Technol. (2026), Eq. 6; Anderson, Aircraft Performance and Design,
    section 5.13.

    Args:
        speed: true airspeed, m/s.
        c_s: fuel WEIGHT flow per thrust, 1/s (a mass-based figure times g).
        L_over_D: lift-to-drag ratio.
        W_i: weight at the start of cruise, N (any unit that ``W_f`` shares).
        W_f: weight at its end.

    Returns:
        Range, m.

    Valid for W_i > W_f > 0 and a c_s that does not change in cruise.
    """
    return speed / c_s * L_over_D * jnp.log(W_i / W_f)


def cruise_range(
    speed: ScalarLike,
    L_over_D: ScalarLike,
    c_s: ScalarLike,
    *,
    takeoff_mass: ScalarLike,
    climb_fuel: ScalarLike,
    cruise_fuel: ScalarLike,
    mass_saved: ScalarLike,
    shaft_power: ScalarLike,
) -> CruiseRange:
    """Range with saved mass turned into fuel, with the fuel of the baseline, and per shaft energy.

    Fixed take-off mass: ``m_i = m_to - m_climb``, ``m_f = m_i - (m_cruise + saved)``. Fixed fuel:
    ``m_i = m_to - saved - m_climb``, ``m_f = m_i - m_cruise``. Both by Eq. 6. Per energy: ``R / E = U / P``.

    Source: Granata et al. (2026), Eq. 6, see :func:`breguet_range`.

    Args:
        speed: true airspeed, m/s.
        L_over_D: lift-to-drag ratio.
        c_s: fuel weight flow per thrust, 1/s.
        takeoff_mass: take-off mass of the baseline, kg.
        climb_fuel: fuel burnt before cruise, kg.
        cruise_fuel: fuel burnt in cruise by the baseline, kg.
        mass_saved: structural mass of the sized baseline less that of this design, kg (negative if heavier).
        shaft_power: sum over all rotors in cruise, W.

    Returns:
        Both ranges with their weights, and the distance per unit of shaft energy, m/J.

    Valid while the fuel stays positive and below the weight at the start; L/D ignores power, so read the
    third measure beside the first two.
    """
    start_heavy = takeoff_mass - climb_fuel
    start_light = start_heavy - mass_saved
    weights = (
        STANDARD_GRAVITY * start_heavy,
        STANDARD_GRAVITY * (start_heavy - cruise_fuel - mass_saved),
        STANDARD_GRAVITY * start_light,
        STANDARD_GRAVITY * (start_light - cruise_fuel),
    )
    W_i, W_f, W_i_fuel, W_f_fuel = (jnp.asarray(weight) for weight in weights)
    return CruiseRange(
        range_fixed_takeoff=breguet_range(speed, c_s, L_over_D, W_i=W_i, W_f=W_f),
        W_i_fixed_takeoff=W_i,
        W_f_fixed_takeoff=W_f,
        range_fixed_fuel=breguet_range(speed, c_s, L_over_D, W_i=W_i_fuel, W_f=W_f_fuel),
        W_i_fixed_fuel=W_i_fuel,
        W_f_fixed_fuel=W_f_fuel,
        range_per_shaft_energy=jnp.asarray(speed / shaft_power),
    )


def pull_up_rate(
    speed: ScalarLike, load_factor: ScalarLike, gravity: ScalarLike = STANDARD_GRAVITY
) -> Float[Array, ""]:
    """Pitch rate at the bottom of a steady pull-up: ``q = g (n - 1) / V``.

    Source: Etkin and Reid, Dynamics of Flight (3rd edition), section 3.1.

    Args:
        speed: true airspeed, m/s.
        load_factor: lift over weight.
        gravity: m/s2.

    Returns:
        Pitch rate, rad/s; ``q_hat`` is this times c / 2V.

    Valid for level wings at the lowest point of the path.
    """
    return jnp.asarray(gravity * (load_factor - 1.0) / speed)
