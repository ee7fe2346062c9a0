"""The flow of a semi-infinite vortex tube: exactly by elliptic integrals, and fast by harmonics of its disk."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.section_polar import ScalarLike

AGM_STEPS = 8
"""Steps of Bulirsch's iteration, which converges quadratically: to 1e-15 for kc > 1e-6."""
MODES = 5
"""Harmonics of a disk, the last of which closes the load at the edge (choice: see the theory page)."""
FAR, FAR_FROM, FAR_TERMS = 6.0, 2, 3
"""Spheroidal distance, about radii from the hub, beyond which harmonics from the given one on are summed in so many
inverse powers: their closed forms cancel there. At the change both agree to 1e-9 of the velocity at the disk."""


def complete_elliptic(
    kc: Float[Array, "*n"], p: Float[Array, "*n"], a: Float[Array, "*n"], b: Float[Array, "*n"]
) -> Float[Array, "*n"]:
    """Bulirsch's complete elliptic integral, K, E and Pi in one.

    ``cel(kc, p, a, b) = int_0^(pi/2) (a cos^2 t + b sin^2 t) / ((cos^2 t + p sin^2 t) sqrt(cos^2 t + kc^2 sin^2
    t)) dt``, so that K = cel(kc, 1, 1, 1), E = cel(kc, 1, 1, kc^2) and Pi(n) = cel(kc, 1 - n, 1, 1).

    Source: Bulirsch, Numerische Mathematik 13 (1969) 305-315, here with a fixed number of steps.

    Arguments:
        kc: complementary modulus, from 1e-6 to 1.
        p: above zero.
        a: weight of cos^2.
        b: weight of sin^2.

    Returns:
        The integral, analytic in every argument.
    """
    root = jnp.sqrt(p)
    total, part = a + b / p, 2.0 * (b / root + a * kc / root)
    pp, em, product = kc / root + root, 1.0 + kc, kc
    for _ in range(AGM_STEPS):
        k = 2.0 * jnp.sqrt(product)
        product = k * em
        ratio = product / pp
        total, part = total + part / pp, 2.0 * (part + total * ratio)
        pp, em = ratio + pp, k + em
    return 0.5 * jnp.pi * (part + total * em) / (em * (em + pp))


def tube_velocity(
    x: Float[Array, "*n"], r: Float[Array, "*n"], radius: ScalarLike, *, core: ScalarLike
) -> tuple[Float[Array, "*n"], Float[Array, "*n"]]:
    """Axial and radial velocity of a right cylinder of vortex rings from x = 0 aft, 1 at its disk and 2 far behind.

    With g = (R - r) / (R + r), s^2 = x^2 + (R + r)^2 and kc^2 = (x^2 + (R - r)^2) / s^2,

        u_x = (2 / pi) R / (R + r) [x / s cel(kc, g^2, 1, g) + cel(1, g^2, 1, g)],
        u_r = (2 / pi) R / s cel(kc, 1, 1, -1).

    Source: Branlard and Gaunaa, Wind Energy 18 (2015) 1973-1987, in K, E and Pi; this form, regular on
    the axis, is that of the solenoid, Derby and Olbert, American Journal of Physics 78 (2010) 229-235.

    Arguments:
        x: distance behind the disk, m.
        r: distance from the axis, not negative, m.
        radius: R, m.
        core: distance, m, that (R - r)^2 is increased by the square of: it rounds the sheet and the ring at its
            front, and changes the velocity at a distance d from the sheet by about (core / 2d)^2.

    Returns:
        Velocities over the axial one at the disk, analytic in every argument for core > 0.
    """
    near, wide = (radius - r) ** 2 + core**2, (radius + r) ** 2
    s = jnp.sqrt(x**2 + wide + core**2)
    kc = jnp.sqrt(x**2 + near) / s
    p, g, one = near / wide, (radius - r) / (radius + r), jnp.ones_like(kc)
    plane = 0.5 * jnp.pi * (1.0 + g / jnp.sqrt(p)) / (1.0 + jnp.sqrt(p))
    axial = (x / s * complete_elliptic(kc, p, one, g) + plane) * radius / (radius + r)
    radial = radius / s * complete_elliptic(kc, one, one, -one)
    return 2.0 / jnp.pi * axial, 2.0 / jnp.pi * radial


def _harmonics(modes: int) -> list[tuple[np.ndarray, ...]]:
    """Polynomials, ascending, of every even harmonic P(nu) e(eta): P, and alpha, omega and the tail of e.

    e = alpha acot(eta) + omega is Legendre's function of the second kind of i eta with e'(0) = 1, which decays as
    eta^-(degree + 1) times the tail, a series in eta^-2 that its differential equation gives.
    """
    poly, eta, out = np.polynomial.polynomial, np.array([0.0, 1.0]), []
    alpha, omega, legendre = [np.array([1.0]), eta], [np.array([0.0]), np.array([-1.0])], np.polynomial.legendre
    for degree in range(1, 2 * modes - 1):
        sign = 1.0 if degree % 2 == 0 else -1.0
        for f in (alpha, omega):
            f.append(
                poly.polysub(sign * (2 * degree + 1) * poly.polymul(eta, f[degree]), degree * f[degree - 1])
                / (degree + 1)
            )
    for degree in range(0, 2 * modes, 2):
        slope = (omega[degree][1] if degree else 0.0) - alpha[degree][0]  # of acot: -1 at zero
        tail = [np.prod(np.arange(1, degree + 1) / np.arange(3.0, 2 * degree + 2, 2)) * (-1.0) ** (degree // 2)]
        for s in range(degree + 1, degree + 1 + 2 * (FAR_TERMS - 1), 2):
            tail.append(-tail[-1] * s * (s + 1) / ((s + 2) * (s + 1) - degree * (degree + 1)))
        p = legendre.leg2poly(np.eye(degree + 1)[degree])
        out.append((p, alpha[degree] / slope, omega[degree] / slope, np.array(tail) / slope))
    return out


HARMONICS = _harmonics(MODES)
EDGE = np.array([p[0] for p, *_ in HARMONICS])
"""The harmonics at the edge of the disk, where the load must vanish."""


def _rows(of: int, first: int, derivative: int = 0) -> np.ndarray:
    """Every second coefficient of one of the polynomials of all harmonics, or of its derivative, [power, harmonic]."""
    rows = [np.polynomial.polynomial.polyder(h[of], derivative)[first::2] for h in HARMONICS]
    out = np.zeros((max(map(len, rows)), MODES))
    for n, row in enumerate(rows):
        out[: len(row), n] = row
    return out


P, STEEP = _rows(0, 0), _rows(0, 1, 1)
ALPHA, OMEGA, ALPHA_SLOPE, OMEGA_SLOPE = _rows(1, 0), _rows(2, 1), _rows(1, 1, 1), _rows(2, 0, 1)
TAIL = np.array([h[3] for h in HARMONICS]).T
POWER = 2 * np.arange(MODES) + 1
FALL = TAIL * (POWER + 2 * np.arange(FAR_TERMS)[:, None])


def _horner(coefficients: np.ndarray, x: Array) -> Array:
    """Polynomials with ascending coefficients [power, harmonic] at x [..., 1]."""
    total = jnp.broadcast_to(jnp.asarray(coefficients[-1]), (*x.shape[:-1], coefficients.shape[1]))
    for row in coefficients[-2::-1]:
        total = total * x + row
    return total


def _decay(eta: Array, acot: Array) -> tuple[Array, Array]:
    """e(eta) of all harmonics and its derivative, at eta [..., 1]."""
    square = eta**2
    a = _horner(ALPHA, square)
    near = a * acot + eta * _horner(OMEGA, square)
    slope = eta * _horner(ALPHA_SLOPE, square) * acot - a / (1.0 + square) + _horner(OMEGA_SLOPE, square)
    inverse = 1.0 / jnp.maximum(eta, FAR)
    power = inverse**POWER
    far, fall = power * _horner(TAIL, inverse**2), -power * inverse * _horner(FALL, inverse**2)
    there = (eta > FAR) & (np.arange(MODES) >= FAR_FROM)
    return jnp.where(there, far, near), jnp.where(there, fall, slope)


def disk_amplitudes(edges: Float[Array, " ne"], values: Float[Array, " nr"], radius: ScalarLike) -> Float[Array, " k"]:
    """Amplitudes of the harmonics of a disk that moves the air through it by ``values`` between ``edges``.

    ``b_n = (4n + 1) / R^2 int v P_2n(nu) r dr``, exactly for steps: the multipoles of the disk, mass flow first.
    The last is given up to close the sum at the edge, sum b_n P_2n(0) = 0, where it would be singular.

    Source: orthogonality of Legendre polynomials in nu = sqrt(1 - r^2 / R^2).

    Arguments:
        edges: radii where the steps begin and end, ascending up to the radius, m.
        values: mean axial velocities at the disk between them, m/s.
        radius: R, m.

    Returns:
        Amplitudes, m/s; linear in ``values``.
    """
    square = jnp.maximum(1.0 - (edges / radius) ** 2, 0.0)
    out = []
    for n in range(MODES - 1):
        even = HARMONICS[n][0][::2] / (2.0 * np.arange(1, n + 2))
        integral = square * _horner(even[:, None], square[:, None])[:, 0]
        out.append((4 * n + 1) * jnp.sum(values * (integral[:-1] - integral[1:])))
    given = jnp.stack(out)
    return jnp.append(given, -(EDGE[:-1] @ given) / EDGE[-1])


def disk_velocity(
    x: Float[Array, " n"], r2: Float[Array, " n"], radius: ScalarLike, *, amplitudes: Float[Array, " k"]
) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Flow of a disk of sinks: axial velocity, and radial velocity over the distance from the axis.

    In oblate spheroidal coordinates x = R nu eta, r^2 = R^2 (1 - nu^2) (1 + eta^2) the potential of the sinks is
    -R sum b_n P_2n(nu) e_n(eta); at the disk they move the air towards it by v = sum b_n P_2n(nu) / nu. A vortex
    tube of any radial load is 2 v(r) inside, behind the disk, and this flow, which is free of vorticity and
    divergence everywhere off the disk.

    Source: Lamb, Hydrodynamics, 6th ed. (1932), art. 107-108; for actuator disks Conway, Journal of Fluid Mechanics
    297 (1995) 327-355.

    Arguments:
        x: distance behind the disk, above zero, m; ahead of it the axial velocity changes sign.
        r2: square of the distance from the axis, m^2.
        radius: R, m.
        amplitudes: b of `disk_amplitudes`, m/s.

    Returns:
        Axial velocity, m/s, and radial velocity over r, 1/s.
    """
    axial, radial = _disk_flow(x / radius, r2 / radius**2, amplitudes)
    return axial, radial / radius


@jax.custom_jvp
def _disk_flow(z: Float[Array, " n"], q: Float[Array, " n"], amplitudes: Float[Array, " k"]):
    """Axial velocity and radial one over r for R = 1 at z and r^2 = q.

    Two variables enter besides the amplitudes, however many derivatives are taken at once: the rule finds the
    slopes by both of them once for all.
    """
    return tuple(part @ amplitudes for part in _unit_flow(z, q))


@_disk_flow.defjvp
def _disk_flow_rule(primals, tangents):
    z, q, amplitudes = primals
    unit, by_z = jax.jvp(_unit_flow, (z, q), (jnp.ones_like(z), jnp.zeros_like(q)))
    by_q = jax.jvp(_unit_flow, (z, q), (jnp.zeros_like(z), jnp.ones_like(q)))[1]
    change = [
        tangents[0] * (dz @ amplitudes) + tangents[1] * (dq @ amplitudes) + part @ tangents[2]
        for part, dz, dq in zip(unit, by_z, by_q, strict=True)
    ]
    return tuple(part @ amplitudes for part in unit), tuple(change)


def _unit_flow(z: Float[Array, " n"], q: Float[Array, " n"]) -> tuple[Float[Array, "n k"], Float[Array, "n k"]]:
    """Velocities of every harmonic."""
    a = z**2 + q - 1.0
    big = 0.5 * (jnp.abs(a) + jnp.sqrt(a**2 + 4.0 * z**2))
    eta = jnp.sqrt(jnp.where(a >= 0.0, big, z**2 / big))
    nu = z / eta
    acot = 0.5 * jnp.pi - jnp.arctan(eta)
    eta, nu, acot = eta[:, None], nu[:, None], acot[:, None]
    nu2, eta2 = nu**2, eta**2
    scale = 1.0 / (nu2 + eta2)
    e, slope = _decay(eta, acot)
    value, steep = _horner(P, nu2), _horner(STEEP, nu2)  # P, P' / nu
    along = -nu * scale * (steep * e * eta * (1.0 - nu2) + value * slope * (1.0 + eta2))
    return along, scale * (nu2 * steep * e - eta * value * slope)
