"""Blade-element momentum theory by radius and azimuth, from reverse thrust through static to windmilling."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float

from hera_om.physics.section_polar import ScalarLike, SectionPolar, section_coefficients

Field = Float[Array, "nr npsi"]
Column = Float[Array, "nr 1"]

BUHL_ONSET = 1.5**0.5
"""Relative inflow where Buhl's line leaves momentum theory, at a = 0.4 (NREL/TP-500-36834, 2005)."""
BUHL_SHAPE = (-0.392, 1.789)
"""Shape of the bridge over the turbulent-wake state, fitted to Buhl's C_T to 0.04 over 0.4 < a < 1."""
TURBULENT_WAKE = 1.0
"""Share of that bridge in the mass flow; zero would leave plain momentum theory."""
LEAST_MASS_FLOW = 1e-4
"""Floor of the mass-flow ratio where neither inflow nor thrust moves air (regularisation)."""
LEAST_LOSS = 1e-4
"""Floor of the loss factor at the very tip and hub."""
LEAST_SPEED = 1e-6
"""Local speed in m/s under which an element counts as being in still air."""
ROOT_TOLERANCE, RESIDUAL_TOLERANCE = 1e-8, 1e-10
"""Bracket width, rad, or residual at which the search stops; the Newton steps after it square the error."""
ROOT_ITERATIONS = 80
FIRST_STEP = 0.1
"""First trial, rad from the undisturbed stream: the induced angle of a loaded propeller is of this size."""
LEAST_SLOPE = 1e-8
SENSES = {"inboard-up": -1.0, "outboard-up": 1.0}


class Blade(NamedTuple):
    """One blade as elements; station values and integration weights."""

    r: Float[Array, " nr"]
    """Radius of each element, m."""
    dr: Float[Array, " nr"]
    """Integration weight of each element, m."""
    chord: Float[Array, " nr"]
    """Chord, m."""
    twist: Float[Array, " nr"]
    """Blade angle relative to that at 75 % radius, rad."""
    polar: SectionPolar


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
    mach: Field
    solidity: Column
    tip_factor: Column
    hub_factor: Column
    polar: SectionPolar


class _Loading(NamedTuple):
    """Section coefficients in the axes of the disk, and the mass-flow ratio m = V' / W of the annulus."""

    sine: Field
    cosine: Field
    normal: Field
    tangential: Field
    mass_flow: Field
    loss: Field


def sense_sign(name: str, side: float) -> float:
    """Sign of a rotor's angular velocity about the x axis, aft; +1 is anticlockwise seen from behind.

    Inboard-up, the blade on the fuselage side moves up: -1 on the starboard wing, +1 on the port wing.

    Arguments:
        name: "inboard-up" or "outboard-up".
        side: y of the hub or its sign, positive to starboard; a rotor on the centre line counts as starboard.

    Raises:
        ValueError: for another name.
    """
    if name not in SENSES:
        raise ValueError(f"rotor sense {name!r}: expected one of {sorted(SENSES)}")
    return SENSES[name] if side >= 0.0 else -SENSES[name]


def azimuths(npsi: int) -> Float[Array, " npsi"]:
    """Azimuth angles psi_j = 2 pi j / npsi, rad, from +y (starboard) towards +z (up)."""
    return 2.0 * jnp.pi * jnp.arange(npsi) / npsi


def element_points(r: Float[Array, " nr"], npsi: int) -> Float[Array, "nr npsi 3"]:
    """Positions of the elements relative to the hub in shaft axes, m: where ``velocity`` is wanted."""
    psi = azimuths(npsi)
    radial = jnp.stack([jnp.zeros_like(psi), jnp.cos(psi), jnp.sin(psi)], axis=-1)
    return r[:, None, None] * radial[None]


def blade_elements(
    radius: ScalarLike,
    hub_radius: ScalarLike,
    r_table: Float[Array, " nt"],
    c_table: Float[Array, " nt"],
    twist_table: Float[Array, " nt"],
    *,
    polar: SectionPolar,
    n: int,
) -> Blade:
    """Blade of ``n`` equal elements at their mid-points from a table of geometry.

    Piecewise linear in the table and continued linearly beyond its ends, so linear in the table's values.

    Arguments:
        radius: tip radius, m.
        hub_radius: m.
        r_table: radii over ``radius``, ascending.
        c_table: chord over ``radius``.
        twist_table: blade angle relative to that at 75 % radius, rad.
        polar: numbers, or arrays over the ``n`` elements.
        n: number of elements.
    """
    hub = hub_radius / radius
    x = hub + (1.0 - hub) * (jnp.arange(n) + 0.5) / n
    i = jnp.clip(jnp.searchsorted(r_table, x) - 1, 0, r_table.shape[0] - 2)
    t = (x - r_table[i]) / (r_table[i + 1] - r_table[i])
    chord = radius * (c_table[i] + t * (c_table[i + 1] - c_table[i]))
    twist = twist_table[i] + t * (twist_table[i + 1] - twist_table[i])
    return Blade(radius * x, jnp.full(n, (radius - hub_radius) / n), chord, twist, polar)


def _turbulent_wake(xi: Field) -> Field:
    """Bridge over -1 < xi < BUHL_ONSET, 1 at the middle, with two vanishing derivatives at both ends."""
    x = jnp.clip(xi, -1.0, BUHL_ONSET)
    shape = 1.0 + x * (BUHL_SHAPE[0] + x * BUHL_SHAPE[1])
    return TURBULENT_WAKE * ((1.0 - x / BUHL_ONSET) * (1.0 + x)) ** 3 * shape


def _mass_flow(sine: Field, thrust: Field, loss: Field) -> Field:
    """Mass-flow ratio m = V' / W: |sin(phi)|, raised where the thrust opposes the stream (see
    ``solve_rotor``).

    ``thrust`` is sigma cn / 4F. The relative inflow xi = -sin(phi) sign(thrust) / sqrt|thrust| is at least
    1.22 in the windmill state and at most -1 in the propeller state.
    """
    magnitude = jnp.abs(thrust)
    bridged = magnitude > sine**2 / BUHL_ONSET**2
    safe = jnp.where(bridged, magnitude, 1.0)
    xi = -sine * jnp.sign(thrust) / jnp.sqrt(safe)
    bridge = jnp.where(bridged, safe * _turbulent_wake(xi) / (2.0 * loss), 0.0)
    return jnp.sqrt(sine**2 + bridge + LEAST_MASS_FLOW**2)


def _loss(factor: Column, sine: Field) -> Field:
    """Prandtl's factor 2/pi arccos(exp(-f)), f = factor / |sin(phi)|, after Glauert."""
    f = factor / jnp.sqrt(sine**2 + LEAST_MASS_FLOW**2)
    return jnp.maximum(2.0 / jnp.pi * jnp.arccos(jnp.exp(-jnp.maximum(f, LEAST_LOSS**2))), LEAST_LOSS)


def _loading(phi: Field, elements: _Elements, losses: tuple[bool, bool]) -> _Loading:
    """Section coefficients, losses and mass flow at the inflow angle ``phi``."""
    sine, cosine = jnp.sin(phi), jnp.cos(phi)
    cl, cd = section_coefficients(elements.polar, elements.theta - phi, elements.mach)
    normal, tangential = cl * cosine - cd * sine, cl * sine + cd * cosine
    loss = jnp.ones_like(phi)
    if losses[0]:
        loss = loss * _loss(elements.tip_factor, sine)
    if losses[1]:
        loss = loss * _loss(elements.hub_factor, sine)
    mass_flow = _mass_flow(sine, elements.solidity * normal / (4.0 * loss), loss)
    return _Loading(sine, cosine, normal, tangential, mass_flow, loss)


def _residual(phi: Field, elements: _Elements, losses: tuple[bool, bool]) -> Field:
    """Mismatch of the two theories, negative at -90 and positive at +90 degrees from the stream."""
    load = _loading(phi, elements, losses)
    turning = load.sine * elements.flow_cosine - load.cosine * elements.flow_sine
    lift = load.normal * elements.flow_cosine + load.tangential * elements.flow_sine
    return load.mass_flow * turning - elements.solidity * lift / (4.0 * load.loss)


class _Search(NamedTuple):
    """State of Chandrupatla's search: newest point 1, other end 2 of the bracket, previous point 3."""

    x1: Field
    x2: Field
    x3: Field
    f1: Field
    f2: Field
    f3: Field
    t: Field
    iteration: Float[Array, ""]


def _unfinished(s: _Search) -> Bool[Array, ""]:
    wide = jnp.abs(s.x2 - s.x1) > ROOT_TOLERANCE
    wrong = jnp.minimum(jnp.abs(s.f1), jnp.abs(s.f2)) > RESIDUAL_TOLERANCE
    return jnp.any(wide & wrong) & (s.iteration < ROOT_ITERATIONS)


def _interpolation(s: _Search) -> Field:
    """Next fraction of the bracket: inverse quadratic where it is safe, else the middle."""

    def ratio(a: Array, b: Array) -> Array:
        return a / jnp.where(b == 0.0, 1.0, b)

    xi, phi = ratio(s.x1 - s.x2, s.x3 - s.x2), ratio(s.f1 - s.f2, s.f3 - s.f2)
    quadratic = ratio(s.f1, s.f2 - s.f1) * ratio(s.f3, s.f2 - s.f3)
    quadratic += ratio(s.x3 - s.x1, s.x2 - s.x1) * ratio(s.f1, s.f3 - s.f1) * ratio(s.f2, s.f3 - s.f2)
    t = jnp.where((phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi), quadratic, 0.5)
    least = jnp.minimum(0.5, ratio(0.4 * ROOT_TOLERANCE * jnp.ones_like(t), jnp.abs(s.x2 - s.x1)))
    return jnp.clip(t, least, 1.0 - least)


def _bracketed_root(f: Callable[[Array], Array], centre: Field, reach: float) -> Field:
    """Roots of ``f`` within ``reach`` of ``centre`` for all elements at once, on the side where the sign
    changes.

    ``f`` is negative at ``centre - reach`` and positive at ``centre + reach``, of order one: its values there
    are not computed. Source: Chandrupatla, Advances in Engineering Software 28 (1997) 145-149.
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
    end, first = centre + side * reach, jnp.full_like(centre, FIRST_STEP / reach)
    start = _Search(centre, end, end, f_centre, side, side, first, jnp.zeros(()))
    found = lax.while_loop(_unfinished, step, start)
    return jnp.where(jnp.abs(found.f1) <= jnp.abs(found.f2), found.x1, found.x2)


def _inflow_angle(elements: _Elements, losses: tuple[bool, bool], known: Field | None) -> Field:
    """Inflow angle of every element, exact to second derivatives.

    The root is found without derivatives, unless it is ``known``. Each of two Newton steps with the slope frozen
    there then adds one exact order of the dependence on the parameters.
    """
    frozen = lax.stop_gradient(elements)

    def mismatch(phi: Array) -> Array:
        return _residual(phi, frozen, losses)

    if known is None:
        known = _bracketed_root(mismatch, frozen.flow_angle, 0.5 * jnp.pi)
    root = lax.stop_gradient(known)
    slope = lax.stop_gradient(jax.jvp(mismatch, (root,), (jnp.ones_like(root),))[1])
    slope = jnp.where(jnp.abs(slope) > LEAST_SLOPE, slope, LEAST_SLOPE)
    return lax.fori_loop(0, 2, lambda _, phi: phi - _residual(phi, elements, losses) / slope, root)


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
) -> _Elements:
    """Parameters of the elements in a stream that is nowhere at rest."""
    r = _column(blade.r)
    stream = jnp.sqrt(axial**2 + tangential**2)
    return _Elements(
        flow_angle=jnp.arctan2(axial, tangential),
        flow_sine=axial / stream,
        flow_cosine=tangential / stream,
        theta=_column(blade.twist) + pitch,
        mach=stream / sound_speed,
        solidity=n_blades * _column(blade.chord) / (2.0 * jnp.pi * r),
        tip_factor=0.5 * n_blades * (radius - r) / r,
        hub_factor=0.5 * n_blades * (r - hub_radius) / hub_radius,
        polar=jax.tree_util.tree_map(_column, blade.polar),
    )


def _hub_loads(
    blade: Blade, thrust_span: Field, drag_span: Field, sense: ScalarLike
) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Force and moment on the aircraft by all blades, from their loads per span averaged over the azimuth."""
    npsi = thrust_span.shape[1]
    psi, r = azimuths(npsi), _column(blade.r)
    y, z = jnp.cos(psi), jnp.sin(psi)
    thrust, drag = _column(blade.dr) / npsi * thrust_span, _column(blade.dr) / npsi * drag_span
    force = [-jnp.sum(thrust), sense * jnp.sum(drag * z), -sense * jnp.sum(drag * y)]
    moment = [-sense * jnp.sum(r * drag), -jnp.sum(r * thrust * z), jnp.sum(r * thrust * y)]
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
        omega: angular speed, rad/s, not negative.
        radius: tip radius, m.
        hub_radius: m.
        n_blades: number of blades.
        density: kg/m^3.
        sound_speed: m/s.
        sense: +1 or -1, see ``sense_sign``.
        tip_loss: Prandtl's factor at the tip on or off (static).
        hub_loss: the same at the hub.
        phi: inflow angles of a solution at these very values (``RotorSolution.phi``), or None to search for them.

    Returns:
        RotorSolution. The mean induced velocities are F u and F v: what the whole annulus gets.

    Validity: independent annuli and quasi-steady sections, so incidence of the shaft up to about 20 degrees; a
    propeller or windmill below the drag rise of its sections. A stopped rotor in still air gives zeros.

    Raises:
        ValueError: when there are fewer than three azimuths.
    """
    npsi = velocity.shape[1]
    if npsi < 3:
        raise ValueError(f"{npsi} azimuths: at least 3 are needed for forces in the plane of the disk")
    losses = (tip_loss, hub_loss)
    axial, tangential = _components(velocity, _column(blade.r), omega=omega, sense=sense)
    still = axial**2 + tangential**2 < LEAST_SPEED**2
    geometry = {"pitch": pitch, "radius": radius, "hub_radius": hub_radius, "n_blades": n_blades}
    moving = jnp.where(still, LEAST_SPEED, tangential)
    elements = _elements(blade, axial, moving, sound_speed=sound_speed, **geometry)
    phi = _inflow_angle(elements, losses, phi)
    load = _loading(phi, elements, losses)
    speed = _resultant_speed(load, elements.solidity, axial, tangential)
    pressure = 0.5 * density * speed**2 * _column(blade.chord)
    thrust_span, drag_span = pressure * load.normal, pressure * load.tangential
    force, moment = _hub_loads(blade, n_blades * thrust_span, n_blades * drag_span, sense)
    thrust, torque = -force[0], -sense * moment[0]
    turning = jnp.asarray(omega, dtype=float) > 0.0
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
        v_axial=jnp.mean(load.loss * (speed * load.sine - axial), axis=1),
        v_swirl=jnp.mean(load.loss * (tangential - speed * load.cosine), axis=1),
        blade_thrust=thrust_span,
        blade_torque=_column(blade.r) * drag_span,
        tip_mach=tip_speed / sound_speed,
        phi=phi,
        residual=jnp.max(jnp.abs(lax.stop_gradient(_residual(phi, elements, losses)))),
    )
