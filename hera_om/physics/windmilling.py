"""What a rotor without torque does in a stream: the speed at which it turns, the pitch at which it stands still."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.rotor import Blade, solve_rotor
from hera_om.physics.rotor_root import bracketed_root
from hera_om.physics.section_polar import ScalarLike

SCAN = 36
"""Steps in which the first change of sign of the torque is looked for, 5 degrees each."""
LEAST_HELIX = 0.02
"""Least helix angle of the search, rad: 48 radii of travel a radian at 75 % radius, beyond any windmill."""
LEAST_SPEED = 1e-6
"""Axial speed in m/s under which the stream counts as having this one."""
NEWTON_STEPS = 3
FEATHER_REACH = 0.25 * jnp.pi
"""Half range about 90 degrees in which the feathering pitch is looked for, rad: no twist shifts it farther."""


class Known(NamedTuple):
    """A solution found before, at the same values."""

    answer: Float[Array, ""]
    """Angular speed or pitch."""
    phi: Float[Array, "nr npsi"]
    """Inflow angles, see ``RotorSolution``."""


class _Bracket(NamedTuple):
    """Middle and half width of the helix angles about a change of sign, rad, and the torque's size there."""

    centre: Float[Array, ""]
    reach: Float[Array, ""] | float
    size: Float[Array, ""]


def windmilling_speed(
    blade: Blade,
    velocity: Float[Array, "nr npsi 3"],
    *,
    pitch: ScalarLike,
    radius: ScalarLike,
    density: ScalarLike,
    known: Known | None = None,
    **how,
) -> Float[Array, ""]:
    """Angular speed at which the air exerts no torque on a rotor: what a failed one that turns freely settles at.

    The unknown is the helix angle gamma at 75 % radius, ``omega = V cot(gamma) / (0.75 R)``. As it goes to zero the
    drag of the blades absorbs torque, and as it goes to 180 degrees, turning backwards, the drag drives: a root is
    always bracketed. The scan starts at the fast end, so that of several roots the fastest is found, which is where
    a rotor settles that fails while it turns. A feathered blade turns slowly, either way; a blade at a negative
    pitch may turn backwards. To keep a rotor stopped, solve it at ``omega = 0``.

    Source: zero of the torque of ``solve_rotor``.

    Arguments:
        blade: the elements of one blade.
        velocity: as for ``solve_rotor``; its mean axial component is V.
        pitch: blade angle at 75 % radius, rad.
        radius: tip radius, m.
        density: kg/m^3.
        known: the answer and the inflow angles at these very values, or None to search for them.
        how: the other arguments of ``solve_rotor`` but ``omega`` and ``phi``.

    Returns:
        omega, rad/s, negative when turning backwards; differentiable to any order.

    Validity: that of ``solve_rotor``; friction of the shaft is left out. Roots closer than 5 degrees of helix angle
    to each other may be missed, a pair at a time.
    """
    axial = jnp.mean(velocity[..., 0])
    speed = jnp.where(jnp.abs(axial) > LEAST_SPEED, axial, LEAST_SPEED)

    start, phi = jnp.asarray(0.5 * jnp.pi), None
    if known is not None:
        across = 0.75 * radius * jnp.sign(speed) * known.answer
        start, phi = lax.stop_gradient((jnp.arctan2(jnp.abs(speed), across), known.phi))

    def omega(helix):
        return speed / (0.75 * radius * jnp.tan(helix))

    def braking(helix: Float[Array, "..."]) -> Float[Array, "..."]:
        """Torque that drives the rotor, over density, square of the speed at 75 % radius and cube of the radius."""
        case = {"pitch": pitch, "omega": omega(helix), "radius": radius, "density": density, "phi": phi}
        torque = solve_rotor(blade, velocity, **case, **how).torque
        return -torque * jnp.square(jnp.sin(helix)) / (density * jnp.square(speed) * radius**3)

    def search(function, start):
        if known is not None:
            return start
        bracket = _bracket(function, start)
        root = bracketed_root(lambda x: function(x) / bracket.size, bracket.centre, bracket.reach)
        return lax.fori_loop(0, NEWTON_STEPS, lambda _, x: _newton(function, x, bracket), root)

    def divide(linear, right):
        return right / linear(jnp.ones_like(right))

    return omega(lax.custom_root(braking, start, search, divide))


def feathering_pitch(
    blade: Blade,
    velocity: Float[Array, "nr npsi 3"],
    *,
    radius: ScalarLike,
    density: ScalarLike,
    known: Known | None = None,
    **how,
) -> Float[Array, ""]:
    """Blade pitch at which the air exerts no torque on a rotor that stands still: the feathering angle.

    The lift of blades edge-on to the stream, summed up over their twist, changes its sign between 45 and 135 degrees;
    on usual blades this is at 80 to 90 degrees at 75 % of the radius.

    Source: the angle of zero windmilling torque, and so of little drag, of a stopped propeller; Kumar, An Illustrated
    Dictionary of Aviation (2005), "feathering angle".

    Arguments:
        blade: the elements of one blade.
        velocity: as for ``solve_rotor``.
        radius: tip radius, m.
        density: kg/m^3.
        known: as for ``windmilling_speed``.
        how: the other arguments of ``solve_rotor`` but ``pitch``, ``omega`` and ``phi``.

    Returns:
        Blade angle at 75 % radius, rad; differentiable to any order.

    Validity: that of ``solve_rotor``, with the stream from ahead.
    """
    axial = jnp.mean(velocity[..., 0])
    speed = jnp.where(jnp.abs(axial) > LEAST_SPEED, axial, LEAST_SPEED)

    start, phi = jnp.asarray(0.5 * jnp.pi), None
    if known is not None:
        start, phi = lax.stop_gradient((known.answer, known.phi))

    def absorbed(pitch: Float[Array, ""]) -> Float[Array, ""]:
        """Torque over density, square of the speed and cube of the radius; rises with the pitch."""
        case = {"pitch": pitch, "omega": 0.0, "radius": radius, "density": density, "phi": phi}
        return solve_rotor(blade, velocity, **case, **how).torque / (density * jnp.square(speed) * radius**3)

    def search(function, start):
        if known is not None:
            return start
        ends = function(start + FEATHER_REACH), function(start - FEATHER_REACH)
        bracket = _Bracket(start, FEATHER_REACH, ends[0] - ends[1])
        root = bracketed_root(lambda x: function(x) / bracket.size, bracket.centre, bracket.reach)
        return lax.fori_loop(0, NEWTON_STEPS, lambda _, x: _newton(function, x, bracket), root)

    def divide(linear, right):
        return right / linear(jnp.ones_like(right))

    return lax.custom_root(absorbed, start, search, divide)


def _bracket(function, start) -> _Bracket:
    """The first step of the scan, from the fast end, over which the driving torque turns from negative to positive."""
    angles = start + jnp.linspace(LEAST_HELIX - 0.5 * jnp.pi, 0.5 * jnp.pi - LEAST_HELIX, SCAN + 1)
    values = lax.map(function, angles)
    i = jnp.argmax((values[:-1] < 0.0) & (values[1:] >= 0.0))
    return _Bracket(0.5 * (angles[i] + angles[i + 1]), 0.5 * (angles[i + 1] - angles[i]), values[i + 1] - values[i])


def _newton(function, x, bracket: _Bracket):
    """One Newton step that stays within the bracket."""
    value, slope = jax.jvp(function, (x,), (jnp.ones_like(x),))
    step = value / jnp.where(slope == 0.0, bracket.size / bracket.reach, slope)
    return jnp.clip(x - step, bracket.centre - bracket.reach, bracket.centre + bracket.reach)
