"""Bracketed search for the roots of many equations at once."""

from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float

Values = Float[Array, "..."]

ROOT_TOLERANCE, RESIDUAL_TOLERANCE = 1e-5, 1e-6
"""Bracket width, or residual, at which the search stops; of the two Newton steps after it, with one slope, the first
squares the error and the second multiplies it by that of the slope."""
ROOT_ITERATIONS = 80
FIRST_STEP = 0.1
"""First trial as a distance from the centre, rad: the induced angle of a loaded propeller is of this size."""


class _Search(NamedTuple):
    """State of Chandrupatla's search: newest point 1, other end 2 of the bracket, previous point 3."""

    x1: Values
    x2: Values
    x3: Values
    f1: Values
    f2: Values
    f3: Values
    t: Values
    iteration: Float[Array, ""]


def _unfinished(s: _Search) -> Bool[Array, ""]:
    wide = jnp.abs(s.x2 - s.x1) > ROOT_TOLERANCE
    wrong = jnp.minimum(jnp.abs(s.f1), jnp.abs(s.f2)) > RESIDUAL_TOLERANCE
    return jnp.any(wide & wrong) & (s.iteration < ROOT_ITERATIONS)


def _interpolation(s: _Search) -> Values:
    """Next fraction of the bracket: inverse quadratic where it is safe, else the middle."""

    def ratio(a: Array, b: Array) -> Array:
        return a / jnp.where(b == 0.0, 1.0, b)

    xi, phi = ratio(s.x1 - s.x2, s.x3 - s.x2), ratio(s.f1 - s.f2, s.f3 - s.f2)
    quadratic = ratio(s.f1, s.f2 - s.f1) * ratio(s.f3, s.f2 - s.f3)
    quadratic += ratio(s.x3 - s.x1, s.x2 - s.x1) * ratio(s.f1, s.f3 - s.f1) * ratio(s.f2, s.f3 - s.f2)
    t = jnp.where((phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi), quadratic, 0.5)
    least = jnp.minimum(0.5, ratio(0.4 * ROOT_TOLERANCE * jnp.ones_like(t), jnp.abs(s.x2 - s.x1)))
    return jnp.clip(t, least, 1.0 - least)


def bracketed_root(
    f: Callable[[Array], Array], centre: Values, reach: Values | float, guess: Values | None = None
) -> Values:
    """Roots of ``f`` within ``reach`` of ``centre`` for all elements at once, on the side where the sign
    changes.

    ``f`` is negative at ``centre - reach`` and positive at ``centre + reach``, of order one: its values there
    are not computed. Where a ``guess`` lies on the right side it is tried first. Source: Chandrupatla, Advances in
    Engineering Software 28 (1997) 145-149.
    """

    def step(s: _Search) -> _Search:
        x = s.x1 + s.t * (s.x2 - s.x1)
        fx = f(x)
        same = jnp.sign(fx) == jnp.sign(s.f1)
        x3, f3 = jnp.where(same, s.x1, s.x2), jnp.where(same, s.f1, s.f2)
        x2, f2 = jnp.where(same, s.x2, s.x1), jnp.where(same, s.f2, s.f1)
        new = _Search(x, x2, x3, fx, f2, f3, s.t, s.iteration + 1.0)
        return new._replace(t=_interpolation(new))

    f_centre = f(centre)
    side = jnp.where(f_centre <= 0.0, 1.0, -1.0)
    end, first = centre + side * reach, jnp.minimum(FIRST_STEP / reach, 0.5) * jnp.ones_like(centre)
    if guess is not None:
        share = side * (guess - centre) / reach
        first = jnp.where((share > 1e-4) & (share < 0.9), share, first)
    start = _Search(centre, end, end, f_centre, side, side, first, jnp.zeros(()))
    found = lax.while_loop(_unfinished, step, start)
    return jnp.where(jnp.abs(found.f1) <= jnp.abs(found.f2), found.x1, found.x2)
