"""Modes of linearised flight as smooth functions of the state matrix.

Eigenvalues of a general real matrix have no second derivative in JAX and none at all where a pair turns real.
The real quadratic factors of the characteristic polynomial, ``s^2 + 2 zeta omega s + omega^2``, have both.
The eigenvalues are used only to find the factors, under ``stop_gradient``; two Newton steps then carry exact
first and second derivatives.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Complex, Float

ScalarLike = Float[Array, ""] | float | int

# Numerical constants, not physical ones. omega^2 below which a root is rounded off, (rad/s)^2: changes omega
# by less than 1e-8 of itself for every period under 1.5 min.
ROOT_ROUNDING = 1e-6
# Rounding of the discriminant of the roll-spiral factor, (rad/s)^2, and of the spiral root, rad/s.
DISCRIMINANT_ROUNDING = 1e-8
SPIRAL_ROUNDING = 1e-9
# A pair of eigenvalues is taken as a real factor when its sum and product are real to this share of the
# largest.
REAL_PAIR_TOLERANCE = 1e-6
# The ways to split four eigenvalues into a first and a second pair.
SPLITTINGS = ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (2, 3, 0, 1), (1, 3, 0, 2), (1, 2, 0, 3))


class Mode(NamedTuple):
    """One quadratic factor ``s^2 + 2 zeta omega s + omega^2``.

    ``two_zeta_omega`` (1/s) and ``omega_sq`` (rad2/s2) are exact for any pair of roots. ``omega`` is the
    signed root of ``omega_sq``: negative means that one real root is unstable (static divergence). ``zeta``
    is damping over twice ``|omega|``, above 1 for two stable real roots.
    """

    two_zeta_omega: Float[Array, ""]
    omega_sq: Float[Array, ""]
    omega: Float[Array, ""]
    zeta: Float[Array, ""]


class LongitudinalModes(NamedTuple):
    """Short period and phugoid."""

    short_period: Mode
    phugoid: Mode


class LateralModes(NamedTuple):
    """Dutch roll; roots of roll and spiral in 1/s; roll time constant and time to double of the spiral in s.

    ``t2_spiral`` is ln 2 over the spiral root: negative for a stable spiral (then minus the time to half).
    """

    dutch_roll: Mode
    roll_root: Float[Array, ""]
    spiral_root: Float[Array, ""]
    tau_roll: Float[Array, ""]
    t2_spiral: Float[Array, ""]


def second_order_mode(two_zeta_omega: ScalarLike, omega_sq: ScalarLike) -> Mode:
    """Frequency and damping of a quadratic factor, finite and smooth through ``omega_sq = 0``.

    ``omega = x / (x^2 + eps^2)^(1/4)`` and ``zeta = n / (2 (x^2 + eps^2)^(1/4))`` with ``x = omega_sq``,
    ``n = two_zeta_omega``, eps = 1e-6 rad2/s2: the usual square root for positive x, its mirror image
    ``-sqrt(-x)`` for negative x.

    Source: definition of natural frequency and damping ratio; the rounding is ours.

    Args:
        two_zeta_omega: coefficient of s, 1/s.
        omega_sq: constant coefficient, rad2/s2.

    Returns:
        The mode. Relative error of omega and zeta for positive x: (eps / 2x)^2.

    Valid for all finite arguments.
    """
    x = jnp.asarray(omega_sq, dtype=float)
    n = jnp.asarray(two_zeta_omega, dtype=float)
    magnitude = (x**2 + ROOT_ROUNDING**2) ** 0.25
    return Mode(two_zeta_omega=n, omega_sq=x, omega=x / magnitude, zeta=n / (2.0 * magnitude))


def characteristic_polynomial(matrix: Float[Array, "4 4"]) -> Float[Array, "4"]:
    """Coefficients a3, a2, a1, a0 of ``det(s 1 - A) = s^4 + a3 s^3 + a2 s^2 + a1 s + a0``.

    Source: Faddeev-LeVerrier recursion, Gantmacher, The Theory of Matrices, volume 1, chapter IV, section 5.

    Args:
        matrix: state matrix.

    Returns:
        The four coefficients, highest power first.

    Valid for any matrix; a0 is lost to rounding when it is below about 1e-14 of the largest products of
    entries.
    """
    auxiliary = jnp.eye(4)
    coefficients = []
    for order in range(1, 5):
        product = matrix @ auxiliary
        coefficients.append(-jnp.trace(product) / order)
        auxiliary = product + coefficients[-1] * jnp.eye(4)
    return jnp.stack(coefficients)


def _factor_residual(factors: Float[Array, "4"], polynomial: Float[Array, "4"]) -> Float[Array, "4"]:
    """Product of ``s^2 + f0 s + f1`` and ``s^2 + f2 s + f3`` less the polynomial."""
    p1, p0, r1, r0 = factors
    return jnp.stack([p1 + r1, p0 + r0 + p1 * r1, p1 * r0 + p0 * r1, p0 * r0]) - polynomial


def _newton_step(factors: Float[Array, "4"], polynomial: Float[Array, "4"]) -> Float[Array, "4"]:
    """One step of Bairstow's method on both factors at once."""
    p1, p0, r1, r0 = factors
    zero, one = jnp.zeros_like(p1), jnp.ones_like(p1)
    jacobian = jnp.stack(
        [
            jnp.stack([one, zero, one, zero]),
            jnp.stack([r1, one, p1, one]),
            jnp.stack([r0, r1, p0, p1]),
            jnp.stack([zero, r0, zero, p0]),
        ]
    )
    return factors - jnp.linalg.solve(jacobian, _factor_residual(factors, polynomial))


def _refine(polynomial: Float[Array, "4"], guess: Float[Array, "4"]) -> Float[Array, "4"]:
    """Two differentiable Newton steps from a converged guess: exact to second order in the polynomial."""
    return _newton_step(_newton_step(jax.lax.stop_gradient(guess), polynomial), polynomial)


def _pair_factor(first: Complex[Array, " n"], second: Complex[Array, " n"]) -> Complex[Array, "n 2"]:
    """Coefficients of ``(s - first)(s - second)``, real only for a conjugate or a real pair."""
    return jnp.stack([-(first + second), first * second], axis=-1)


def _split(matrix: Float[Array, "4 4"], cost) -> Float[Array, "4"]:
    """Factors of the splitting of the eigenvalues that is real and has the least cost.

    ``cost(first, second, largest)`` gets the pairs divided by the magnitude of the largest eigenvalue.
    """
    eigenvalues = jnp.linalg.eigvals(jax.lax.stop_gradient(matrix))
    pairs = eigenvalues[jnp.asarray(SPLITTINGS)].reshape(6, 2, 2)
    factors = jnp.concatenate([_pair_factor(*pairs[:, 0].T), _pair_factor(*pairs[:, 1].T)], axis=1)
    largest = jnp.max(jnp.abs(eigenvalues))
    scale = jnp.stack([largest, largest**2, largest, largest**2])
    unreal = jnp.max(jnp.abs(factors.imag) / scale, axis=1) > REAL_PAIR_TOLERANCE
    penalty = jnp.where(unreal, jnp.inf, cost(pairs[:, 0] / largest, pairs[:, 1] / largest, largest))
    return factors.real[jnp.argmin(penalty)]


def _fast_first(
    first: Complex[Array, "6 2"], second: Complex[Array, "6 2"], largest: Float[Array, ""]
) -> Float[Array, "6"]:
    """Cost that puts the fastest root into the first pair, and the next fastest beside it where it may be."""
    del second, largest
    magnitude = jnp.abs(first)
    return -10.0 * jnp.max(magnitude, axis=1) - jnp.min(magnitude, axis=1)


def longitudinal_modes(matrix: Float[Array, "4 4"]) -> LongitudinalModes:
    """Short period and phugoid of a longitudinal state matrix.

    The characteristic polynomial is split into two real quadratic factors. The short period is the factor
    with the fastest root. Where all four roots are real it takes the two fastest; a complex pair always stays
    together, so that beyond the static limit the slow pair is the third oscillatory mode.

    Source: Etkin and Reid, Dynamics of Flight (3rd edition), section 6.2; factors by Bairstow's method.

    Args:
        matrix: state matrix of (u, w, q, theta) in any order and scaling.

    Returns:
        Both modes; first and second derivatives are exact.

    Valid where the factors share no root; they change partners, with a jump, only where the roots do.
    """
    factors = _refine(characteristic_polynomial(matrix), _split(matrix, _fast_first))
    return LongitudinalModes(second_order_mode(*factors[:2]), second_order_mode(*factors[2:]))


def lateral_modes(matrix: Float[Array, "4 4"]) -> LateralModes:
    """Dutch roll, roll and spiral of a lateral state matrix.

    The roll-spiral factor is the real one whose faster root is nearest to the roll damping ``A[1, 1]`` and
    whose slower root is nearest to zero; the Dutch roll is the other. From ``s^2 + n s + x`` the roots are
    ``-n/2 -+ sqrt(n^2/4 - x)``; where roll and spiral couple into an oscillation both give its real part.

    Source: Etkin and Reid, Dynamics of Flight (3rd edition), section 6.7; factors by Bairstow's method.

    Args:
        matrix: state matrix of (v or beta, p, r, phi), in this order.

    Returns:
        Dutch roll, roots and times; first and second derivatives are exact.

    Valid where the factors share no root. The discriminant is rounded by 1e-8 (rad/s)^2 where it passes zero,
    the time to double by 1e-9 rad/s where the spiral is neutral, so that both stay finite.
    """
    roll_damping = jax.lax.stop_gradient(matrix[1, 1])

    def cost(first, second, largest):
        dutch_roll_real = jnp.all(jnp.abs(first.imag) <= REAL_PAIR_TOLERANCE, axis=1)
        coupled = jnp.any(jnp.abs(second.imag) > REAL_PAIR_TOLERANCE, axis=1)
        order = jnp.argsort(jnp.abs(second), axis=1)
        slow, fast = jnp.take_along_axis(second, order, axis=1).T
        return 100.0 * (dutch_roll_real & coupled) + jnp.abs(fast - roll_damping / largest) + jnp.abs(slow)

    factors = _refine(characteristic_polynomial(matrix), _split(matrix, cost))
    half, product = factors[2] / 2.0, factors[3]
    discriminant = half**2 - product
    spread = jnp.sqrt((discriminant + jnp.sqrt(discriminant**2 + DISCRIMINANT_ROUNDING**2)) / 2.0)
    roll, spiral = -half - spread, -half + spread
    return LateralModes(
        dutch_roll=second_order_mode(factors[0], factors[1]),
        roll_root=roll,
        spiral_root=spiral,
        tau_roll=-1.0 / roll,
        t2_spiral=jnp.log(2.0) * spiral / (spiral**2 + SPIRAL_ROUNDING**2),
    )
