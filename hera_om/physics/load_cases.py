"""Load cases of the wing by CS-25: factors of lift, inertia and fuel, and their mixture from unit loads.

Section loads are linear in what causes them, so a case is a row of coefficients over `UNIT_LOADS`. The air loads of
a case lie on the straight line through the trimmed cruise and the trimmed pull-up, by lift: exact for a linear
flow at the speed and the power of the cruise, with the balance of tail and elevator that goes with the lift.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.beam_loads import STANDARD_GRAVITY
from hera_om.physics.gust import gust_factor

ScalarLike = Float[Array, ""] | float | int

CASES = (
    "pull-up",
    "pull-up, dry",
    "push-over",
    "gust up",
    "gust up, dry",
    "gust down",
    "landing",
    "taxi",
    "motor failed",
)
UNIT_LOADS = ("cruise", "pull-up", "outer rotor", "structure", "fuel", "motors", "pitch rate")

NEGATIVE_FACTOR = -1.0  # CS 25.337(c), up to V_C
# CS 25.491 asks for a dynamic analysis over rough ground; 2 g is the conventional static stand-in for gear with
# single axles (Niu, Airframe Structural Design, ch. 3).
TAXI_FACTOR = 2.0
SINK_RATE = 3.05  # m/s at the landing weight, CS 25.473(a)
# Energy efficiency of an oleo-pneumatic strut: Currey, Aircraft Landing Gear Design, ch. 5 (0.75 to 0.85).
STRUT_EFFICIENCY = 0.80


class CaseWeights(NamedTuple):
    """Masses, kg, and what the factors depend on."""

    take_off: ScalarLike
    cruise: ScalarLike
    fuel: ScalarLike
    landing: ScalarLike


def landing_factor(stroke: ScalarLike, sink_rate: ScalarLike = SINK_RATE) -> Float[Array, ""]:
    """Load factor of the ground in a landing, lift equal to weight: v^2 / (2 g eta s).

    The strut takes the energy m v^2 / 2 over its stroke with N m g eta s; Currey, ch. 5. The wing feels 1 + N.

    Args:
        stroke: stroke of the main gear with its tyres, m.
        sink_rate: limit rate of descent, m/s.
    """
    return jnp.square(sink_rate) / (2.0 * STANDARD_GRAVITY * STRUT_EFFICIENCY * jnp.asarray(stroke))


def gyroscopic_moment(
    inertia: Float[Array, "r"], spin: Float[Array, "r 3"], rate: Float[Array, "3"]
) -> Float[Array, "r 3"]:
    """Moment that turning rotors put on what carries them, I Omega x omega, N m (CS 25.371).

    Args:
        inertia: polar moments of inertia of the rotors, kg m2.
        spin: their angular velocities, rad/s, geometry axes.
        rate: angular velocity of the aircraft, rad/s, geometry axes.
    """
    return jnp.cross(inertia[:, None] * spin, rate)


def case_matrix(
    weights: CaseWeights,
    *,
    limit_factor: ScalarLike,
    lift_slope: ScalarLike,
    area: ScalarLike,
    chord: ScalarLike,
    altitude: ScalarLike,
    V_C: ScalarLike,
    ceiling: ScalarLike,
    speed: ScalarLike,
    stroke: ScalarLike,
) -> Float[Array, "9 7"]:
    """Coefficients of `UNIT_LOADS` in each of `CASES`.

    Pull-up by CS 25.337(b) with full and with empty wing tanks, push-over by 25.337(c), gusts at V_C by 25.341
    with full and empty tanks, landing by 25.473, taxi by 25.491, the outermost rotor failed in the cruise
    (25.367). Lift of a case = n times the weight of that loading, and nothing on the ground; in the landing it is
    the weight, while inertia is 1 + N. The pitch rate of a manoeuvre is g (n - 1) / V.

    Args:
        weights: masses; without fuel the rest of the aircraft stays as it is.
        limit_factor: limit load factor of manoeuvres.
        lift_slope: dCL / d alpha of the aircraft, 1/rad.
        area: reference area, m2.
        chord: mean chord, m.
        altitude: pressure altitude of the cruise, m; gusts are looked at there and at sea level.
        V_C: design cruising speed, equivalent airspeed, m/s.
        ceiling: greatest operating altitude, m.
        speed: true airspeed of the trimmed cases, m/s.
        stroke: stroke of the main gear, m.

    Returns:
        [case, unit load]: the two air loads and the outer rotor as shares, masses at load factors, pitch rate in
        rad/s.
    """
    full, dry = weights.take_off, weights.take_off - weights.fuel

    def gust(mass: ScalarLike) -> Float[Array, ""]:
        return gust_factor(
            mass,
            lift_slope=lift_slope,
            area=area,
            chord=chord,
            altitude=altitude,
            V_C=V_C,
            ceiling=ceiling,
            landing_ratio=weights.landing / full,
            zero_fuel_ratio=dry / full,
        )

    wet, light, pull = gust(full), gust(dry), jnp.asarray(limit_factor, float)
    touch = 1.0 + landing_factor(stroke)
    factor = [pull, pull, NEGATIVE_FACTOR, 1.0 + wet, 1.0 + light, 1.0 - wet, touch, TAXI_FACTOR, 1.0]
    mass = [full, dry, full, full, dry, full, weights.landing, full, weights.cruise]
    n, flown = jnp.stack([jnp.asarray(v, float) for v in factor]), jnp.ones(len(CASES)).at[7].set(0.0)
    lift = n.at[6].set(1.0) * jnp.stack([jnp.asarray(v, float) for v in mass])
    along = (lift - weights.cruise) / (limit_factor * full - weights.cruise)
    tanks = jnp.ones(len(CASES)).at[jnp.array([1, 4])].set(0.0)
    manoeuvre = jnp.zeros(len(CASES)).at[:3].set(1.0)
    failed = jnp.zeros(len(CASES)).at[8].set(-1.0)
    rate = STANDARD_GRAVITY * (n - 1.0) / speed * manoeuvre
    return jnp.stack([flown * (1.0 - along), flown * along, failed, n, n * tanks, n, rate], axis=1)
