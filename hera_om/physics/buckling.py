"""Stability and strength of plates, columns and thin sections in closed form.

Every function is elementwise: arguments broadcast against each other. Stresses in Pa, lengths in m.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

ArrayLike = Float[Array, "..."] | float | int

# Timoshenko & Gere, Theory of Elastic Stability 2e, ch. 9.
K_BENDING_SSSS = 23.9  # in-plane bending, simply supported, a/b >= 0.67 (table 9-6)
HALF_WAVES = 8  # half waves looked at: enough for a/b up to 8.5, where k is within 0.4 % of 4
K_SHARPNESS = 400.0  # p-norm of the envelopes: at a cusp, where two curves meet, k is 0.17 % off

# Orthotropic plates in shear over beta: the infinite strip 5.34 (1 + 0.55 (beta - 1))^0.61 within 0.3 %, and what a
# square plate adds, 4 + 2.5 (beta - 1) + 0.15 (beta - 1)^2. Fits to the Galerkin solution with sines, beta 0.1 to 3.
SHEAR_LONG = (0.55, 0.61)
SHEAR_SHORT = (2.5, 0.15)

# Gerard, Handbook of Structural Stability part IV, NACA TN 3784, for two-corner sections (Z, J, channel),
# in the form and with the cut-off of Bruhn, Analysis and Design of Flight Vehicle Structures, eq. C7.6 and
# table C7.1.
GERARD_FACTOR = 3.2
GERARD_EXPONENT = 0.75
GERARD_CUT_OFF = 0.9
# Needham, The Ultimate Strength of Aluminum-Alloy Formed Structural Shapes in Compression (1954): angle with both
# edges free, in the form of Bruhn, eq. C7.1.
NEEDHAM_FACTOR, NEEDHAM_EXPONENT = 0.316, 0.75
# Width of sheet that works with a stringer, two edges, von Karman-Sechler: Bruhn eq. C7.19 (w = 1.9 t
# sqrt(E/F)).
EFFECTIVE_WIDTH = 1.9

# Keeps the square roots differentiable at zero stress; shifts a ratio of order one by less than 1e-12.
_TINY = 1e-12


def _norm(values: Float[Array, "m ..."], power: float) -> Float[Array, "..."]:
    """p-norm along the first axis, scaled against overflow."""
    peak = jnp.max(jnp.abs(values), axis=0)
    return peak * jnp.sum((values / peak) ** power, axis=0) ** (1.0 / power)


def k_compression(a_over_b: ArrayLike, beta: ArrayLike = 1.0) -> Float[Array, "..."]:
    """Buckling coefficient of a simply supported plate compressed along its side a.

    k = min over m of (m / phi + phi / m)^2 + 2 (beta - 1), phi = a / b. Timoshenko & Gere 2e, eq. 9-7 (d). The
    cusps between two numbers of half waves are rounded, 0.17 % on the low side.

    Args:
        a_over_b: length along the load over loaded width, 0.1 to 8.5.
        beta: 1 for isotropic plates; of orthotropic ones see `laminate.compression_stress`.

    Returns:
        k, to be used with `plate_stress`.
    """
    phi = jnp.asarray(a_over_b)
    m = jnp.arange(1.0, HALF_WAVES + 1.0).reshape((-1,) + (1,) * phi.ndim)
    return 1.0 / _norm(((m / phi + phi / m) ** 2 + 2.0 * (beta - 1.0)) ** -1, K_SHARPNESS)


def k_shear(a_over_b: ArrayLike, beta: ArrayLike = 1.0) -> Float[Array, "..."]:
    """Buckling coefficient in shear, simply supported, referred to the side b whichever is shorter.

    k = 5.34 + 4 (b/a)^2 for a > b, and 4 + 5.34 (b/a)^2 else: the larger of the two. Timoshenko & Gere 2e,
    art. 9.7. The kink at a = b is rounded, 0.17 % on the high side, inside the 1 % of the fit itself.

    Args:
        a_over_b: side a over side b.
        beta: 1 for isotropic plates; of orthotropic ones see `laminate.shear_stress`, by ``SHEAR_LONG`` and
            ``SHEAR_SHORT``.
    """
    inverse_square = 1.0 / jnp.square(jnp.asarray(a_over_b))
    rate, power = SHEAR_LONG
    long = 5.34 * (1.0 + rate * (beta - 1.0)) ** power
    # Above beta = 2.4 a square plate adds more than the strip has: the larger of the two would be the wrong one.
    short = jnp.minimum(4.0 + SHEAR_SHORT[0] * (beta - 1.0) + SHEAR_SHORT[1] * (beta - 1.0) ** 2, long)
    return _norm(jnp.stack([long + short * inverse_square, short + long * inverse_square]), K_SHARPNESS)


def plate_stress(
    k: ArrayLike, t: ArrayLike, b: ArrayLike, *, modulus: ArrayLike, poisson: ArrayLike
) -> Float[Array, "..."]:
    """Critical stress k pi^2 E / (12 (1 - nu^2)) (t / b)^2 of a plate. Timoshenko & Gere 2e, 9-7."""
    flexural = jnp.pi**2 * modulus / (12.0 * (1.0 - jnp.square(poisson)))
    return k * flexural * jnp.square(t / b)


def use_compression_shear(r_c: ArrayLike, r_s: ArrayLike) -> Float[Array, "..."]:
    """Utilisation of a plate under compression and shear: 1 / RF of R_c + R_s^2 = 1.

    RF = 2 / (R_c + sqrt(R_c^2 + 4 R_s^2)). NACA TN 1223; Bruhn C5.

    Args:
        r_c: compressive stress over its critical value, not negative.
        r_s: shear stress over its critical value, either sign.

    Returns:
        1 / RF.
    """
    return 0.5 * (r_c + jnp.sqrt(jnp.square(r_c) + 4.0 * jnp.square(r_s) + _TINY))


def use_bending_shear(r_b: ArrayLike, r_s: ArrayLike) -> Float[Array, "..."]:
    """Utilisation of a web under in-plane bending and shear: 1 / RF of R_b^2 + R_s^2 = 1. Bruhn C5."""
    return jnp.sqrt(jnp.square(r_b) + jnp.square(r_s) + _TINY)


def von_mises(sigma_x: ArrayLike, sigma_y: ArrayLike, tau: ArrayLike) -> Float[Array, "..."]:
    """Equivalent stress sqrt(sx^2 + sy^2 - sx sy + 3 t^2) of plane stress (1e-6 at zero stress)."""
    square = jnp.square(sigma_x) + jnp.square(sigma_y) - sigma_x * sigma_y + 3.0 * jnp.square(tau)
    return jnp.sqrt(square + _TINY)


def euler_load(stiffness: ArrayLike, length: ArrayLike) -> Float[Array, "..."]:
    """Critical load pi^2 E I / L^2 of a pinned column, N; stiffness E I in N m2."""
    return jnp.pi**2 * stiffness / jnp.square(length)


def crippling_stress(area_over_t2: ArrayLike, *, modulus: ArrayLike, f_cy: ArrayLike) -> Float[Array, "..."]:
    """Crippling stress of a formed two-corner section (Z, J, channel).

    F_cc = F_cy min(0.9, 3.2 ((t^2 / A) (E / F_cy)^(1/3))^0.75). Gerard, NACA TN 3784, as Bruhn eq. C7.6.

    Args:
        area_over_t2: section area over the square of its sheet thickness.
        modulus: Young's modulus, Pa.
        f_cy: yield stress in compression, Pa.

    Returns:
        F_cc, Pa. The fit is good to about 5 %.
    """
    ratio = GERARD_FACTOR * (jnp.cbrt(modulus / f_cy) / area_over_t2) ** GERARD_EXPONENT
    return f_cy * jnp.minimum(GERARD_CUT_OFF, ratio)


def angle_crippling_stress(width_over_t: ArrayLike, *, modulus: ArrayLike, f_cy: ArrayLike) -> Float[Array, "..."]:
    """Crippling stress of an angle of equal legs, both edges free.

    F_cc = min(F_cy, 0.316 sqrt(F_cy E) / (b' / t)^0.75), b' the mean of both legs. Needham, as Bruhn eq. C7.1.

    Args:
        width_over_t: width of a leg over its thickness.
        modulus: Young's modulus, Pa.
        f_cy: yield stress in compression, Pa.

    Returns:
        F_cc, Pa.
    """
    stress = NEEDHAM_FACTOR * jnp.sqrt(jnp.asarray(modulus * f_cy)) / width_over_t**NEEDHAM_EXPONENT
    return jnp.minimum(jnp.asarray(f_cy), stress)


def johnson_euler_stress(slenderness: ArrayLike, f_cc: ArrayLike, *, modulus: ArrayLike) -> Float[Array, "..."]:
    """Failing stress of a pinned column whose section cripples at f_cc.

    F = f_cc (1 - f_cc (L/r)^2 / (4 pi^2 E)) down to f_cc / 2, Euler's pi^2 E / (L/r)^2 below. Bruhn eq.
    C7.26. The two meet with equal value and slope at L/r = pi sqrt(2 E / f_cc); the second derivative jumps
    there.

    Args:
        slenderness: effective length over radius of gyration.
        f_cc: crippling stress, Pa.
        modulus: Young's modulus, Pa.

    Returns:
        F, Pa.
    """
    euler = jnp.pi**2 * modulus / jnp.square(slenderness)
    johnson = f_cc * (1.0 - f_cc / (4.0 * euler))
    return jnp.where(euler > 0.5 * f_cc, johnson, euler)


def effective_width(t: ArrayLike, stress: ArrayLike, *, modulus: ArrayLike) -> Float[Array, "..."]:
    """Width of sheet 1.9 t sqrt(E / F) that carries the stress F beside a stringer. Bruhn eq. C7.19."""
    return EFFECTIVE_WIDTH * t * jnp.sqrt(modulus / stress)


def brazier_pressure(
    stress: ArrayLike, t_smeared: ArrayLike, height: ArrayLike, *, modulus: ArrayLike
) -> Float[Array, "..."]:
    """Crushing pressure 2 s^2 t / (E h) on the covers of a box in bending.

    The cover load s t per width, turned by the curvature 2 s / (E h). Brazier 1927; Niu, Airframe Structural
    Design, on crushing loads of ribs.

    Args:
        stress: direct stress of the cover, Pa.
        t_smeared: cover thickness with the stringers spread out, m.
        height: distance between the covers, m.
        modulus: Young's modulus, Pa.

    Returns:
        Pressure towards the neutral axis, Pa.
    """
    return 2.0 * jnp.square(stress) * t_smeared / (modulus * height)
