"""The standard atmosphere against the tables of ICAO Doc 7488 and U.S. Standard Atmosphere 1976."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import atmosphere
from hera_om.physics.atmosphere import isa

# Geopotential altitude, T, p, rho, a, mu; as many digits as the tables print. 6096 m is 20 000 ft; 20 km is
# the base of the next layer of U.S. Standard Atmosphere 1976 (table 4), still at 216.65 K.
TABLE = [
    (0.0, 288.15, 101325.0, 1.2250, 340.294, 1.7894e-5),
    (5000.0, 255.65, 54019.9, 0.736116, 320.529, 1.6281e-5),
    (6096.0, 248.526, 46563.3, 0.652692, 316.032, 1.5915e-5),
    (11000.0, 216.65, 22632.06, 0.363918, 295.069, 1.4216e-5),
    (20000.0, 216.65, 5474.889, 0.0880349, 295.069, 1.4216e-5),
]


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row[0]:.0f} m")
def test_table(row):
    altitude, *expected = row
    np.testing.assert_allclose(isa(altitude), expected, rtol=5e-5)


def test_cruise_of_the_reference_aircraft():
    # hera_like.toml prints V 158.0 m/s, rho 0.6527 and q 8149 Pa at Mach 0.5 and 6096 m
    air = isa(6096.0)
    speed = 0.5 * air.sound_speed
    np.testing.assert_allclose([speed, air.density, 0.5 * air.density * speed**2], [158.0, 0.6527, 8149.0], rtol=2e-4)


@pytest.mark.parametrize("altitude", [3000.0, 14000.0])
def test_hydrostatic_balance(altitude):
    slope = jax.jacfwd(lambda h: isa(h).pressure)(jnp.asarray(altitude))
    np.testing.assert_allclose(slope, -isa(altitude).density * atmosphere.STANDARD_GRAVITY, rtol=1e-12)


def test_pressure_and_its_slope_pass_the_tropopause_without_a_step():
    heights = jnp.asarray([11000.0 - 1e-6, 11000.0 + 1e-6])
    below, above = jax.vmap(lambda h: jnp.stack([isa(h).pressure, jax.jacfwd(lambda z: isa(z).pressure)(h)]))(heights)
    np.testing.assert_allclose(below, above, rtol=1e-8)


@pytest.mark.parametrize("altitude", [6.096, 13.0])
def test_derivatives(check_derivatives, altitude):
    scale = jnp.asarray([300.0, 1e5, 1.0, 300.0, 1e-5])
    check_derivatives(lambda x: jnp.stack(isa(1000.0 * x[0])) / scale, [altitude])
