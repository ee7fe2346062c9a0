"""Roots of many equations at once: Newton steps from a guess, and a bracketed search where these fail."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float

Values = Float[Array, "..."]

ROOT_TOLERANCE, RESIDUAL_TOLERANCE = 1e-5, 1e-6
"""Bracket width, or residual, at which the search stops."""
ROOT_ITERATIONS = 80
NEWTON_ITERATIONS, LONGEST_STEP, LAST_STEP = 10, 0.1, 1e-7
"""Newton's steps before the search takes over, the longest of them, rad, and the one after which it ends: its square
is rounding."""
LEAST_SLOPE = 1e-8
"""Slope of the residual under which a division by it is held back."""
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
    return jnp.any(wide & wrong)


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
    f: Callable[[Array], Array], centre: Values, reach: Values | float, most: Array | float = ROOT_ITERATIONS
) -> Values:
    """Roots of ``f`` within ``reach`` of ``centre`` for all elements at once, on the side where the sign
    changes.

    ``f`` is negative at ``centre - reach`` and positive at ``centre + reach``, of order one: its values there
    are not computed. ``most`` is the number of steps allowed. Source: Chandrupatla, Advances in Engineering
    Software 28 (1997) 145-149.
    """

    def first(fx: Values) -> _Search:
        side = jnp.where(fx <= 0.0, 1.0, -1.0)
        end, t = centre + side * reach, jnp.minimum(FIRST_STEP / reach, 0.5) * jnp.ones_like(centre)
        return _Search(centre, end, end, fx, side, side, t, jnp.ones(()))

    def later(s: _Search, x: Values, fx: Values) -> _Search:
        same = jnp.sign(fx) == jnp.sign(s.f1)
        x3, f3 = jnp.where(same, s.x1, s.x2), jnp.where(same, s.f1, s.f2)
        x2, f2 = jnp.where(same, s.x2, s.x1), jnp.where(same, s.f2, s.f1)
        new = _Search(x, x2, x3, fx, f2, f3, s.t, s.iteration + 1.0)
        return new._replace(t=_interpolation(new))

    def step(s: _Search) -> _Search:
        x = s.x1 + s.t * (s.x2 - s.x1)
        fx = f(x)
        return jax.tree.map(lambda a, b: jnp.where(s.iteration == 0.0, a, b), first(fx), later(s, x, fx))

    # the first step is at the centre, within the loop: compiled code then has one copy of f
    one, end = jnp.ones_like(centre), centre + reach
    start = _Search(centre, end, end, one, one, one, 0.0 * one, jnp.zeros(()))
    found = lax.while_loop(lambda s: _unfinished(s) & (s.iteration < most), step, start)
    return jnp.where(jnp.abs(found.f1) <= jnp.abs(found.f2), found.x1, found.x2)


class _Newton(NamedTuple):
    """State of Newton's method: place, last step and the slope before it."""

    x: Values
    step: Values
    slope: Values
    iteration: Float[Array, ""]


def safe(slope: Array) -> Array:
    """A slope to divide by."""
    return jnp.where(jnp.abs(slope) > LEAST_SLOPE, slope, LEAST_SLOPE)


def _newton(f: Callable[[Array], Array], start: Values) -> _Newton:
    """Newton's method for all elements, until the last has arrived or the steps are used up."""

    def body(s: _Newton) -> _Newton:
        value, slope = jax.jvp(f, (s.x,), (jnp.ones_like(s.x),))  # elements do not depend on each other
        # where f falls, the longest step towards the side on which it has to rise through zero
        step = jnp.clip(-value / jnp.maximum(slope, LEAST_SLOPE), -LONGEST_STEP, LONGEST_STEP)
        return _Newton(s.x + step, step, slope, s.iteration + 1.0)

    def unfinished(s: _Newton) -> Array:
        return jnp.any(jnp.abs(s.step) > LAST_STEP) & (s.iteration < NEWTON_ITERATIONS)

    one = jnp.ones_like(start)
    return lax.while_loop(unfinished, body, _Newton(start, one, one, jnp.zeros(())))


def guessed_root(f: Callable[[Array], Array], centre: Values, reach: float, guess: Values) -> Values:
    """Roots of ``f`` within ``reach`` of ``centre`` for all elements at once, to rounding where ``f`` is smooth.

    Newton's method from ``guess``. Where an element does not come to a root at which ``f`` rises, the bracketed search
    finds one, and Newton's method polishes that; where it cannot, what the search has found stands.
    ``f`` as in ``bracketed_root``.
    """

    def attempt(state: tuple[Values, Array, Array]) -> tuple[Values, Array, Array]:
        x, there, trial = state
        bracketed = bracketed_root(f, jnp.where(there, x, centre), reach, ROOT_ITERATIONS * trial)
        start = jnp.where(there, x, jnp.where(trial == 0.0, guess, bracketed))
        s = _newton(f, start)
        there = (jnp.abs(s.step) <= LAST_STEP) & (s.slope > LEAST_SLOPE) & (jnp.abs(s.x - centre) < reach)
        return jnp.where(there, s.x, start), there, trial + 1.0

    # loops, as conditions would run both ways under vmap and double the compiled code
    state = guess, jnp.zeros(centre.shape, bool), jnp.zeros(())
    return lax.while_loop(lambda s: ~jnp.all(s[1]) & (s[2] < 2.0), attempt, state)[0]
