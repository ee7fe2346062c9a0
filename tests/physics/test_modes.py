"""Modes against published eigenvalues, against constructed matrices, and where pairs of roots turn real."""

import tomllib

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics.modes import (
    characteristic_polynomial,
    lateral_modes,
    longitudinal_modes,
    second_order_mode,
)

LONGITUDINAL = ["b747_etkin_long", "navion_nelson_long", "a7a_cook_long", "f4c_cook_long"]
LATERAL = ["b747_etkin_lat", "navion_nelson_lat"]
# A fixed well-conditioned change of state, so that matrices are full
MIX = np.asarray([[1.0, 0.3, -0.2, 0.1], [0.2, 1.1, 0.4, 0.0], [-0.3, 0.1, 0.9, 0.2], [0.1, -0.2, 0.3, 1.2]])


def load(reference, name):
    case = tomllib.loads((reference / f"fd_{name}.toml").read_text())
    return jnp.asarray(case["A"]), case["eigenvalue"]


def with_roots(factors):
    """Full matrix with the roots of the quadratic factors (two zeta omega, omega^2)."""
    blocks = jnp.zeros((4, 4))
    for i, (n, x) in zip((0, 2), factors, strict=True):
        blocks = blocks.at[i : i + 2, i : i + 2].set(
            jnp.stack([jnp.stack([0.0 * x, 1.0 + 0.0 * x]), jnp.stack([-x, -n])])
        )
    return jnp.asarray(MIX) @ blocks @ jnp.asarray(np.linalg.inv(MIX))


longitudinal = jax.jit(longitudinal_modes)
lateral = jax.jit(lateral_modes)


@pytest.mark.parametrize("name", LONGITUDINAL)
def test_published_longitudinal_modes(reference, name):
    matrix, roots = load(reference, name)
    modes = longitudinal(matrix)
    fast, slow = sorted(roots, key=lambda root: -root["wn"])
    for mode, root in ((modes.short_period, fast), (modes.phugoid, slow)):
        # the files print six to seven digits
        np.testing.assert_allclose([mode.omega, mode.zeta], [root["wn"], root["zeta"]], rtol=5e-6)
        np.testing.assert_allclose(-mode.two_zeta_omega / 2.0, root["re"], rtol=5e-6)


@pytest.mark.parametrize("name", LATERAL)
def test_published_lateral_modes(reference, name):
    matrix, roots = load(reference, name)
    modes = lateral(matrix)
    (dutch,) = [root for root in roots if root["im"] != 0]
    roll, spiral = sorted(root["re"] for root in roots if root["im"] == 0)
    np.testing.assert_allclose([modes.dutch_roll.omega, modes.dutch_roll.zeta], [dutch["wn"], dutch["zeta"]], rtol=5e-6)
    np.testing.assert_allclose([modes.roll_root, modes.spiral_root], [roll, spiral], rtol=5e-6)
    np.testing.assert_allclose([modes.tau_roll, modes.t2_spiral], [-1 / roll, np.log(2) / spiral], rtol=5e-6)


@given(st.lists(st.floats(-3.0, 3.0), min_size=16, max_size=16))
def test_characteristic_polynomial(entries):
    matrix = np.asarray(entries).reshape(4, 4)
    # numpy forms it from eigenvalues
    np.testing.assert_allclose(characteristic_polynomial(jnp.asarray(matrix)), np.poly(matrix)[1:], atol=1e-8)


@given(st.floats(1.0, 4.0), st.floats(0.05, 2.5), st.floats(0.03, 0.2), st.floats(-0.5, 0.9))
def test_constructed_modes_come_back(omega_sp, zeta_sp, omega_ph, zeta_ph):
    # an overdamped short period has a slow root near the phugoid's frequency: the pairs must still be kept
    fast, slow = (2 * zeta_sp * omega_sp, omega_sp**2), (2 * zeta_ph * omega_ph, omega_ph**2)
    modes = longitudinal(with_roots(jnp.asarray([fast, slow])))
    np.testing.assert_allclose([modes.short_period.two_zeta_omega, modes.short_period.omega_sq], fast, rtol=1e-8)
    np.testing.assert_allclose([modes.phugoid.two_zeta_omega, modes.phugoid.omega_sq], slow, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(modes.short_period.zeta, zeta_sp, rtol=1e-6)


def test_complex_pair_stays_together_between_two_real_roots():
    # beyond the static limit: roots -2 and +0.3 with an oscillation of 0.9 rad/s between them
    modes = longitudinal(with_roots(jnp.asarray([(1.7, -0.6), (0.2, 0.81)])))
    np.testing.assert_allclose([modes.short_period.two_zeta_omega, modes.short_period.omega_sq], [1.7, -0.6], rtol=1e-9)
    np.testing.assert_allclose([modes.phugoid.two_zeta_omega, modes.phugoid.omega_sq], [0.2, 0.81], rtol=1e-9)
    assert modes.short_period.omega < 0.0


def test_lateral_order_of_roots():
    # roll faster and roll slower than the Dutch roll; A[1, 1] of the mixed matrix plays the roll damping
    for roll in (-4.0, -0.5):
        blocks = np.zeros((4, 4))
        blocks[1, 1], blocks[3, 3] = roll, 0.02
        blocks[np.ix_([0, 2], [0, 2])] = [[-0.1, -1.5], [1.0, -0.1]]
        modes = lateral(jnp.asarray(blocks))
        np.testing.assert_allclose([modes.roll_root, modes.spiral_root], [roll, 0.02], rtol=1e-9)
        np.testing.assert_allclose(modes.dutch_roll.omega_sq, 1.51, rtol=1e-9)
        np.testing.assert_allclose(modes.t2_spiral, np.log(2.0) / 0.02, rtol=1e-9)


def test_coupled_roll_and_spiral_give_their_real_part():
    blocks = np.zeros((4, 4))
    blocks[np.ix_([0, 2], [0, 2])] = [[-0.2, -2.0], [2.0, -0.2]]
    blocks[np.ix_([1, 3], [1, 3])] = [[-0.3, -0.2], [0.2, -0.3]]
    modes = lateral(jnp.asarray(blocks))
    np.testing.assert_allclose([modes.roll_root, modes.spiral_root], [-0.3, -0.3], rtol=1e-6)
    np.testing.assert_allclose(modes.dutch_roll.omega_sq, 4.04, rtol=1e-9)


def test_neutral_spiral_is_finite():
    blocks = np.diag([0.0, -1.0, 0.0, 0.0])
    blocks[np.ix_([0, 2], [0, 2])] = [[-0.1, -1.5], [1.0, -0.1]]
    assert all(np.isfinite(leaf) for leaf in jax.tree.leaves(lateral(jnp.asarray(blocks))))


@pytest.mark.parametrize("x", [4.0, 1e-2, -1e-2, -4.0])
def test_signed_root(x):
    mode = second_order_mode(0.5, x)
    np.testing.assert_allclose(mode.omega, np.sign(x) * np.sqrt(abs(x)), rtol=1e-8)
    np.testing.assert_allclose(mode.zeta, 0.5 / (2.0 * np.sqrt(abs(x))), rtol=1e-8)


def test_signed_root_is_finite_and_rising_at_zero():
    value, slope = jax.value_and_grad(lambda x: second_order_mode(0.5, x).omega)(0.0)
    assert value == 0.0 and np.isfinite(slope) and slope > 0.0
    assert np.isfinite(jax.grad(jax.grad(lambda x: second_order_mode(0.5, x).zeta))(0.0))


def test_nan_goes_through():
    assert np.isnan(longitudinal(jnp.full((4, 4), jnp.nan)).short_period.omega)


# critical damping exactly (a double root), an overdamped and a divergent short period
@pytest.mark.parametrize("short_period", [(2.0, 1.0), (3.0, 1.0), (1.7, -0.6)])
def test_derivatives_where_a_pair_turns_real(check_derivatives, short_period):
    def outputs(x):
        modes = longitudinal_modes(with_roots([(x[0], x[1]), (x[2], x[3])]))
        return jnp.stack([*modes.short_period, *modes.phugoid])

    point = [*short_period, 0.02, 0.04]
    check_derivatives(outputs, point)
    # the coefficients of the factors are the very inputs: an exact Jacobian
    jacobian = jax.jacfwd(lambda x: outputs(x)[jnp.asarray([0, 1, 4, 5])])(jnp.asarray(point))
    np.testing.assert_allclose(jacobian, np.eye(4), atol=1e-7)


def test_vectorised(reference):
    matrices = jnp.stack([load(reference, name)[0] for name in LONGITUDINAL])
    together = jax.jit(jax.vmap(longitudinal_modes))(matrices)
    np.testing.assert_allclose(
        together.short_period.omega, [longitudinal(m).short_period.omega for m in matrices], rtol=1e-12
    )
