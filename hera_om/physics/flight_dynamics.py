"""Static stability, the paper's reduced-order modes (Eqs. 2-5) and the full linearised equations of motion.

Coefficients come in by the conventions of the registry: ``CX CY CZ`` along geometry axes (x aft, y starboard,
z UP), ``Cl Cm Cn`` about body axes (x forward, y starboard, z down), rates ``q_hat = q c / 2V``,
``p_hat = p b / 2V``, ``r_hat = r b / 2V``. The equations of motion are written in body axes, which are the
geometry axes turned by half a turn about y: ``X = -CX q S`` and ``Z = -CZ q S``. No stability axes are
needed, because the steady velocity has its component ``W0 = V sin(alpha)``.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.atmosphere import STANDARD_GRAVITY
from hera_om.physics.modes import second_order_mode

ScalarLike = Float[Array, ""] | float | int


class SteadyFlight(NamedTuple):
    """Straight, level-winged flight: m/s, kg/m3, rad (angle of attack and attitude of the body x axis)."""

    speed: ScalarLike
    density: ScalarLike
    alpha: ScalarLike = 0.0
    theta: ScalarLike = 0.0
    gravity: ScalarLike = STANDARD_GRAVITY


class ReducedOrder(NamedTuple):
    """Results of Eqs. 2-5: fractions, rad/s; ``CAP`` in rad2/s2 per g, ``n_alpha`` in g per rad."""

    static_margin: Float[Array, ""]
    omega_sp_sq: Float[Array, ""]
    omega_sp: Float[Array, ""]
    zeta_sp: Float[Array, ""]
    zeta_ph: Float[Array, ""]
    omega_ph: Float[Array, ""]
    n_alpha: Float[Array, ""]
    CAP: Float[Array, ""]


class LongitudinalDerivatives(NamedTuple):
    """Derivatives by angle of attack, speed, pitch rate and alpha-dot, in geometry axes, per rad.

    ``_u`` is V d/dV of the coefficient at constant angle of attack: Mach number, slipstream and thrust;
    constant thrust gives ``CX_u = 2 CD`` in level flight along x. ``_q`` is by q_hat, ``_alphadot`` by
    alphadot c / 2V.
    """

    CX_alpha: ScalarLike
    CZ_alpha: ScalarLike
    Cm_alpha: ScalarLike
    CX_u: ScalarLike = 0.0
    CZ_u: ScalarLike = 0.0
    Cm_u: ScalarLike = 0.0
    CX_q: ScalarLike = 0.0
    CZ_q: ScalarLike = 0.0
    Cm_q: ScalarLike = 0.0
    CX_alphadot: ScalarLike = 0.0
    CZ_alphadot: ScalarLike = 0.0
    Cm_alphadot: ScalarLike = 0.0


class LateralDerivatives(NamedTuple):
    """Derivatives of side force, rolling and yawing moment by sideslip and by p_hat and r_hat, per rad."""

    CY_beta: ScalarLike
    Cl_beta: ScalarLike
    Cn_beta: ScalarLike
    CY_p: ScalarLike = 0.0
    Cl_p: ScalarLike = 0.0
    Cn_p: ScalarLike = 0.0
    CY_r: ScalarLike = 0.0
    Cl_r: ScalarLike = 0.0
    Cn_r: ScalarLike = 0.0


def static_margin(CZ_alpha: ScalarLike, Cm_alpha: ScalarLike) -> Float[Array, ""]:
    """Static margin about the centre of gravity as a fraction of the mean chord.

    ``SM = (x_np - x_cg) / c = -Cm_alpha / CZ_alpha``.

    Source: Granata et al., Aerosp. Sci. Technol. (2026), Eq. 2, its last form.

    Args:
        CZ_alpha: slope of the upward force coefficient, 1/rad.
        Cm_alpha: slope of the pitching moment about the centre of gravity, 1/rad.

    Returns:
        Static margin, positive for a stable aircraft.

    Valid for CZ_alpha other than zero.
    """
    return jnp.asarray(-Cm_alpha / CZ_alpha)


def neutral_point(x_cg: ScalarLike, margin: ScalarLike, c: ScalarLike) -> Float[Array, ""]:
    """Neutral point behind the nose: ``x_np = x_cg + SM c``, m (Eq. 2, its first form)."""
    return jnp.asarray(x_cg + margin * c)


def reduced_order(
    derivatives: LongitudinalDerivatives,
    flight: SteadyFlight,
    *,
    CL: ScalarLike,
    CD: ScalarLike,
    mass: ScalarLike,
    I_yy: ScalarLike,
    S: ScalarLike,
    c: ScalarLike,
) -> ReducedOrder:
    """Static margin, short period, phugoid damping and control anticipation by the reduced-order formulas.

    With ``F_za = q S CZ_alpha``, ``m_a = q S c Cm_alpha``, ``m_q = q S c^2 / 2V Cm_q``, likewise m_alphadot:

    - ``2 zeta omega = -(m_q / I - F_za / (V m) + m_alphadot / I)``
    - ``omega^2 = -m_q F_za / (I V m) - m_a / I``
    - ``zeta_ph = CD / (sqrt(2) CL)``, ``omega_ph = sqrt(2) g / V``
    - ``n_alpha = F_za / (m g)``, ``CAP = omega^2 / n_alpha``

    Source: Granata et al. (2026), Eqs. 2-5; Eq. 4 prints m_alphadot for m_alpha in its last term, corrected
    here. omega_ph by Lanchester, Etkin and Reid, Dynamics of Flight (3rd edition), section 6.3; CAP by
    MIL-F-8785C, 3.2.2.1.1.

    Args:
        derivatives: in geometry axes; those by u and the X components are not used.
        flight: steady flight; attitude is not used.
        CL: lift coefficient.
        CD: drag coefficient.
        mass: kg.
        I_yy: moment of inertia in pitch, kg m2.
        S: reference area, m2.
        c: reference chord, m.

    Returns:
        All measures. A statically unstable aircraft gets a negative ``omega_sp``, see :class:`Mode`.

    Valid for well separated modes and angles near zero; of all the aerodynamic effects of q only Cm_q is
    kept.
    """
    q_bar = 0.5 * flight.density * jnp.square(flight.speed)
    lag = c / (2.0 * flight.speed)
    heave = q_bar * S * derivatives.CZ_alpha / (mass * flight.speed)
    pitch = q_bar * S * c / I_yy
    m_q, m_alphadot = pitch * lag * derivatives.Cm_q, pitch * lag * derivatives.Cm_alphadot
    mode = second_order_mode(heave - m_q - m_alphadot, -m_q * heave - pitch * derivatives.Cm_alpha)
    n_alpha = heave * flight.speed / flight.gravity
    return ReducedOrder(
        static_margin=static_margin(derivatives.CZ_alpha, derivatives.Cm_alpha),
        omega_sp_sq=mode.omega_sq,
        omega_sp=mode.omega,
        zeta_sp=mode.zeta,
        zeta_ph=jnp.asarray(CD / (jnp.sqrt(2.0) * CL)),
        omega_ph=jnp.asarray(jnp.sqrt(2.0) * flight.gravity / flight.speed),
        n_alpha=n_alpha,
        CAP=mode.omega_sq / n_alpha,
    )


def _stack(rows: list[list[ScalarLike]]) -> Float[Array, "m n"]:
    """Matrix from nested lists of scalars."""
    return jnp.stack([jnp.stack([jnp.asarray(entry, dtype=float) for entry in row]) for row in rows])


def dimensional_longitudinal(
    derivatives: LongitudinalDerivatives,
    flight: SteadyFlight,
    *,
    mass: ScalarLike,
    S: ScalarLike,
    c: ScalarLike,
) -> tuple[Float[Array, "3 3"], Float[Array, "3 2"]]:
    """Dimensional derivatives of X, Z, M in body axes.

    With ``u = V cos(alpha)``, ``w = V sin(alpha)``, ``F = q S C(V, alpha)`` (M times c) and ``C0`` the total
    of the steady state, from equilibrium with the weight:

    - ``F_u = rho V S / 2 (cos(alpha) (2 C0 + C_u) - sin(alpha) C_alpha)``
    - ``F_w = rho V S / 2 (sin(alpha) (2 C0 + C_u) + cos(alpha) C_alpha)``
    - ``F_q = rho V S c / 4 C_q``
    - ``F_udot = -rho S c / 4 sin(alpha) C_alphadot``, ``F_wdot = rho S c / 4 cos(alpha) C_alphadot``

    Source: Etkin and Reid, Dynamics of Flight (3rd edition), table 4.4, turned from stability to body axes.

    Args:
        derivatives: in geometry axes.
        flight: steady flight.
        mass: kg.
        S: reference area, m2.
        c: reference chord, m.

    Returns:
        Rows X, Z, M: by u, w, q [3, 3] in N s/m, N s, and so on; by udot, wdot [3, 2].

    Valid for straight trimmed flight (load factor cos(theta), zero moment).
    """
    d = derivatives
    by_alpha = -_stack([[d.CX_alpha, d.CZ_alpha, -c * d.Cm_alpha]])[0]
    by_speed = -_stack([[d.CX_u, d.CZ_u, -c * d.Cm_u]])[0]
    by_q = -_stack([[d.CX_q, d.CZ_q, -c * d.Cm_q]])[0]
    by_alphadot = -_stack([[d.CX_alphadot, d.CZ_alphadot, -c * d.Cm_alphadot]])[0]
    weight = mass * flight.gravity / (0.5 * flight.density * jnp.square(flight.speed) * S)
    steady = _stack([[weight * jnp.sin(flight.theta), -weight * jnp.cos(flight.theta), 0.0]])[0]
    sine, cosine = jnp.sin(flight.alpha), jnp.cos(flight.alpha)
    per_speed = 0.5 * flight.density * flight.speed * S
    axial = 2.0 * steady + by_speed
    by_u = per_speed * (cosine * axial - sine * by_alpha)
    by_w = per_speed * (sine * axial + cosine * by_alpha)
    lag = 0.25 * flight.density * S * c
    state = jnp.stack([by_u, by_w, lag * flight.speed * by_q], axis=1)
    return state, lag * jnp.stack([-sine * by_alphadot, cosine * by_alphadot], axis=1)


def longitudinal_matrix(
    by_state: Float[Array, "3 3"],
    by_rate: Float[Array, "3 2"],
    flight: SteadyFlight,
    *,
    mass: ScalarLike,
    I_yy: ScalarLike,
) -> Float[Array, "4 4"]:
    """State matrix of (u, w, q, theta) in body axes from dimensional derivatives.

    ``m (udot + W0 q) = X - m g cos(theta0) theta``, ``m (wdot - U0 q) = Z - m g sin(theta0) theta``,
    ``I qdot = M``, ``thetadot = q``, with ``U0 = V cos(alpha)``, ``W0 = V sin(alpha)``.

    Source: Cook, Flight Dynamics Principles, chapter 4 (body axes); Etkin and Reid (3rd edition), Eq. 4.9,18.

    Args:
        by_state: rows X, Z, M by u, w, q in body axes (z down), SI.
        by_rate: the same rows by udot, wdot.
        flight: steady flight.
        mass: kg.
        I_yy: moment of inertia in pitch, kg m2.

    Returns:
        State matrix, SI and rad.

    Valid for small disturbances of straight flight.
    """
    U0, W0 = flight.speed * jnp.cos(flight.alpha), flight.speed * jnp.sin(flight.alpha)
    inertia = _stack([[mass, 0.0, 0.0], [0.0, mass, 0.0], [0.0, 0.0, I_yy]])
    inertia = inertia - jnp.pad(by_rate, ((0, 0), (0, 1)))
    kinematic = _stack([[0.0, 0.0, -mass * W0], [0.0, 0.0, mass * U0], [0.0, 0.0, 0.0]])
    weight = mass * flight.gravity
    gravity = _stack([[-weight * jnp.cos(flight.theta)], [-weight * jnp.sin(flight.theta)], [0.0]])
    upper = jnp.linalg.solve(inertia, jnp.concatenate([by_state + kinematic, gravity], axis=1))
    return jnp.concatenate([upper, jnp.asarray([[0.0, 0.0, 1.0, 0.0]])])


def longitudinal_state_matrix(
    derivatives: LongitudinalDerivatives,
    flight: SteadyFlight,
    *,
    mass: ScalarLike,
    I_yy: ScalarLike,
    S: ScalarLike,
    c: ScalarLike,
) -> Float[Array, "4 4"]:
    """State matrix of (u, w, q, theta) from coefficient derivatives.

    :func:`dimensional_longitudinal` followed by :func:`longitudinal_matrix`; equations, sources, arguments
    and validity there.
    """
    by_state, by_rate = dimensional_longitudinal(derivatives, flight, mass=mass, S=S, c=c)
    return longitudinal_matrix(by_state, by_rate, flight, mass=mass, I_yy=I_yy)


def lateral_state_matrix(
    derivatives: LateralDerivatives,
    flight: SteadyFlight,
    *,
    mass: ScalarLike,
    I_xx: ScalarLike,
    I_zz: ScalarLike,
    I_xz: ScalarLike,
    S: ScalarLike,
    b: ScalarLike,
) -> Float[Array, "4 4"]:
    """State matrix of (v, p, r, phi) in body axes from coefficient derivatives.

    ``m (vdot + U0 r - W0 p) = Y + m g cos(theta0) phi``, ``Ixx pdot - Ixz rdot = L``,
    ``Izz rdot - Ixz pdot = N``, ``phidot = p + r tan(theta0)``, with ``beta = v / V``,
    ``Y_v = rho V S / 2 CY_beta``, ``Y_p = rho V S b / 4 CY_p``; L and N times b.

    Source: Etkin and Reid, Dynamics of Flight (3rd edition), Eq. 4.9,19 and table 4.5.

    Args:
        derivatives: about body axes.
        flight: steady flight.
        mass: kg.
        I_xx: moment of inertia in roll, kg m2.
        I_zz: moment of inertia in yaw, kg m2.
        I_xz: product of inertia, the sum of m x z in body axes, kg m2.
        S: reference area, m2.
        b: reference span, m.

    Returns:
        State matrix, SI and rad.

    Valid for small disturbances of straight flight below a pitch attitude of 90 degrees.
    """
    d = derivatives
    rows = [[d.CY_beta, d.CY_p, d.CY_r], [d.Cl_beta, d.Cl_p, d.Cl_r], [d.Cn_beta, d.Cn_p, d.Cn_r]]
    lengths = _stack([[1.0, b, b]])[0]
    columns = _stack([[1.0, b / 2.0, b / 2.0]])[0]
    by_state = 0.5 * flight.density * flight.speed * S * lengths[:, None] * columns[None, :] * _stack(rows)
    U0, W0 = flight.speed * jnp.cos(flight.alpha), flight.speed * jnp.sin(flight.alpha)
    weight = mass * flight.gravity * jnp.cos(flight.theta)
    force = by_state + _stack([[0.0, mass * W0, -mass * U0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    inertia = _stack([[mass, 0.0, 0.0], [0.0, I_xx, -I_xz], [0.0, -I_xz, I_zz]])
    gravity = _stack([[weight], [0.0], [0.0]])
    upper = jnp.linalg.solve(inertia, jnp.concatenate([force, gravity], axis=1))
    return jnp.concatenate([upper, _stack([[0.0, 1.0, jnp.tan(flight.theta), 0.0]])])
