"""Profile drag of lattice strips from a parabolic polar or from a table, and the guard against stall.

A table is a tensor product of natural cubic splines over incidence, the logarithm of the Reynolds number and
the Mach number. Natural splines have no curvature at their ends, so that the linear continuation outside the
table is twice differentiable as well. The piecewise polynomials are worked out once, in numpy; a look-up is
one gather and three short sums.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float, Int

from hera_om.physics.profile_drag import section_profile_drag

Number = Float[Array, "..."] | float
Numbers = Array | np.ndarray

THIN_AIRFOIL_SLOPE = 2.0 * np.pi
"""Lift-curve slope of a thin section, 1/rad: the slope of the lattice's strips (Katz & Plotkin, eq. 5.63)."""
DRAG, MOMENT, LIFT = 0, 1, 2
ZERO, LOW, HIGH, CL_LOW, CL_HIGH = range(5)
SCAN = 20
"""Points an interval on which the ends of attached flow are looked for."""
GUARD_SHARPNESS = 50.0
"""Of the smooth least margin: n equal margins give log(n) / 50 too little, 0.08 of lift coefficient for 60."""


class StripPolar(NamedTuple):
    """Profile-drag polar of a surface: cd = cd_min (Re law) + k (cl - cl_at_cd_min)^2."""

    cd_min: Number
    cl_at_cd_min: Number
    k: Number
    re: Number
    cl_max: Number


class StripTable(NamedTuple):
    """Section coefficients over (alpha, log Re, Mach) as piecewise cubics; made by `make_table`.

    A knot array of n values bounds n + 1 cells: the outer two continue linearly. An axis with one value has
    one cell, in which nothing changes.
    """

    alpha: Float[Numbers, " na"]  # rad
    log_re: Float[Numbers, " nr"]
    mach: Float[Numbers, " nm"]
    cells: Float[Numbers, "ca cr cm 3 a b c"]  # drag, moment, lift; powers of the distance to the cell's knot
    limits: Float[Numbers, "cr cm 5 b c"]  # zero-lift, lowest and highest attached alpha (rad); cl at the latter


class StripState(NamedTuple):
    """What the polars say of s strips."""

    alpha: Float[Array, " s"]  # effective incidence, rad; analytic polar: from zero lift
    cd: Float[Array, " s"]
    cm: Float[Array, " s"]  # about the quarter chord as in the table; analytic: 0. Not applied, see `strip_state`
    cl: Float[Array, " s"]  # of the section in viscous flow at that incidence; analytic: as given
    margin: Float[Array, " s"]  # least distance of the strip's cl from either end of attached flow
    outside: Float[Array, " s"]  # largest distance from the table over the table's length; 0 inside


class StallGuard(NamedTuple):
    """Where the strips come closest to leaving attached flow."""

    least: Float[Array, ""]  # margin of lift coefficient, negative beyond the polar
    smooth: Float[Array, ""]  # smooth least margin, never above ``least``
    index: Int[Array, ""]  # among all strips
    surface: Int[Array, ""]
    strip: Int[Array, ""]  # on its surface
    y: Float[Array, ""]  # m


def make_table(alpha, reynolds, mach, *, cl, cd, cm=None) -> StripTable:
    """Spline coefficients of a polar table, in numpy, once.

    The ends of attached flow of each pair of Reynolds and Mach number are the first extremes of the lift
    coefficient on either side of zero lift, or the ends of the table where the lift has none.

    Args:
        alpha: increasing incidences, rad [na], at least 2, zero lift among them.
        reynolds: increasing Reynolds numbers [nr], at least 1.
        mach: increasing Mach numbers [nm], at least 1.
        cl: lift coefficients [na, nr, nm].
        cd: drag coefficients, same shape.
        cm: moment coefficients about the quarter chord, same shape, or None for zero.

    Returns:
        StripTable of numpy arrays.

    Raises:
        ValueError: axes or shapes that do not fit, values that are not finite, a column without zero lift.
    """
    axes = [np.asarray(alpha, float), np.log(np.asarray(reynolds, float)), np.asarray(mach, float)]
    values = [np.asarray(v, float) for v in (cd, np.zeros_like(cd) if cm is None else cm, cl)]
    _refuse(axes, values)
    a, r, m = (spline_cells(x) for x in axes)
    stacked = np.stack(values, axis=-1)
    cells = np.einsum("iax,jby,kcz,xyzf->ijkfabc", a, r, m, stacked, optimize=True)
    columns = np.stack([_attached(axes[0], a, column) for column in values[LIFT].reshape(len(axes[0]), -1).T])
    grid = columns.reshape(len(axes[1]), len(axes[2]), 5)
    limits = np.einsum("jby,kcz,yzf->jkfbc", r, m, grid, optimize=True)
    return StripTable(axes[0], axes[1], axes[2], cells, limits)


def _refuse(axes, values):
    """Errors of axes and values that make no table."""
    shape = tuple(len(x) for x in axes)
    for name, x in zip(("alpha", "log Reynolds number", "mach"), axes, strict=True):
        if not (np.all(np.isfinite(x)) and np.all(np.diff(x) > 0)):
            raise ValueError(f"{name} must be finite and increasing")
    if shape[0] < 2:
        raise ValueError("a polar table needs at least two incidences")
    for name, v in zip(("cl", "cd", "cm"), (values[LIFT], values[DRAG], values[MOMENT]), strict=True):
        if v.shape != shape or not np.all(np.isfinite(v)):
            raise ValueError(f"{name} must be finite and of shape {shape}, not {v.shape}")


def spline_cells(x) -> np.ndarray:
    """Natural cubic spline through values at knots ``x`` [n], as a matrix [n + 1, 4, n] from values to cells.

    Cell i lies before knot i, its powers count from knot i - 1 (from knot 0 in the first); the outer cells
    are straight lines. One knot: one cell [1, 1, 1].

    Source: second derivatives from the tridiagonal system of de Boor, A Practical Guide to Splines, chapter IV.
    """
    x = np.asarray(x, float)
    n = len(x)
    if n == 1:
        return np.ones((1, 1, 1))
    h, values = np.diff(x), np.eye(n)
    system, right = np.eye(n), np.zeros((n, n))
    for i in range(1, n - 1):
        system[i, i - 1 : i + 2] = h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]
        right[i] = 6.0 * ((values[i + 1] - values[i]) / h[i] - (values[i] - values[i - 1]) / h[i - 1])
    bend = np.linalg.solve(system, right)
    h = h[:, None]
    rise = np.diff(values, axis=0) / h
    slope = rise - h * (2.0 * bend[:-1] + bend[1:]) / 6.0
    last = rise[-1] + h[-1] * (bend[-2] + 2.0 * bend[-1]) / 6.0
    cells = np.zeros((n + 1, 4, n))
    cells[0, :2] = values[0], slope[0]
    cells[1:-1] = np.stack([values[:-1], slope, bend[:-1] / 2.0, np.diff(bend, axis=0) / (6.0 * h)], axis=1)
    cells[-1, :2] = values[-1], last
    return cells


def _attached(alpha, cells, column) -> np.ndarray:
    """Zero-lift incidence, ends of attached flow and lift there, of one column of the table."""
    steps = np.arange(SCAN) / SCAN
    fine = np.append((alpha[:-1, None] + np.diff(alpha)[:, None] * steps).ravel(), alpha[-1])
    local = np.append((np.diff(alpha)[:, None] * steps).ravel(), 0.0)
    index = np.append(np.repeat(np.arange(1, len(alpha)), SCAN), len(alpha))
    lift = np.einsum("pa,pax,x->p", local[:, None] ** np.arange(cells.shape[1]), cells[index], column)
    crossing = np.flatnonzero((lift[:-1] <= 0.0) & (lift[1:] > 0.0))
    if crossing.size == 0:
        raise ValueError("the lift coefficient must rise through zero within the table")
    i = crossing[np.argmin(np.abs(fine[crossing]))]
    zero = fine[i] - lift[i] * (fine[i + 1] - fine[i]) / (lift[i + 1] - lift[i])
    falls = np.flatnonzero(np.diff(lift[i + 1 :]) <= 0.0)
    high = i + 1 + falls[0] if falls.size else len(fine) - 1
    falls = np.flatnonzero(np.diff(lift[: i + 1]) <= 0.0)
    low = falls[-1] + 1 if falls.size else 0
    return np.array([zero, fine[low], fine[high], lift[low], lift[high]])


def strip_state(polar: StripPolar | StripTable, cl, reynolds, *, mach: Number) -> StripState:
    """Drag, moment, effective incidence and margin to stall of strips of known lift.

    The lattice gives the lift coefficient of a strip. In a table the drag is read at the incidence at which a
    thin section has that lift, ``alpha_e = alpha_L0(Re, M) + cl sqrt(1 - M^2) / (2 pi)``: nothing is
    inverted, and past the largest lift coefficient of the table the drag keeps rising along the polar.
    ``margin = min(cl_high - cl, cl - cl_low)`` with the ends of attached flow at the strip's Reynolds and
    Mach number; of a parabolic polar ``cl_max - |cl|``.

    Source: thin-airfoil theory, Katz & Plotkin, Low-Speed Aerodynamics 2e, section 5.3, with the
    Prandtl-Glauert slope, section 4.1; parabolic polar: `section_profile_drag`.

    Args:
        polar: parabola (numbers, or one a strip) or table.
        cl: lift coefficients of the strips on the local dynamic pressure [s].
        reynolds: Reynolds numbers on the chord [s].
        mach: Mach number of the stream, below 1.

    Returns:
        StripState.

    Valid in attached flow; outside the table by linear continuation, which ``outside`` reports. The lift of
    the lattice is not corrected by the table's, nor is its moment: ``cm`` holds the inviscid share of the camber that
    the lattice has already, on a section that need not be the lattice's.
    """
    slope = lift_slope(mach)
    if not isinstance(polar, StripTable):
        cd = section_profile_drag(
            cl, reynolds, cd_min=polar.cd_min, cl_at_cd_min=polar.cl_at_cd_min, k=polar.k, re_ref=polar.re
        )
        nothing = jnp.zeros_like(cl)
        return StripState(cl / slope, cd, nothing, cl, polar.cl_max - jnp.abs(cl), nothing)
    log_re = jnp.log(reynolds)
    machs = jnp.broadcast_to(jnp.asarray(mach, float), cl.shape)
    (r, powers_r), (m, powers_m) = _cell(polar.log_re, log_re), _cell(polar.mach, machs)
    limit = jnp.einsum("sfbc,sb,sc->sf", jnp.asarray(polar.limits)[r, m], powers_r, powers_m)
    alpha = limit[:, ZERO] + cl / slope
    i, powers_a = _cell(polar.alpha, alpha)
    found = jnp.einsum("sfabc,sc->sfab", jnp.asarray(polar.cells)[i, r, m], powers_m)
    found = jnp.einsum("sfab,sa,sb->sf", found, powers_a, powers_r)
    margin = jnp.minimum(limit[:, CL_HIGH] - cl, cl - limit[:, CL_LOW])
    beyond = [_beyond(k, x) for k, x in ((polar.alpha, alpha), (polar.log_re, log_re), (polar.mach, machs))]
    return StripState(alpha, found[:, DRAG], found[:, MOMENT], found[:, LIFT], margin, jnp.stack(beyond).max(axis=0))


def lift_slope(mach: Number) -> Float[Array, "..."]:
    """Lift-curve slope of a thin section by Prandtl and Glauert's rule, 1/rad."""
    return THIN_AIRFOIL_SLOPE / jnp.sqrt(1.0 - jnp.square(mach))


def _cell(knots, x) -> tuple[Array, Array]:
    """Index of the cell of each x, and the powers of its distance to the knot that the cell counts from."""
    if len(knots) == 1:
        return jnp.zeros(x.shape, int), jnp.ones((*x.shape, 1))
    knots = jnp.asarray(knots)
    index = jnp.searchsorted(knots, lax.stop_gradient(x), side="right", method="compare_all")
    t = x - knots[jnp.maximum(index - 1, 0)]
    return index, jnp.stack([jnp.ones_like(t), t, t**2, t**3], axis=-1)


def _beyond(knots, x) -> Array:
    """Distance from the table over its length; an axis with one value counts as constant everywhere."""
    if len(knots) == 1:
        return jnp.zeros_like(x)
    low, high = knots[0], knots[-1]
    return jnp.maximum(jnp.maximum(low - x, x - high), 0.0) / (high - low)


def strip_states(
    polars: Sequence[StripPolar | StripTable], counts: Sequence[int], cl, *, reynolds, mach: Number
) -> StripState:
    """`strip_state` of the strips of several surfaces, in one array each.

    Args:
        polars: one a surface.
        counts: strips of each surface.
        cl: lift coefficients of all strips, in the order of the surfaces [s].
        reynolds: Reynolds numbers [s].
        mach: Mach number.

    Returns:
        StripState of all strips.
    """
    if all(isinstance(p, StripPolar) for p in polars):  # one pass for all strips
        rows = [[jnp.full(n, value) for value in p] for p, n in zip(polars, counts, strict=True)]
        every = StripPolar(*(jnp.concatenate(column) for column in zip(*rows, strict=True)))
        return strip_state(every, cl, reynolds, mach=mach)
    ends = np.cumsum([0, *counts])
    parts = [
        strip_state(p, cl[a:b], reynolds[a:b], mach=mach)
        for p, a, b in zip(polars, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
    ]
    return StripState(*(jnp.concatenate(column) for column in zip(*parts, strict=True)))


def stall_guard(margin: Float[Array, " s"], counts: Sequence[int], y: Float[Array, " s"]) -> StallGuard:
    """Least margin to stall over all strips, where it is, and a smooth one for constraints.

    ``smooth = -log(sum(exp(-rho m))) / rho`` with rho = ``GUARD_SHARPNESS``: at most ``log(n) / rho`` below
    the least margin and never above it.

    Source: Kreisselmeier and Steinhauser, IFAC 1979.

    Args:
        margin: margins of the strips, see `StripState`.
        counts: strips of each surface.
        y: spanwise positions of the strips, m.

    Returns:
        StallGuard. The integers carry no derivatives: keep them in the auxiliary output of ``jacfwd``.
    """
    surface = np.repeat(np.arange(len(counts)), counts)
    strip = np.concatenate([np.arange(n) for n in counts])
    index = jnp.argmin(margin)
    least = jnp.min(margin)
    floor = lax.stop_gradient(least)
    smooth = floor - jnp.log(jnp.sum(jnp.exp(-GUARD_SHARPNESS * (margin - floor)))) / GUARD_SHARPNESS
    return StallGuard(least, smooth, index, jnp.asarray(surface)[index], jnp.asarray(strip)[index], y[index])
