"""Section polars of blades, seven numbers a station or a table, behind one interface.

A table is a tensor product of cubic splines: periodic over the full circle of incidence, natural over the
logarithm of the Reynolds number and over the Mach number. A stream fixes the last two for every element, so
that a look-up within the search for the inflow angle is one row of the table and one sum.
"""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Array, Float

from hera_om.physics.section_polar import SectionPolar, prandtl_glauert, section_coefficients, soft_clip
from hera_om.physics.strip_polar import spline_cells

Field = Float[Array, "nr npsi"]
Column = Float[Array, "nr 1"]
Numbers = Array | np.ndarray

AXIS_MARGIN = 0.1
"""Reynolds and Mach number level off smoothly within this many half ranges beyond the table (choice): a blade
at rest has a Reynolds number of nothing, to which no table can be continued."""
LINEAR_LIFT = 0.035
"""Half range of incidence about zero lift, rad, over which the slope of the lift line is taken (choice, 2
degrees)."""
SCAN = 2001
"""Points on which zero lift is looked for."""
LIFT, DRAG = 0, 1


class BladeTable(NamedTuple):
    """Section coefficients over incidence, log Reynolds and Mach number; made by ``make_blade_table``."""

    r: Float[Numbers, " ns"]
    """Radii of the sections over the tip radius; after ``at_elements`` those of the elements."""
    alpha: Float[Numbers, " na"]
    """Knots, rad, over one turn, the first not repeated."""
    log_re: Float[Numbers, " nre"]
    mach: Float[Numbers, " nm"]
    re_cells: Float[Numbers, "cre 4 nre"]
    mach_cells: Float[Numbers, "cm 4 nm"]
    cells: Float[Numbers, "ns na 8 k"]
    """Four powers of lift, then of drag, from each knot on, for all k pairs of Reynolds and Mach number."""
    lines: Float[Numbers, "ns 2 k"]
    """Slope of the lift (1/rad) and incidence of zero lift (rad) of all pairs."""


class TableRows(NamedTuple):
    """A table at the Reynolds and Mach numbers of every element."""

    alpha: Float[Array, " na"]
    rows: Float[Array, "rows 8 k"]
    first: Column
    """Row of each element's first cell."""
    weights: Float[Array, "nr npsi k"]
    slope: Field
    alpha0: Field


Polar = SectionPolar | BladeTable
PolarInFlow = SectionPolar | TableRows


def make_blade_table(alpha, reynolds, mach, *, cl, cd, r=(1.0,)) -> BladeTable:
    """Spline coefficients of a polar table over full incidence, in numpy, once.

    Arguments:
        alpha: incidences from -pi to pi, rad, increasing [na]; the values at the two ends must agree.
        reynolds: increasing Reynolds numbers [nre], one if it has no influence.
        mach: increasing Mach numbers [nm], one if it has no influence.
        cl: lift coefficients [na, nre, nm], or [ns, na, nre, nm] for several sections.
        cd: drag coefficients, same shape.
        r: radii of the sections over the tip radius, increasing [ns].

    Returns:
        BladeTable of numpy arrays, twice continuously differentiable.

    Raises:
        ValueError: incidences short of the full circle (see ``full_incidence``), axes or shapes that do not fit,
            a drag that is not positive, a column whose lift does not rise through zero near zero incidence.
    """
    alpha, r = np.asarray(alpha, float), np.asarray(r, float)
    axes = [alpha, np.log(np.asarray(reynolds, float)), np.asarray(mach, float)]
    shape = (len(r), *(len(x) for x in axes))
    lift, drag = (np.asarray(v, float).reshape(shape) if np.size(v) == np.prod(shape) else v for v in (cl, cd))
    _refuse(axes, r, lift, drag, shape)
    count = shape[2] * shape[3]
    columns = np.stack([lift, drag]).reshape(2, len(r), len(alpha), count)
    power = np.einsum("apx,fsxk->safpk", _periodic_cells(alpha), columns[:, :, :-1])
    lines = np.stack([[_lift_line(alpha, column) for column in section.T] for section in columns[LIFT]])
    cells = power.reshape(len(r), len(alpha) - 1, 8, count)
    re_cells, mach_cells = (_axis_cells(x) for x in axes[1:])
    return BladeTable(r, alpha[:-1], axes[1], axes[2], re_cells, mach_cells, cells, np.swapaxes(lines, 1, 2))


def _axis_cells(x) -> np.ndarray:
    """``spline_cells`` with always four powers."""
    cells = spline_cells(x)
    return np.concatenate([cells, np.zeros((len(cells), 4 - cells.shape[1], len(x)))], axis=1)


def _refuse(axes, r, lift, drag, shape) -> None:
    """Errors of axes and values that make no table."""
    names = ("alpha", "log Reynolds number", "mach", "r")
    for name, x in zip(names, (*axes, r), strict=True):
        if not (x.ndim == 1 and x.size and np.all(np.isfinite(x)) and np.all(np.diff(x) > 0)):
            raise ValueError(f"{name} of a blade polar must be finite and increasing")
    low, high = axes[0][0], axes[0][-1]
    if abs(low + np.pi) > 1e-6 or abs(high - np.pi) > 1e-6:
        text = f"a blade polar from {np.degrees(low):.6g} to {np.degrees(high):.6g} deg does not cover the incidences"
        raise ValueError(f"{text} of a blade, -180 to 180 deg: extend it with full_incidence")
    for name, v in (("cl", lift), ("cd", drag)):
        if np.shape(v) != shape or not np.all(np.isfinite(v)):
            raise ValueError(f"{name} of a blade polar must be finite and of shape {shape}, not {np.shape(v)}")
        if np.max(np.abs(v[:, 0] - v[:, -1])) > 1e-6:
            raise ValueError(f"{name} of a blade polar must be the same at -180 and at 180 deg")
    if np.min(drag) <= 0.0:
        raise ValueError(f"cd of a blade polar must be positive, not {np.min(drag):g}")


def _periodic_cells(x) -> np.ndarray:
    """Periodic cubic spline at knots ``x`` [n + 1] as a matrix [n, 4, n] from values to powers from each knot.

    Source: second derivatives from the cyclic system of de Boor, A Practical Guide to Splines, chapter IV.
    """
    h = np.diff(x)
    n = len(h)
    eye = np.eye(n)
    after, before, last = np.roll(eye, 1, axis=1), np.roll(eye, -1, axis=1), np.roll(h, 1)
    rise = (after - eye) / h[:, None]
    system = np.diag(2.0 * (last + h)) + last[:, None] * before + h[:, None] * after
    bend = np.linalg.solve(system, 6.0 * (rise - np.roll(rise, 1, axis=0)))
    next_bend = np.roll(bend, -1, axis=0)
    slope = rise - h[:, None] * (2.0 * bend + next_bend) / 6.0
    return np.stack([eye, slope, bend / 2.0, (next_bend - bend) / (6.0 * h[:, None])], axis=1)


def resampled(alpha, values, at) -> np.ndarray:
    """Values [na, ...] over full incidence at other incidences, by the spline that a table has anyway."""
    power = np.einsum("apx,x...->ap...", _periodic_cells(alpha), values[:-1])
    i = np.clip(np.searchsorted(alpha, at, side="right") - 1, 0, len(alpha) - 2)
    t = (at - alpha[i]).reshape(-1, *(1,) * (values.ndim - 1))
    a, b, c, d = (power[i, p] for p in range(4))
    return a + t * (b + t * (c + t * d))


def _lift_line(alpha, lift) -> tuple[float, float]:
    """Slope about zero lift and incidence of zero lift, of one column; none where there is no lift at all."""
    if np.max(np.abs(lift)) == 0.0:
        return 0.0, 0.0
    fine = np.linspace(-0.5, 0.5, SCAN)
    values = np.interp(fine, alpha, lift)
    crossing = np.flatnonzero((values[:-1] <= 0.0) & (values[1:] > 0.0))
    if crossing.size == 0:
        raise ValueError("the lift of a blade polar must rise through zero within 0.5 rad of zero incidence")
    i = crossing[np.argmin(np.abs(fine[crossing]))]
    zero = fine[i] - values[i] * (fine[i + 1] - fine[i]) / (values[i + 1] - values[i])
    ends = np.interp([zero - LINEAR_LIFT, zero + LINEAR_LIFT], alpha, lift)
    return (ends[1] - ends[0]) / (2.0 * LINEAR_LIFT), zero


def at_elements(polar: Polar, x: Float[Array, " nr"]) -> Polar:
    """Polar of every element: seven numbers as they are, a table linearly between its sections.

    Arguments:
        polar: of the sections.
        x: radii of the elements over the tip radius.
    """
    if not isinstance(polar, BladeTable):
        return polar
    r = jnp.asarray(polar.r)
    if r.shape[0] == 1:
        return polar._replace(r=x, cells=_repeat(polar.cells, len(x)), lines=_repeat(polar.lines, len(x)))
    i = jnp.clip(jnp.searchsorted(r, x) - 1, 0, r.shape[0] - 2)
    t = jnp.clip((x - r[i]) / (r[i + 1] - r[i]), 0.0, 1.0)[:, None, None]
    cells, lines = jnp.asarray(polar.cells), jnp.asarray(polar.lines)
    blended = (1.0 - t[..., None]) * cells[i] + t[..., None] * cells[i + 1]
    return polar._replace(r=x, cells=blended, lines=(1.0 - t) * lines[i] + t * lines[i + 1])


def _repeat(values, n: int) -> Array:
    return jnp.repeat(jnp.asarray(values), n, axis=0)


def _column(values) -> Column:
    return jnp.reshape(jnp.asarray(values, dtype=float), (-1, 1))


def polar_in_flow(polar: Polar, mach: Field, reynolds: Field | None) -> PolarInFlow:
    """The polar of every element at its Mach and Reynolds number, which its incidence does not change.

    Arguments:
        polar: seven numbers, or a table after ``at_elements``.
        mach: Mach number of the undisturbed stream at every element.
        reynolds: Reynolds number on the chord likewise; None where the polar does not depend on it.

    Raises:
        ValueError: a table over the Reynolds number without one.
    """
    if isinstance(polar, SectionPolar):
        columns = SectionPolar(*(_column(value) for value in polar))
        factor = 1.0 + columns.compressible * (prandtl_glauert(mach) - 1.0)
        return columns._replace(cl_alpha=columns.cl_alpha * factor, compressible=0.0)
    if reynolds is None and len(polar.log_re) > 1:
        raise ValueError("a polar table over the Reynolds number needs the viscosity of the air")
    by_re = _axis_weights(polar.log_re, polar.re_cells, jnp.zeros_like(mach) if reynolds is None else jnp.log(reynolds))
    by_mach = _axis_weights(polar.mach, polar.mach_cells, mach)
    weights = (by_re[..., :, None] * by_mach[..., None, :]).reshape(*mach.shape, -1)
    line = jnp.einsum("sfk,spk->fsp", jnp.asarray(polar.lines), weights)
    n, na = polar.cells.shape[:2]
    rows = jnp.asarray(polar.cells).reshape(n * na, 8, -1)
    return TableRows(jnp.asarray(polar.alpha), rows, jnp.arange(n)[:, None] * na, weights, line[0], line[1])


def _axis_weights(knots, cells, x: Field) -> Float[Array, "nr npsi n"]:
    """What each knot's values count at ``x``: a natural spline, levelling off beyond the knots."""
    if len(knots) == 1:
        return jnp.ones((*x.shape, 1))
    knots, cells = jnp.asarray(knots), jnp.asarray(cells)
    middle, half = 0.5 * (knots[0] + knots[-1]), 0.5 * (knots[-1] - knots[0]) * (1.0 + AXIS_MARGIN)
    x = middle + half * soft_clip((x - middle) / half, 1.0 / (1.0 + AXIS_MARGIN))
    i = jnp.searchsorted(knots, lax.stop_gradient(x), side="right", method="compare_all")
    t = x - knots[jnp.maximum(i - 1, 0)]
    a, b, c, d = (cells[:, p][i] for p in range(4))
    t = t[..., None]
    return a + t * (b + t * (c + t * d))


def flow_coefficients(polar: PolarInFlow, alpha: Field) -> tuple[Field, Field]:
    """Lift and drag coefficients at any incidence, rad."""
    if isinstance(polar, SectionPolar):
        return section_coefficients(polar, alpha, jnp.zeros((1, 1)))
    turn = 2.0 * jnp.pi
    alpha = alpha - turn * jnp.floor(lax.stop_gradient(alpha - polar.alpha[0]) / turn)
    i = jnp.searchsorted(polar.alpha, lax.stop_gradient(alpha), side="right", method="scan_unrolled") - 1
    t = alpha - polar.alpha[i]
    power = jnp.einsum("rpfk,rpk->frp", polar.rows[polar.first + i], polar.weights)
    cl, cd = (power[f] + t * (power[f + 1] + t * (power[f + 2] + t * power[f + 3])) for f in (0, 4))
    return cl, cd


def lift_line(polar: PolarInFlow) -> tuple[Array, Array]:
    """Lift slope (1/rad) and zero-lift incidence (rad) of attached flow at every element."""
    if isinstance(polar, SectionPolar):
        return jnp.asarray(polar.cl_alpha), jnp.asarray(polar.alpha0)
    return polar.slope, polar.alpha0
