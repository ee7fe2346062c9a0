"""Beam elements against closed forms: deflections of uniform and tapered cantilevers, frequencies, coupled modes."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.beam import BeamProperties, deflection, modes, torsion_share

LENGTH, EI, GJ, MASS, INERTIA = 12.0, 3.0e7, 2.0e7, 90.0, 25.0


def beam(n, taper=0.0, **changes):
    """Stiffness falls linearly to (1 - taper) at the tip."""
    s = jnp.linspace(0.0, LENGTH, n)
    fall, one = 1.0 - taper * s / LENGTH, jnp.ones(n)
    given = dict(EI=EI * fall, GJ=GJ * fall, mass=MASS * one, static_moment=0.0 * one, inertia=INERTIA * one)
    return BeamProperties(s, **(given | changes))


def test_uniform_load_and_tip_torque():
    """w = q s^2 (6 L^2 - 4 L s + s^2) / (24 EI), theta = T s / GJ; q L^4 / (8 EI) at the tip."""
    b, q = beam(5), 800.0
    arm = LENGTH - b.s
    found = deflection(b, shear=q * arm, bending=q * arm**2 / 2, torque=jnp.full(5, 4.0e3))
    exact = q * b.s**2 * (6 * LENGTH**2 - 4 * LENGTH * b.s + b.s**2) / (24 * EI)
    np.testing.assert_allclose(found.w, exact, rtol=1e-12, atol=1e-15)
    assert float(found.w[-1]) == pytest.approx(q * LENGTH**4 / (8 * EI), rel=1e-12)
    np.testing.assert_allclose(found.twist, 4.0e3 * b.s / GJ, rtol=1e-12)


def test_tapered_cantilever_with_tip_load():
    """EI = EI_0 (1 - k s/L): w_tip = P L^3 / (EI_0 k^3) ((k - 1)^2 ln(1 / (1 - k)) + k (3 k - 2) / 2)."""
    k, load, torque = 0.7, 5.0e3, 3.0e3
    b = beam(24, taper=k)
    arm = LENGTH - b.s
    found = deflection(b, shear=jnp.full(24, load), bending=load * arm, torque=jnp.full(24, torque))
    tip = load * LENGTH**3 / (EI * k**3) * ((1 - k) ** 2 * np.log(1 / (1 - k)) + k * (3 * k - 2) / 2)
    assert float(found.w[-1]) == pytest.approx(tip, rel=1e-6)
    assert float(found.twist[-1]) == pytest.approx(torque * LENGTH / GJ / k * np.log(1 / (1 - k)), rel=1e-6)


def test_frequencies_of_a_uniform_cantilever():
    """Bending: (beta L)^2 sqrt(EI / m L^4), beta L = 1.875104, 4.694091; torsion: pi / 2 sqrt(GJ / I L^2)."""
    b = beam(25)
    found = modes(b, 3)
    share = np.asarray(torsion_share(b, found))
    bending = np.asarray(found.omega)[share < 0.5]
    exact = np.array([1.8751040687, 4.6940911330]) ** 2 * np.sqrt(EI / (MASS * LENGTH**4))
    np.testing.assert_allclose(bending[:2], exact[: len(bending[:2])], rtol=2e-6)
    torsion = np.asarray(modes(b, 6).omega)[np.asarray(torsion_share(b, modes(b, 6))) > 0.5][0]
    assert torsion == pytest.approx(np.pi / 2 * np.sqrt(GJ / (INERTIA * LENGTH**2)), rel=2e-4)
    np.testing.assert_allclose(np.minimum(share, 1 - share), 0.0, atol=1e-6)


def test_torsion_frequency_converges_with_the_square_of_the_element():
    exact = np.pi / 2 * np.sqrt(GJ / (INERTIA * LENGTH**2))

    def error(n):
        b = beam(n)
        found = modes(b, 8)
        return float(np.asarray(found.omega)[np.asarray(torsion_share(b, found)) > 0.5][0]) / exact - 1

    coarse, fine = error(9), error(17)
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.05)
    assert (4 * fine - coarse) / 3 == pytest.approx(0.0, abs=1e-6)  # extrapolated


def test_offset_of_the_mass_couples_bending_and_torsion():
    """Mass off the axis mixes the modes, lowers the lowest, and leaves Rayleigh's quotient of the shapes exact."""
    coupled = beam(20, static_moment=jnp.full(20, 0.3 * MASS))
    plain, mixed = modes(beam(20), 4), modes(coupled, 4)
    share = np.asarray(torsion_share(coupled, mixed))
    assert np.all((share[:2] > 1e-4) & (share[:2] < 1 - 1e-4))
    assert float(mixed.omega[0]) < float(plain.omega[0])  # coupling moves the lowest down
    rate = np.diff(np.asarray(mixed.shape[0, 2])) / np.diff(np.asarray(coupled.s))
    assert GJ * np.sum(rate**2 * np.diff(np.asarray(coupled.s))) == pytest.approx(
        share[0] * float(mixed.omega[0]) ** 2, rel=1e-9
    )


def test_lumps_far_off_the_axis_leave_the_mass_positive():
    """A heavy pod ahead of a light wing: frequencies stay finite whatever the neighbours of the lump."""
    mass = jnp.full(12, 0.1).at[4].set(600.0)
    moment = jnp.zeros(12).at[4].set(-1200.0).at[5].set(-2.0)
    heavy = beam(12, mass=mass, static_moment=moment, inertia=moment**2 / mass + 0.3 * mass)
    assert bool(jnp.all(jnp.isfinite(modes(heavy, 4).omega)))


def test_derivatives(check_derivatives):
    def outputs(p):
        b = beam(6)
        b = b._replace(EI=b.EI * p[0], GJ=b.GJ * p[1], mass=b.mass * p[2], static_moment=0.2 * MASS * p[3] + 0 * b.s)
        arm = LENGTH - b.s
        bent = deflection(b, shear=1e3 * arm, bending=500.0 * arm**2, torque=300.0 * arm)
        return jnp.concatenate([modes(b, 2).omega / 20.0, bent.w, bent.twist * 20.0])

    check_derivatives(outputs, [1.0, 1.1, 0.9, 1.05])
