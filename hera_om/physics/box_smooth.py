"""Smooth stand-ins for max, min, |x| and the positive part, with their sharpness and error stated."""

import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float

ArrayLike = Float[Array, "..."] | float | int

# Exponent of the p-norms below. m equal entries raise the maximum by m^(1/p): 0.35 % for two, 1.2 % for ten;
# entries 5 % apart by 3e-7. `tests/physics/test_wingbox.py` states the error in kg of wing.
SHARPNESS = 200.0
# Where a utilisation falls below this it is as good as zero; the logarithm stays finite.
FLOOR = 1e-9


def log_smooth_max(
    values: Float[Array, "..."], axis: int | tuple[int, ...], sharpness: ArrayLike = SHARPNESS
) -> Float[Array, "..."]:
    """Logarithm of `smooth_max`, scaled against overflow."""
    logs = jnp.log(values + FLOOR)
    peak = lax.stop_gradient(jnp.max(logs, axis=axis, keepdims=True))
    total = jnp.sum(jnp.exp(sharpness * (logs - peak)), axis=axis)
    return jnp.squeeze(peak, axis=axis) + jnp.log(total) / sharpness


def smooth_max(
    values: Float[Array, "..."], axis: int | tuple[int, ...], sharpness: ArrayLike = SHARPNESS
) -> Float[Array, "..."]:
    """Maximum of positive numbers as their p-norm, (sum v^p)^(1/p).

    Source: the Kreisselmeier-Steinhauser function of log v (Kreisselmeier and Steinhauser, IFAC 1979), which
    makes the error relative. Never below the true maximum, and above it at most by the factor m^(1/p).

    Args:
        values: non-negative numbers of order one (utilisations), any shape.
        axis: axes to reduce.
        sharpness: the exponent p.

    Returns:
        The maximum along ``axis``, not below ``FLOOR``.
    """
    return jnp.exp(log_smooth_max(values, axis, sharpness))


def positive_part(x: ArrayLike, width: ArrayLike) -> Float[Array, "..."]:
    """Smooth max(x, 0) = (x + sqrt(x^2 + w^2)) / 2: too large by w / 2 at 0, by w^2 / (4 x) far off."""
    return 0.5 * (x + jnp.sqrt(jnp.square(x) + jnp.square(width)))


def smooth_below(x: ArrayLike, cap: ArrayLike, width: ArrayLike) -> Float[Array, "..."]:
    """Smooth min(x, cap), too small by w / 2 where the two meet."""
    return x - positive_part(x - cap, width)
