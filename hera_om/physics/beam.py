"""Finite elements of a cantilever along its elastic axis: deflection, twist, natural frequencies.

Euler-Bernoulli bending up and torsion, coupled by the distance of the mass from the axis. Each node has deflection,
slope and twist; elements are cubic in deflection and linear in twist, stiffness and mass linear along them.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax.scipy.linalg import solve_triangular
from jaxtyping import Array, Float

# Gauss points of an element: exact for cubic shapes (curvature linear) with linear stiffness and mass.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_X = 0.5 * (1.0 + _POINTS)
_W = 0.5 * _WEIGHTS


class BeamProperties(NamedTuple):
    """A beam at n stations along its axis, of length coordinate s, m, clamped at the first."""

    s: Float[Array, "n"]
    EI: Float[Array, "n"]
    """N m2, bending of the tip upwards."""
    GJ: Float[Array, "n"]
    """N m2."""
    mass: Float[Array, "n"]
    """kg/m."""
    static_moment: Float[Array, "n"]
    """Mass times the distance of its centre aft of the axis, kg."""
    inertia: Float[Array, "n"]
    """Mass moment of inertia about the axis, kg m; at least static_moment^2 / mass."""


class BeamDeflection(NamedTuple):
    """Deflection up, m, its slope, rad, and twist nose-up, rad, at the stations."""

    w: Float[Array, "n"]
    slope: Float[Array, "n"]
    twist: Float[Array, "n"]


class BeamModes(NamedTuple):
    """Natural frequencies, rad/s, ascending, and shapes [mode, 3, n]: deflection, slope, twist."""

    omega: Float[Array, "m"]
    shape: Float[Array, "m 3 n"]


def _hermite(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cubic shapes and their second derivatives for ends w1, l t1, w2, l t2, at x in 0..1."""
    value = np.stack([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    second = np.stack([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])
    return value, second


_CUBIC, _CURVED = _hermite(_X)
_LINEAR = np.stack([1 - _X, _X])
_BEND = np.array([0, 1, 3, 4])  # w, slope of both ends among w, slope, twist, w, slope, twist
_TURN = np.array([2, 5])


def _element_matrices(beam: BeamProperties) -> tuple[Float[Array, "e 6 6"], Float[Array, "e 6 6"]]:
    """Stiffness and consistent mass of the elements."""
    length = jnp.diff(beam.s)

    scale = jnp.stack([jnp.ones_like(length), length, jnp.ones_like(length), length], axis=1)
    curved = scale[:, :, None] * _CURVED / jnp.square(length)[:, None, None]
    deflected = scale[:, :, None] * _CUBIC
    turned, rate = jnp.asarray(_LINEAR), jnp.array([-1.0, 1.0])[:, None] / length[:, None, None] * np.ones(len(_X))
    weight = _W * length[:, None]
    bend = jnp.einsum("eag,ebg,eg->eab", curved, curved, weight * _at(beam.EI))
    twist = jnp.einsum("eag,ebg,eg->eab", rate, rate, weight * _at(beam.GJ))
    heave = jnp.einsum("eag,ebg,eg->eab", deflected, deflected, weight * _at(beam.mass))
    pitch = jnp.einsum("ag,bg,eg->eab", turned, turned, weight * _at(beam.inertia))
    # A point aft of the axis moves up by w - x theta when the nose turns up.
    both = -jnp.einsum("eag,bg,eg->eab", deflected, turned, weight * _at(beam.static_moment))
    zero = jnp.zeros((length.shape[0], 6, 6))
    bending, turning = np.ix_(_BEND, _BEND), np.ix_(_TURN, _TURN)
    stiffness = zero.at[:, *bending].set(bend).at[:, *turning].set(twist)
    mass = zero.at[:, *bending].set(heave).at[:, *turning].set(pitch)
    mass = mass.at[:, *np.ix_(_BEND, _TURN)].set(both).at[:, *np.ix_(_TURN, _BEND)].set(jnp.swapaxes(both, 1, 2))
    return stiffness, mass


def _assembled(elements: Float[Array, "e 6 6"]) -> Float[Array, "d d"]:
    """Global matrix without the clamped node."""
    count = elements.shape[0]
    place = 3 * np.arange(count)[:, None] + np.arange(6)
    whole = jnp.zeros((3 * count + 3, 3 * count + 3))
    return whole.at[place[:, :, None], place[:, None, :]].add(elements)[3:, 3:]


def deflection(
    beam: BeamProperties, *, shear: Float[Array, "n"], bending: Float[Array, "n"], torque: Float[Array, "n"]
) -> BeamDeflection:
    """Deflection of a cantilever under given section loads: statically determinate, so its curvature is known.

    w'' = M / EI, theta' = T / GJ (Megson, ch. 16.8 and 18.1). In each bay M is the cubic through the ends' values
    and slopes, dM/ds = -V, T is linear; integrals by four Gauss points.

    Args:
        beam: stiffness at n stations.
        shear: upward shear of what is outboard, N [n].
        bending: tip-up bending moment, N m [n].
        torque: nose-up torque, N m [n].

    Returns:
        Deflection, slope and twist at the stations; exact for loads that are linear in each bay on beams whose
        stiffness is constant there.
    """
    length = jnp.diff(beam.s)
    ends = jnp.stack([bending[:-1], -length * shear[:-1], bending[1:], -length * shear[1:]], axis=1)
    curvature = ends @ _CUBIC / _at(beam.EI)
    rate = _at(torque) / _at(beam.GJ)
    turn = curvature @ _W * length
    lever = curvature @ (_W * (1.0 - _X)) * jnp.square(length)
    slope = _summed(turn)
    return BeamDeflection(_summed(slope[:-1] * length + lever), slope, _summed(rate @ _W * length))


def modes(beam: BeamProperties, count: int) -> BeamModes:
    """Lowest natural modes of the cantilever: K u = omega^2 M u with consistent masses.

    Bisplinghoff, Ashley, Halfman, Aeroelasticity, ch. 3 and 4. The generalised problem becomes symmetric by the
    Cholesky factor of M.

    Args:
        beam: stiffness and mass at n stations.
        count: modes wanted.

    Returns:
        Frequencies and shapes, of unit generalised mass. Differentiable where no two frequencies are equal.
    """
    stiffness, mass = (_assembled(m) for m in _element_matrices(beam))
    factor = jnp.linalg.cholesky(mass)
    half = solve_triangular(factor, stiffness, lower=True)
    square, vectors = jnp.linalg.eigh(solve_triangular(factor, half.T, lower=True))
    shapes = solve_triangular(factor.T, vectors[:, :count], lower=False).T.reshape(count, -1, 3)
    free = jnp.swapaxes(shapes, 1, 2)
    return BeamModes(jnp.sqrt(square[:count]), jnp.pad(free, ((0, 0), (0, 0), (1, 0))))


def first_of_each(beam: BeamProperties, count: int = 8) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Frequencies, rad/s, of the lowest mode that is mostly bending and of the lowest that is mostly torsion."""
    found = modes(beam, count)
    turns = torsion_share(beam, found) > 0.5
    return found.omega[jnp.argmin(turns)], found.omega[jnp.argmax(turns)]


def torsion_share(beam: BeamProperties, found: BeamModes) -> Float[Array, "m"]:
    """Share of a mode's strain energy that is in twist: near 1 for torsion, near 0 for bending."""
    rate = jnp.diff(found.shape[:, 2], axis=1) / jnp.diff(beam.s)
    energy = jnp.sum(0.5 * (beam.GJ[1:] + beam.GJ[:-1]) * jnp.square(rate) * jnp.diff(beam.s), axis=1)
    return energy / jnp.square(found.omega)


def _at(values: Float[Array, "n"]) -> Float[Array, "e g"]:
    """Values at the Gauss points of the elements, linear between the stations."""
    return values[:-1, None] * _LINEAR[0] + values[1:, None] * _LINEAR[1]


def _summed(steps: Float[Array, "e"]) -> Float[Array, "n"]:
    """Running sum from zero at the clamp."""
    return jnp.concatenate([jnp.zeros(1), jnp.cumsum(steps)])
