"""The last step to thicknesses that can be bought, outside the gradients."""

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float

from hera_om.physics.wingbox import evaluate_box
from hera_om.physics.wingbox_criteria import box_state
from hera_om.physics.wingbox_reserve import cover_compression
from hera_om.physics.wingbox_types import BoxModel, BoxResult

ScalarLike = Float[Array, ""] | float | int

_MOST_REPAIRS = 40
_AMPLE = 10.0  # a reserve factor above which nobody counts
_ABOVE_LEAST = 1.05  # RFC of a station that is required nowhere and this far above the wing's may fall to that
_EXCESS = 1e-6  # of a utilisation; and the loss of a reserve factor that counts as none


def round_up_to_increment(
    t: Float[Array, "p n"], *, increment: ScalarLike, max_step: ScalarLike = jnp.inf
) -> Float[Array, "p n"]:
    """Thicknesses that can be bought: whole increments, and no more than ``max_step`` between neighbours.

    Only ever adds thickness. Not to be differentiated: a last step for reports and gradient-free drivers.

    Args:
        t: continuous thickness, m.
        increment: step of the sheets, m.
        max_step: largest difference of neighbouring stations, m, a whole number of increments.

    Returns:
        Rounded thickness, m.
    """
    step = jnp.maximum(increment, 1e-9)
    rounded = step * jnp.ceil(t / step - 1e-9)
    station = jnp.arange(t.shape[1])
    apart = jnp.abs(station[:, None] - station[None, :])
    allowance = jnp.where(apart == 0, 0.0, max_step * jnp.maximum(apart, 1))
    return jnp.max(rounded[:, None, :] - allowance, axis=2)


def bought_box(
    model: BoxModel, points: Float[Array, "n 3"], sized: BoxResult, *, increment: ScalarLike, max_step: ScalarLike
) -> BoxResult:
    """The box of sheets and ribs that can be bought: no sheet over a limit, no reserve factor below the sized one.

    `round_up_to_increment`; then, until nothing has got worse and with the steps limited again, one increment more
    for all four sheets of a station where a criterion is over its limit or RFT has fallen (a thicker sheet moves
    centroid and shear centre), and for all but one where RFC has fallen. That one is the cover whose members are
    pressed most: its own thicker skin takes load from the caps and loads its stringers, which gain area and hardly
    stiffness, with more of itself; thicker webs and the other cover take stress off them. A station that has more
    RFC than is required, and than the wing has, may come down to that.

    Args:
        model: the box and its loads.
        points: centre of the box at the stations, m [n, 3].
        sized: the continuous box.
        increment: step of the sheets, m.
        max_step: largest difference of neighbouring stations, m.

    Returns:
        The result; it has no derivatives.
    """
    model, points, sized = jax.tree.map(lambda v: lax.stop_gradient(jnp.asarray(v)), (model, points, sized))
    increment = lax.stop_gradient(jnp.asarray(increment, float))
    t = jnp.stack([sized.t_skin_upper, sized.t_skin_lower, sized.t_web_front, sized.t_web_rear])

    def buy(wanted: Float[Array, "p n"]) -> Float[Array, "p n"]:
        return round_up_to_increment(wanted, increment=increment, max_step=max_step)

    def evaluated(bought: Float[Array, "4 n"]) -> BoxResult:
        return evaluate_box(model, points, bought, t_rib=buy(jnp.stack([sized.t_rib]))[0])

    def fallen(now: Float[Array, "n"], before: Float[Array, "n"], ample: ScalarLike) -> Bool[Array, "n"]:
        return now < (1.0 - _EXCESS) * jnp.minimum(before, ample)

    enough = jnp.maximum(model.concept.reserve, _ABOVE_LEAST * sized.RFC)

    def thin(found: BoxResult, bought: Float[Array, "4 n"]) -> Bool[Array, "4 n"]:
        """Sheets that ask for one increment more."""
        every = fallen(found.RFT_span, sized.RFT_span, _AMPLE) | (found.worst_excess > _EXCESS)
        pressed = jnp.max(cover_compression(model, box_state(model, bought), bought), axis=(0, 2, 3))
        spared = jnp.zeros(bought.shape, bool).at[:2].set(pressed == jnp.max(pressed, axis=0))
        return every | (fallen(found.RFC_span, sized.RFC_span, enough) & ~spared)

    def unfinished(state: tuple) -> Bool[Array, ""]:
        _, bad, count, _ = state
        return (count == 0) | (jnp.any(bad) & (count < _MOST_REPAIRS))

    def repair(state: tuple) -> tuple:
        bought, bad, count, _ = state
        thicker = buy(bought + increment * bad)
        found = evaluated(thicker)
        return thicker, thin(found, thicker), count + 1, found

    *_, found = lax.while_loop(unfinished, repair, (t, jnp.zeros(t.shape, bool), jnp.asarray(0), sized))
    return found
