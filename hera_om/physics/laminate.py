"""Symmetric laminates: stiffness of membrane and plate from the plies, first-ply failure by Tsai and Wu.

Axis 1 of a ply runs along its fibres, at its angle from x towards y; x is the axis of the laminate. A sheet of any
thickness has the same stacking, its plies scaled: the thickness is a continuous number.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.buckling import k_compression, k_shear

ScalarLike = Float[Array, ""] | float | int
ArrayLike = Float[Array, "..."] | float | int

# F12 / sqrt(F11 F22): with it an isotropic ply of equal strengths fails by von Mises. Tsai & Hahn, Introduction to
# Composite Materials (1980), ch. 7.
INTERACTION = -0.5
# In-plane bending of a simply supported plate over that of the isotropic one: a + (1 - a) beta. From the Galerkin
# solution with sines, within 0.3 % for beta from 0.2 to 3.
BENDING_SHARE = 0.562
_TINY = 1e-12  # keeps the square root differentiable without shear, as in `buckling`


class Ply(NamedTuple):
    """Unidirectional ply: moduli and strengths (all positive) in Pa."""

    E1: ScalarLike
    E2: ScalarLike
    G12: ScalarLike
    nu12: ScalarLike
    Xt: ScalarLike
    Xc: ScalarLike
    Yt: ScalarLike
    Yc: ScalarLike
    S: ScalarLike


class Laminate(NamedTuple):
    """A laminate of unit thickness; stresses are means over the thickness in the order x, y, xy."""

    A: Float[Array, "3 3"]
    """Membrane stiffness over thickness, Pa."""
    D: Float[Array, "3 3"]
    """Bending stiffness times 12 / t^3, Pa."""
    quadratic: Float[Array, "k 3 3"]
    """A ply fails where s . quadratic . s + linear . s = 1; one of each angle; 1/Pa^2."""
    linear: Float[Array, "k 3"]


class Flexure(NamedTuple):
    """Bending stiffness times 12 / t^3 of a specially orthotropic plate, Pa: along x, along y, D12 + 2 D66."""

    along: ScalarLike
    across: ScalarLike
    mixed: ScalarLike


def reduced_stiffness(ply: Ply) -> Float[Array, "3 3"]:
    """Plane-stress stiffness of a ply on its axes, Pa. Jones, Mechanics of Composite Materials 2e, ch. 2.6."""
    nu21 = ply.nu12 * ply.E2 / ply.E1
    whole = 1.0 - ply.nu12 * nu21
    values = [ply.E1 / whole, ply.nu12 * ply.E2 / whole, ply.E2 / whole, ply.G12]
    q11, q12, q22, q66 = (jnp.asarray(v, float) for v in values)
    zero = jnp.zeros_like(q11)
    return jnp.stack([jnp.stack([q11, q12, zero]), jnp.stack([q12, q22, zero]), jnp.stack([zero, zero, q66])])


def strain_rotation(angles: np.ndarray) -> Float[Array, "k 3 3"]:
    """Strains (with engineering shear) on the axes of plies at these angles, rad, from those on x and y."""
    c, s = jnp.cos(angles), jnp.sin(angles)
    rows = [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]]
    return jnp.stack([jnp.stack(row, axis=-1) for row in rows], axis=-2)


def tsai_wu(ply: Ply) -> tuple[Float[Array, "3 3"], Float[Array, "3"]]:
    """F_ij, 1/Pa^2, and F_i, 1/Pa, of a ply on its axes: F_i s_i + F_ij s_i s_j = 1 at failure.

    F_11 = 1 / (Xt Xc), F_1 = 1 / Xt - 1 / Xc, alike for 2, F_66 = 1 / S^2, F_12 by ``INTERACTION``: Tsai and Wu,
    J. Composite Materials 5 (1971) 58-80.
    """
    f11, f22, f66 = (jnp.asarray(1.0 / v, float) for v in (ply.Xt * ply.Xc, ply.Yt * ply.Yc, ply.S * ply.S))
    f12, zero = INTERACTION * jnp.sqrt(f11 * f22), jnp.zeros_like(f11)
    second = [jnp.stack([f11, f12, zero]), jnp.stack([f12, f22, zero]), jnp.stack([zero, zero, f66])]
    first = [1.0 / ply.Xt - 1.0 / ply.Xc, 1.0 / ply.Yt - 1.0 / ply.Yc, zero]
    return jnp.stack(second), jnp.stack([jnp.asarray(v, float) for v in first])


def make_laminate(ply: Ply, angles: np.ndarray) -> Laminate:
    """Laminate of equal plies, symmetric about its middle plane.

    A is the mean of the turned Q; D weighs it by the difference of the cubes of a ply's faces (Jones, ch. 4.2). A ply
    bears the stress Q R A^-1 s, R its `strain_rotation`; `tsai_wu` on the ply's axes is carried back to s.

    Args:
        ply: elastic constants and strengths.
        angles: of the plies from a face to the middle plane, rad [k].

    Returns:
        The laminate. Residual stress of curing and moisture are left out, and what remains after the first failure.
    """
    own, turn = reduced_stiffness(ply), strain_rotation(angles)
    turned = jnp.swapaxes(turn, 1, 2) @ own @ turn
    faces = (1.0 - np.arange(len(angles) + 1) / len(angles)) ** 3
    membrane = jnp.mean(turned, axis=0)
    # A ply that stands twice would count twice in smooth maxima.
    distinct = np.unique(angles, return_index=True)[1]
    local = own @ turn[distinct] @ jnp.linalg.inv(membrane)
    second, first = tsai_wu(ply)
    bending = jnp.tensordot(jnp.asarray(faces[:-1] - faces[1:]), turned, axes=1)
    return Laminate(membrane, bending, jnp.swapaxes(local, 1, 2) @ second @ local, first @ local)


def moduli(laminate: Laminate) -> Float[Array, "4"]:
    """E_x, E_y, G_xy, Pa, and nu_xy of the membrane. Jones, ch. 4.2: from the inverse of A."""
    give = jnp.linalg.inv(laminate.A)
    return jnp.stack([1.0 / give[0, 0], 1.0 / give[1, 1], 1.0 / give[2, 2], -give[0, 1] / give[0, 0]])


def strength(laminate: Laminate, direction: Float[Array, "3"] | np.ndarray) -> Float[Array, ""]:
    """Mean stress along a direction of (x, y, xy) at which the first ply fails, Pa.

    The positive root R of R^2 d . F d + R f . d = 1, the least of all plies.
    """
    a = jnp.einsum("kij,i,j->k", laminate.quadratic, direction, direction)
    b = laminate.linear @ direction
    return jnp.min(2.0 / (b + jnp.sqrt(jnp.square(b) + 4.0 * a)))


def shear_use(laminate: Laminate, direct: Float[Array, "..."], shear: Float[Array, "..."]) -> Float[Array, "k ..."]:
    """Shear over the shear that each ply bears beside a direct stress along x: Tsai and Wu solved for shear.

    With L = 1 - F_xx s^2 - F_x s left by the direct stress, u = (c + sqrt(c^2 + 4 L F_ss tau^2)) / (2 L),
    c = (2 F_xs s + F_s) tau: one where the ply fails, in proportion to the shear.

    Args:
        laminate: the laminate.
        direct: mean stress along x, Pa, inside its strength.
        shear: mean shear stress, Pa, of the same shape.
    """
    one = (slice(None),) + (None,) * jnp.ndim(direct)
    f, g = laminate.quadratic, laminate.linear
    left = 1.0 - f[:, 0, 0][one] * jnp.square(direct) - g[:, 0][one] * direct
    cross = (2.0 * f[:, 0, 2][one] * direct + g[:, 2][one]) * shear
    root = jnp.sqrt(jnp.square(cross) + 4.0 * left * (f[:, 2, 2][one] * jnp.square(shear) + _TINY))
    return 0.5 * (cross + root) / left


def flexure(modulus: ScalarLike, poisson: ScalarLike, laminate: Laminate | None) -> Flexure:
    """Bending of a sheet: of its laminate, or the isotropic E / (1 - nu^2) without one. D16 and D26 are left out."""
    if laminate is None:
        plate = modulus / (1.0 - jnp.square(poisson))
        return Flexure(plate, plate, plate)
    d = laminate.D
    return Flexure(d[0, 0], d[1, 1], d[0, 1] + 2.0 * d[2, 2])


def compression_stress(f: Flexure, length: ArrayLike, width: ArrayLike) -> Float[Array, "..."]:
    """Critical stress at unit thickness of a simply supported plate compressed along x, Pa/m2.

    min over m of pi^2 sqrt(D11 D22) / (t b^2) ((m / phi)^2 + (phi / m)^2 + 2 beta), phi = (a / b) (D22 / D11)^(1/4),
    beta = (D12 + 2 D66) / sqrt(D11 D22): Jones, ch. 5, in the affine form.

    Args:
        f: bending of the plate.
        length: a, along the load, m.
        width: b, m.
    """
    mean, beta, stretch = _affine(f)
    return _euler(mean, width) * k_compression(length / width * stretch, beta)


def shear_stress(f: Flexure, length: ArrayLike, width: ArrayLike) -> Float[Array, "..."]:
    """Critical shear stress at unit thickness of a simply supported plate, Pa/m2.

    pi^2 (D11 D22^3)^(1/4) k / (t b^2), see `buckling.k_shear`. Against the Galerkin solution for beta from 0.2 to
    2.4: 3.5 % low at most, 2 % high at most; at 3 it is 7 % low.
    """
    mean, beta, stretch = _affine(f)
    return _euler(mean * stretch, width) * k_shear(length / width * stretch, beta)


def bending_stress(f: Flexure, k: ArrayLike, width: ArrayLike) -> Float[Array, "..."]:
    """Critical stress at the edge, unit thickness, of a plate bent in its plane, Pa/m2; k of the isotropic plate."""
    mean, beta, _ = _affine(f)
    return _euler(mean, width) * k * (BENDING_SHARE + (1.0 - BENDING_SHARE) * beta)


def _affine(f: Flexure) -> tuple[Array, Array, Array]:
    """sqrt(D11 D22), beta, and what stretches the length over the width."""
    mean = jnp.sqrt(f.along * f.across)
    return mean, f.mixed / mean, jnp.sqrt(jnp.sqrt(f.across / f.along))


def _euler(stiffness: ArrayLike, width: ArrayLike) -> Array:
    """pi^2 D / (t b^2) at unit thickness."""
    return jnp.asarray(jnp.pi**2 * stiffness / (12.0 * jnp.square(width)))
