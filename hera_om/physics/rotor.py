"""Blade-element momentum theory by radius and azimuth, from reverse thrust through static to windmilling."""

from typing import NamedTuple

import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.blade_polar import PolarInFlow, flow_coefficients, lift_line, polar_in_flow
from hera_om.physics.rotor_blade import SENSES as SENSES
from hera_om.physics.rotor_blade import Blade as Blade
from hera_om.physics.rotor_blade import azimuths as azimuths
from hera_om.physics.rotor_blade import blade_elements as blade_elements
from hera_om.physics.rotor_blade import element_points as element_points
from hera_om.physics.rotor_blade import sense_sign as sense_sign
from hera_om.physics.rotor_momentum import mass_flow, prandtl_loss
from hera_om.physics.rotor_root import guessed_root, safe
from hera_om.physics.section_polar import ScalarLike
from hera_om.physics.stall_delay import delayed

Field = Float[Array, "nr npsi"]
Column = Float[Array, "nr 1"]

LEAST_SPEED = 1e-6
"""Local speed in m/s under which an element counts as being in still air."""


class RotorSolution(NamedTuple):
    """What a rotor does; shaft axes x aft along the shaft, y to starboard, z up."""

    force: Float[Array, "3"]
    """Force on the aircraft, N; thrust is along -x."""
    moment: Float[Array, "3"]
    """Moment on the aircraft about the hub, N m."""
    thrust: Float[Array, ""]
    torque: Float[Array, ""]
    """Torque absorbed from the shaft, N m; negative when windmilling."""
    power: Float[Array, ""]
    """Shaft power, W."""
    CT: Float[Array, ""]
    """T / (rho n^2 D^4), zero for a stopped rotor."""
    CP: Float[Array, ""]
    """P / (rho n^3 D^5), zero for a stopped rotor."""
    v_axial: Float[Array, " nr"]
    """Azimuthal mean of the induced axial velocity at the disk, m/s, aft positive."""
    v_swirl: Float[Array, " nr"]
    """Azimuthal mean of the induced swirl at the disk, m/s, positive in the sense of rotation; twice it
    just behind."""
    blade_thrust: Float[Array, "nr npsi"]
    """Thrust of one blade per unit span, N/m."""
    blade_torque: Float[Array, "nr npsi"]
    """Torque absorbed by one blade per unit span, N m/m."""
    tip_mach: Float[Array, ""]
    """Helical tip Mach number."""
    omega: Float[Array, ""]
    """Angular speed, rad/s."""
    pitch: Float[Array, ""]
    """Blade angle at 75 % radius, rad."""
    phi: Float[Array, "nr npsi"]
    """Inflow angle of every element, rad; given back to ``solve_rotor`` it saves the search."""
    residual: Float[Array, ""]
    """Largest remaining residual of the elements, of order one when unsolved."""


class _Elements(NamedTuple):
    """What the residual of every (radius, azimuth) element depends on besides the inflow angle."""

    flow_angle: Field
    flow_sine: Field
    flow_cosine: Field
    theta: Column
    solidity: Column
    tip_factor: Column
    hub_factor: Column
    polar: PolarInFlow
    delay: dict[str, Array] | None
    """What ``stall_delay.delayed`` takes, or None without it."""


class _Loading(NamedTuple):
    """Section coefficients in the axes of the disk, and the mass-flow ratio m = V' / W of the annulus."""

    sine: Field
    cosine: Field
    normal: Field
    tangential: Field
    mass_flow: Field
    loss: Field


def _section(elements: _Elements, alpha: Field) -> tuple[Field, Field]:
    """Lift and drag coefficients, with the stall delay where it is wanted."""
    cl, cd = flow_coefficients(elements.polar, alpha)
    if elements.delay is None:
        return cl, cd
    alpha = alpha - 2.0 * jnp.pi * jnp.round(lax.stop_gradient(alpha) / (2.0 * jnp.pi))
    return delayed(cl, cd, alpha=alpha, lift_line=lift_line(elements.polar), **elements.delay)


def _loading(phi: Field, elements: _Elements, losses: tuple[bool, bool]) -> _Loading:
    """Section coefficients, losses and mass flow at the inflow angle ``phi``."""
    sine, cosine = jnp.sin(phi), jnp.cos(phi)
    cl, cd = _section(elements, elements.theta - phi)
    normal, tangential = cl * cosine - cd * sine, cl * sine + cd * cosine
    loss = jnp.ones_like(phi)
    if losses[0]:
        loss = loss * prandtl_loss(elements.tip_factor, sine)
    if losses[1]:
        loss = loss * prandtl_loss(elements.hub_factor, sine)
    flow = mass_flow(sine, elements.solidity * normal / (4.0 * loss), loss)
    return _Loading(sine, cosine, normal, tangential, flow, loss)


def _mismatch(load: _Loading, elements: _Elements) -> Field:
    """What the two theories differ by, negative at -90 and positive at +90 degrees from the stream."""
    turning = load.sine * elements.flow_cosine - load.cosine * elements.flow_sine
    lift = load.normal * elements.flow_cosine + load.tangential * elements.flow_sine
    return load.mass_flow * turning - elements.solidity * lift / (4.0 * load.loss)


def _inflow_angle(elements: _Elements, losses: tuple[bool, bool], known: Field | None) -> Field:
    """Inflow angle of every element, with implicit derivatives of any order.

    The root is found without derivatives, unless it is ``known``.
    """

    def mismatch(phi: Field) -> Field:
        return _mismatch(_loading(phi, elements, losses), elements)

    def solved(function, start: Field) -> Field:
        return start if known is not None else guessed_root(function, start, 0.5 * jnp.pi, guess)

    def divide(linear, right: Field) -> Field:
        return right / safe(linear(jnp.ones_like(right)))

    start = lax.stop_gradient(elements.flow_angle if known is None else known)
    guess = lax.stop_gradient(_linear_inflow_angle(elements))
    return lax.custom_root(mismatch, start, solved, divide)


def _linear_inflow_angle(elements: _Elements) -> Field:
    """Inflow angle of small angles and a straight lift line: phi (phi - phi0) = sigma a (theta - alpha0 - phi) / 4."""
    slope, alpha0 = lift_line(elements.polar)
    share = 0.25 * elements.solidity * slope
    half = 0.5 * (elements.flow_angle - share)
    return half + jnp.sqrt(jnp.maximum(half**2 + share * (elements.theta - alpha0), 0.0))


def _resultant_speed(load: _Loading, solidity: Column, axial: Field, tangential: Field) -> Field:
    """Resultant W from (Va, Vt) = W (sin(phi) - sigma cn / 4Fm, cos(phi) + sigma ct / 4Fm)."""
    scale = solidity / (4.0 * load.loss)
    a = load.mass_flow * load.sine - scale * load.normal
    b = load.mass_flow * load.cosine + scale * load.tangential
    return load.mass_flow * (axial * a + tangential * b) / (a**2 + b**2)


def _column(values: ScalarLike | Array) -> Column:
    return jnp.reshape(jnp.asarray(values, dtype=float), (-1, 1))


def _components(
    velocity: Float[Array, "nr npsi 3"], r: Column, *, omega: ScalarLike, sense: ScalarLike
) -> tuple[Field, Field]:
    """Axial inflow, and tangential inflow against the motion of the blade."""
    psi = azimuths(velocity.shape[1])
    along = velocity[..., 2] * jnp.cos(psi) - velocity[..., 1] * jnp.sin(psi)
    return velocity[..., 0], omega * r - sense * along


def _elements(
    blade: Blade,
    axial: Field,
    tangential: Field,
    *,
    pitch: ScalarLike,
    radius: ScalarLike,
    hub_radius: ScalarLike,
    n_blades: ScalarLike,
    sound_speed: ScalarLike,
    kinematic_viscosity: ScalarLike | None,
    tip_speed: ScalarLike | None,
) -> _Elements:
    """Parameters of the elements in a stream that is nowhere at rest; stall delay where a tip speed is given."""
    r, chord = _column(blade.r), _column(blade.chord)
    stream = jnp.sqrt(axial**2 + tangential**2)
    reynolds = None if kinematic_viscosity is None else stream * chord / kinematic_viscosity
    delay = None
    if tip_speed is not None:
        ratio = jnp.abs(tip_speed) / jnp.sqrt(axial**2 + jnp.square(tip_speed) + LEAST_SPEED**2)
        delay = {"chord_ratio": chord / r, "radius_ratio": r / radius, "speed_ratio": ratio}
    return _Elements(
        flow_angle=jnp.arctan2(axial, tangential),
        flow_sine=axial / stream,
        flow_cosine=tangential / stream,
        theta=_column(blade.twist) + pitch,
        solidity=n_blades * chord / (2.0 * jnp.pi * r),
        tip_factor=0.5 * n_blades * (radius - r) / r,
        hub_factor=0.5 * n_blades * (r - hub_radius) / hub_radius,
        polar=polar_in_flow(blade.polar, stream / sound_speed, reynolds),
        delay=delay,
    )


def _hub_loads(
    blade: Blade, thrust_span: Field, drag_span: Field, sense: ScalarLike
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Force and moment on the aircraft by all blades, from their loads per span averaged over the azimuth."""
    psi = azimuths(thrust_span.shape[1])
    # products, not sums: XLA would repeat all that leads to the loads for each of them
    shape = jnp.stack([jnp.ones_like(psi), jnp.cos(psi), jnp.sin(psi)], axis=1) / len(psi)
    (thrust, thrust_y, thrust_z), (drag, drag_y, drag_z) = (blade.dr * (v @ shape).T for v in (thrust_span, drag_span))
    force = [-jnp.sum(thrust), sense * jnp.sum(drag_z), -sense * jnp.sum(drag_y)]
    moment = [-sense * (blade.r @ drag), -(blade.r @ thrust_z), blade.r @ thrust_y]
    return jnp.stack(force), jnp.stack(moment)


def solve_rotor(
    blade: Blade,
    velocity: Float[Array, "nr npsi 3"],
    *,
    pitch: ScalarLike,
    omega: ScalarLike,
    radius: ScalarLike,
    hub_radius: ScalarLike,
    n_blades: ScalarLike,
    density: ScalarLike,
    sound_speed: ScalarLike,
    sense: ScalarLike,
    tip_loss: bool = True,
    hub_loss: bool = True,
    stall_delay: bool = False,
    viscosity: ScalarLike | None = None,
    phi: Float[Array, "nr npsi"] | None = None,
) -> RotorSolution:
    """Forces, moments and induced velocities of a rotor in any stream, by blade-element momentum theory.

    Every element has axial inflow Va and tangential inflow Vt = omega r - sense v_psi. With u the induced
    axial velocity, v the induced swirl, W the resultant at the angle phi, F the loss factor and V' = m W
    the mass flow

        4 F V' u = sigma W^2 cn,    4 F V' v = sigma W^2 ct,    Va + u = W sin(phi),    Vt - v = W cos(phi).

    Without u, v and W, and with phi0 = atan2(Va, Vt), one equation for phi remains:

        m sin(phi - phi0) - sigma / 4F (cl cos(phi - phi0) - cd sin(phi - phi0)) = 0.

    It is Ning's residual times its denominators. At phi0 +- 90 degrees its sign is fixed by m > 0 and cd > 0,
    at phi0 by that of the lift, so a root is always bracketed, whatever Va and Vt, zero included.

    Momentum theory is m = |sin(phi)|. Where the thrust opposes the stream so much that it ends (a > 0.4), m
    follows Buhl's empirical relation to a = 1, and beyond it returns smoothly to momentum theory at zero
    inflow. The vortex ring state is thus a smooth interpolation between two theories, no more.

    Source: Ning, Wind Energy 17 (2014) 1327-1345; Ning, Struct. Multidisc. Optim. 64 (2021) 994-1014; Buhl,
    NREL/TP-500-36834 (2005); Prandtl's losses after Glauert, in Durand, Aerodynamic Theory IV (1935).

    Arguments:
        blade: the elements of one blade, ``nr`` of them.
        velocity: air velocity relative to the hub at ``element_points(blade.r, npsi)``, shaft axes, without
            the rotor's own induction, m/s. ``npsi`` is at least 3.
        pitch: blade angle at 75 % radius, rad.
        omega: angular speed, rad/s; negative where a rotor without torque is turned backwards.
        radius: tip radius, m.
        hub_radius: m.
        n_blades: number of blades.
        density: kg/m^3.
        sound_speed: m/s.
        sense: +1 or -1, see ``sense_sign``.
        tip_loss: Prandtl's factor at the tip on or off (static).
        hub_loss: the same at the hub.
        stall_delay: delay of stall by rotation (static), see ``stall_delay``.
        viscosity: of the air, Pa s; needed by a polar table over the Reynolds number.
        phi: inflow angles of a solution at these very values (``RotorSolution.phi``), or None to search for them.

    Returns:
        RotorSolution. The mean induced velocities are F u and F v: what the whole annulus gets.

    Validity: independent annuli and quasi-steady sections, so incidence of the shaft up to about 20 degrees; a
    propeller or windmill below the drag rise of its sections. A stopped rotor in still air gives zeros.

    Raises:
        ValueError: when there are fewer than three azimuths, or a polar needs the viscosity that is missing.
    """
    npsi = velocity.shape[1]
    if npsi < 3:
        raise ValueError(f"{npsi} azimuths: at least 3 are needed for forces in the plane of the disk")
    losses = (tip_loss, hub_loss)
    axial, tangential = _components(velocity, _column(blade.r), omega=omega, sense=sense)
    still = axial**2 + tangential**2 < LEAST_SPEED**2
    geometry = {"pitch": pitch, "radius": radius, "hub_radius": hub_radius, "n_blades": n_blades}
    moving = jnp.where(still, LEAST_SPEED, tangential)
    air = {"sound_speed": sound_speed, "kinematic_viscosity": None if viscosity is None else viscosity / density}
    elements = _elements(blade, axial, moving, tip_speed=omega * radius if stall_delay else None, **air, **geometry)
    phi = _inflow_angle(elements, losses, phi)
    load = _loading(phi, elements, losses)
    speed = _resultant_speed(load, elements.solidity, axial, tangential)
    pressure = 0.5 * density * speed**2 * _column(blade.chord)
    thrust_span, drag_span = pressure * load.normal, pressure * load.tangential
    force, moment = _hub_loads(blade, n_blades * thrust_span, n_blades * drag_span, sense)
    thrust, torque = -force[0], -sense * moment[0]
    mean = jnp.full(npsi, 1.0 / npsi)
    turning = jnp.asarray(omega, dtype=float) != 0.0
    turns = jnp.where(turning, omega, 1.0) / (2.0 * jnp.pi)
    unit = jnp.where(turning, density * turns**2 * (2.0 * radius) ** 4, jnp.inf)
    tip_speed = jnp.sqrt(jnp.mean(axial[-1]) ** 2 + (omega * radius) ** 2 + LEAST_SPEED**2)
    return RotorSolution(
        force=force,
        moment=moment,
        thrust=thrust,
        torque=torque,
        power=torque * omega,
        CT=thrust / unit,
        CP=2.0 * jnp.pi * torque / (unit * 2.0 * radius),
        v_axial=load.loss * (speed * load.sine - axial) @ mean,
        v_swirl=load.loss * (tangential - speed * load.cosine) @ mean,
        blade_thrust=thrust_span,
        blade_torque=_column(blade.r) * drag_span,
        tip_mach=tip_speed / sound_speed,
        omega=jnp.asarray(omega, dtype=float),
        pitch=jnp.asarray(pitch, dtype=float),
        phi=phi,
        residual=jnp.max(jnp.abs(lax.stop_gradient(_mismatch(load, elements)))),
    )
