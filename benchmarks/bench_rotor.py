"""The isolated rotor of 20 x 36 elements with its Jacobian by pitch, speed and incidence.

    OMP_NUM_THREADS=1 XLA_FLAGS=--xla_cpu_multi_thread_eigen=false python benchmarks/bench_rotor.py

CPU milliseconds of the process for one call, least of several means, one thread, without compiling: polars of seven
numbers, and from a table over incidence, Reynolds and Mach number. The aim is 3 ms.
"""

import jax
import jax.numpy as jnp
import numpy as np
from measure import cpu_time, emit

from hera_om.physics.blade_polar import make_blade_table
from hera_om.physics.polar_extension import full_incidence, with_mach_numbers
from hera_om.physics.rotor import blade_elements, solve_rotor
from hera_om.physics.section_polar import SectionPolar

RADIUS, HUB, NR, NPSI = 1.95, 0.2925, 20, 36
X = jnp.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0])
CHORD = jnp.array([0.130, 0.140, 0.147, 0.150, 0.151, 0.150, 0.143, 0.122, 0.100, 0.060])
TWIST = jnp.radians(jnp.array([28.50, 22.19, 16.35, 11.02, 6.23, 1.96, -1.84, -5.22, -6.76, -8.21]))
AIR = dict(omega=106.8, radius=RADIUS, hub_radius=HUB, n_blades=6.0, density=0.55, sound_speed=312.0, viscosity=1.6e-5)
CASES = {"cruise": [0.81, 158.0, 0.03], "take-off": [0.45, 20.0, 0.2], "windmill": [0.60, 158.0, 0.1]}
NUMBERS = SectionPolar(6.0, np.radians(-3.0), 0.008, 0.3, 0.010, 1.4, 1.0)


def table():
    """The same section over three Reynolds and three Mach numbers."""
    alpha = np.radians(np.arange(-14.0, 17.0))
    cl = np.clip(6.0 * (alpha + np.radians(3.0)), -1.0, 1.4)
    cd = 0.008 + 0.01 * (cl - 0.3) ** 2
    columns = np.stack([cl] * 3, axis=1), np.stack([1.4 * cd, cd, 0.8 * cd], axis=1)
    mach = [0.0, 0.3, 0.6]
    alpha, cl, cd = full_incidence(*with_mach_numbers(alpha, *columns, mach), aspect_ratio=7.0)
    return make_blade_table(alpha, [3e5, 1e6, 3e6], mach, cl=cl, cd=cd)


def with_jacobian(blade):
    """Everything that the coupling takes of a rotor, by pitch, speed and incidence."""

    def run(x):
        flow = x[1] * jnp.stack([jnp.cos(x[2]), 0.0 * x[2], jnp.sin(x[2])])
        velocity = jnp.broadcast_to(flow, (NR, NPSI, 3))
        found = solve_rotor(blade, velocity, pitch=x[0], sense=-1.0, **AIR)
        return (found.force, found.moment, found.v_axial, found.v_swirl), found

    return jax.jit(jax.jacfwd(run, has_aux=True))


def main():
    """Time every case with either polar."""
    for polar_name, polar in (("numbers", NUMBERS), ("table", table())):
        blade = blade_elements(RADIUS, HUB, X, CHORD, TWIST, polar=polar, n=NR)
        solve = with_jacobian(blade)
        for case, values in CASES.items():
            x = jnp.array(values)
            seconds = cpu_time(lambda x=x, solve=solve: jax.block_until_ready(solve(x)))
            emit("hera_om", f"rotor and Jacobian, {polar_name}, {case}", seconds)


if __name__ == "__main__":
    main()
