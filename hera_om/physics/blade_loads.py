"""What pictures and reports want of a rotor's solution: efficiency, loads of a section around the disk."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.rotor import Blade, RotorSolution
from hera_om.physics.section_polar import ScalarLike


def efficiency(solution: RotorSolution, speed: ScalarLike) -> Float[Array, ""]:
    """Propulsive efficiency T V / P, zero where the shaft gives no power.

    Arguments:
        solution: of the rotor.
        speed: of flight, m/s.
    """
    driven = solution.power > 0.0
    return jnp.where(driven, solution.thrust * speed / jnp.where(driven, solution.power, 1.0), 0.0)


def section_loading(
    solution: RotorSolution, blade: Blade, at: ScalarLike, *, omega: ScalarLike, radius: ScalarLike, density: ScalarLike
) -> Float[Array, " npsi"]:
    """Thrust of one blade's section over azimuth, ``dT/dr / (rho n^2 D^3)``, linear between the elements.

    The azimuths are those of ``azimuths``, 0 to starboard, 90 degrees up.

    Arguments:
        solution: of the rotor.
        blade: its elements, at least two.
        at: radius of the section over the tip radius, such as 0.75; held within the elements' mid-points.
        omega: angular speed, rad/s, not zero.
        radius: tip radius, m.
        density: kg/m^3.
    """
    r = jnp.clip(at * radius, blade.r[0], blade.r[-1])
    i = jnp.clip(jnp.searchsorted(blade.r, r) - 1, 0, blade.r.shape[0] - 2)
    t = (r - blade.r[i]) / (blade.r[i + 1] - blade.r[i])
    load = (1.0 - t) * solution.blade_thrust[i] + t * solution.blade_thrust[i + 1]
    return load / (density * jnp.square(omega / (2.0 * jnp.pi)) * (2.0 * radius) ** 3)
