"""Lattice alone: AVL, textbook wings, theory; invariants; each case also a row of docs/validation.md.

Functions named ``*_rows`` give (case, quantity, reference, ours, tolerance, source); tolerances are relative
unless the reference is zero. ``docs/make_validation.py`` prints the same rows.
"""

import csv
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics import lattice as module
from hera_om.physics.aero_cases import Flow
from hera_om.physics.coupling import Controls, Setting, System, normals, onset
from hera_om.physics.geometry import CAMBER, FLAT, Sections, make_grid, make_panels
from hera_om.physics.lattice import Half, Lattice, assemble, ring_velocities, shapes, solve
from hera_om.physics.lattice_forces import filament_forces, filament_strengths, resultant, strip_loads, trefftz
from hera_om.physics.layout import layout

AVL = "AVL 3, recorded in VortexLattice.jl"


class Polar(NamedTuple):
    """Coefficients of a wing, and their derivatives by alpha, q_hat and the control."""

    CL: float
    CD: float
    CDi: float
    Cm: float
    by: np.ndarray
    cl: np.ndarray


def table(path):
    """Rows of a reference file, comments skipped."""
    return list(csv.DictReader(line for line in path.open() if not line.startswith("#")))


def hold(rows):
    """Every row is within its tolerance."""
    for case, quantity, expected, ours, tolerance, _ in rows:
        assert ours == pytest.approx(expected, rel=tolerance, abs=0.0 if expected else tolerance), (
            case,
            quantity,
        )


def tolerance_of(value, digits):
    """Half a unit of the last digit printed, relative."""
    return 0.501 * 10.0**-digits / abs(value)


_panels = jax.jit(make_panels, static_argnums=2)


@jax.jit
def _influence(points, surfaces, beta):
    return sum(ring_velocities(points, surfaces, beta))


@jax.jit
def _solved(panels, state, mach, S, c, point):
    lattice, _ = assemble(panels, mach)
    lay = layout(shapes(panels))
    at = Setting(System(lattice, (None, None), None), None, Flow(1.0, 1.0, 1.0, 1.0, mach, point), c, 1.0)

    def coefficients(v):
        x = Controls(v[0], v[1], *[jnp.zeros(0)] * 3)
        wash = onset(lattice.collocation, x, at)
        gamma = solve(lattice.even, -jnp.sum(wash * normals(lattice, x.delta), axis=-1))
        velocity = onset(lattice.points, x, at) + lattice.even.velocity @ gamma
        loads = strip_loads(lattice, lay, filament_forces(lattice, filament_strengths(lay, gamma), velocity))
        force, moment = resultant([loads], lay, point)
        wind = jnp.array([[jnp.cos(v[0]), 0.0, jnp.sin(v[0])], [-jnp.sin(v[0]), 0.0, jnp.cos(v[0])]])
        drag, lift = wind @ force
        out = jnp.stack([lift, drag, trefftz(lattice, lay, gamma)[1], moment[1] / c]) / S
        return out, (out, loads.force @ wind[1] / (lattice.strip_chord * lattice.strip_width))

    by, (values, cl) = jax.jacfwd(coefficients, has_aux=True)(state)
    return values, by, cl


def wing(sections, nc, ns, *, alpha=0.0, mach=0.0, S, c=1.0, point=(0.0, 0.0, 0.0), shape=FLAT, **cut):
    """A wing from rows (x_le, y, z, chord, twist in deg), at alpha in degrees."""
    columns = [jnp.asarray(v, float) for v in zip(*sections, strict=True)]
    sec = Sections(*columns[:4], jnp.radians(columns[4]))
    airfoils = cut.pop("airfoils", ["flat"] * len(sections))
    grid = make_grid(sec.y, airfoils, nc=nc, ns=ns, **(dict(span="uniform", chord="uniform") | cut))
    state, at = jnp.array([np.radians(alpha), 0.0]), jnp.asarray(point, float)
    values, by, cl = _solved([_panels(sec, grid, shape)], state, mach, S, c, at)
    return Polar(*[float(v) for v in values], np.asarray(by), np.asarray(cl))


SIMPLE = [(0.0, 0.0, 0.0, 2.2, 2.0), (0.4, 7.5, 0.0, 1.8, 2.0)]


def simple_wing(nc=1, span="uniform", shape=FLAT, **changes):
    """The simple wing of AVL's reference runs."""
    given = dict(alpha=1.0, S=30.0, c=2.0, point=(0.5, 0.0, 0.0), span=span, shape=shape)
    return wing(SIMPLE, nc, 12, **(given | changes))


def simple_wing_rows(reference, shape=FLAT, tolerance=None):
    """Coefficients of the three runs; AVL prints five decimals."""
    out = []
    for run in table(reference / "avl_simplewing.csv"):
        ours = simple_wing(int(run["nchord"]), run["spacing"].split()[0], shape)
        for column, value in zip(("CL", "CD_near", "CD_trefftz", "Cm"), ours[:4], strict=True):
            expected = float(run[column])
            # on strips of unequal width the near field depends on where on a filament its force is taken
            exact = 0.0025 if column == "CD_near" else tolerance_of(expected, 5)
            allowed = exact if tolerance is None else tolerance
            out.append((f"AVL simple wing, run {run['run']}", column, expected, value, allowed, AVL))
    return out


def simple_wing_derivative_rows(reference):
    """Longitudinal derivatives of run 1 (run 11 there); AVL prints six decimals."""
    printed = {row["derivative"]: float(row["value"]) for row in table(reference / "avl_simplewing_derivatives.csv")}
    by = simple_wing().by
    ours = {"CLalpha": by[0, 0], "Cmalpha": by[3, 0], "Cmq": by[3, 1]}
    return [
        ("AVL simple wing, run 1", k, printed[k], float(v), tolerance_of(printed[k], 6), AVL) for k, v in ours.items()
    ]


def strip_rows(reference):
    """Section lift of every strip of run 1; AVL prints four decimals."""
    printed = [float(row["cl"]) for row in table(reference / "avl_strip_cl.csv")]
    cl = [float(v) for v in simple_wing().cl]
    pairs = enumerate(zip(printed, cl, strict=True), 1)
    return [("AVL simple wing, run 1", f"cl of strip {i}", a, b, tolerance_of(a, 4), AVL) for i, (a, b) in pairs]


def planar_cases(reference):
    """Value and tolerance of the textbook wings."""
    rows = table(reference / "vlm_planar_cases.csv")
    return {(r["case"], r["quantity"]): (float(r["value"]), float(r["tolerance"])) for r in rows}


def warren_rows(reference):
    """Warren-12: the pointed centre makes convergence first order, so two meshes are extrapolated so."""
    half = np.sqrt(2.0)
    sections = [(0.0, 0.0, 0.0, 1.5, 0.0), (half * np.tan(np.radians(53.54)), half, 0.0, 0.5, 0.0)]
    coarse, fine = (wing(sections, n, 2 * n, S=2 * half).by for n in (4, 8))
    limit = 2 * fine - coarse
    cases, source = planar_cases(reference), "Warren-12, SURFACES manual p. 109 after NASA SP-405"
    return [
        ("Warren-12, extrapolated", name, value, float(limit[i, 0]), tolerance / abs(value), source)
        for i, name in ((0, "CLalpha"), (3, "Cmalpha"))
        for value, tolerance in [cases["warren12", name]]
    ]


def bertin_rows(reference):
    """Bertin's hand lattice of four horseshoe vortices: 1 x 4, not the converged value."""
    value, tolerance = planar_cases(reference)["bertin_swept45", "CLalpha"]
    sections = [(0.0, 0.0, 0.0, 1.0, 0.0), (2.5, 2.5, 0.0, 1.0, 0.0)]
    ours = float(wing(sections, 1, 4, S=5.0).by[0, 0])
    source = "Bertin & Smith, example 7.2"
    return [("Bertin, sweep 45, lattice 1 x 4", "CLalpha", value, ours, tolerance / value, source)]


def elliptic(ar, strips, *, straight=0.25, tip=1e-3):
    """An elliptic wing of unit span with a straight line at a fraction of the chord; CDi over CL^2 / pi AR.

    The lattice has its own area, that of the polygon; the last chord is ``tip`` of the root's, not zero.
    """
    y = 0.5 * np.sin(np.linspace(0.0, np.pi / 2, strips + 1))
    chord = 4 / (np.pi * ar) * np.sqrt(np.maximum(1 - 4 * y**2, 0.0))
    chord[-1] = tip * chord[0]
    area = 2 * np.trapezoid(chord, y)
    rows = [(-straight * c, v, 0.0, c, 5.0) for c, v in zip(chord, y, strict=True)]
    ours = wing(rows, 1, strips, S=area, span="sine")
    return ours.CDi * np.pi / (ours.CL**2 * area)


def elliptic_rows(reference):
    """CDi of elliptic wings at CL 0.5; the lattice's own load is elliptic but for lifting-surface effects."""
    out = []
    for row in table(reference / "elliptic_wing.csv"):
        if row["AR"] in ("6", "12", "20"):
            value = float(row["CDi_at_CL0p5"])
            ours = value * float(elliptic(float(row["AR"]), 40))
            out.append((f"elliptic wing, AR {row['AR']}", "CDi at CL 0.5", value, ours, 0.005, "CL^2 / (pi AR)"))
    return out


def rectangular(ar, n, **changes):
    """CL by alpha and the aerodynamic centre of a flat rectangular wing of unit chord."""
    sections = [(0.0, 0.0, 0.0, 1.0, 0.0), (0.0, ar / 2, 0.0, 1.0, 0.0)]
    by = wing(sections, n, 6 * n, S=ar, span="cosine", **changes).by
    return np.array([by[0, 0], -by[3, 0] / by[0, 0]])


def rectangular_rows(reference):
    """Rectangular wings, extrapolated at second order from two meshes."""
    out, source = [], "independent horseshoe lattice, extrapolated (0.5 %)"
    for row in table(reference / "rect_wing_CLalpha.csv"):
        if row["AR"] in ("4", "8", "12"):
            ar = float(row["AR"])
            coarse, fine = rectangular(ar, 2), rectangular(ar, 4)
            limit, case = fine + (fine - coarse) / 3, f"rectangular wing, AR {row['AR']}, extrapolated"
            out.append((case, "CLalpha", float(row["CLa_lifting_surface"]), float(limit[0]), 0.005, source))
            out.append((case, "x_ac / c", float(row["x_ac_over_c"]), float(limit[1]), 0.005, source))
    return out


def test_avl_simple_wing(reference):
    """Every digit that AVL prints, on its own lattice."""
    hold(simple_wing_rows(reference))


def test_avl_simple_wing_derivatives(reference):
    hold(simple_wing_derivative_rows(reference))


def test_avl_strip_lift(reference):
    hold(strip_rows(reference))


def test_the_camber_shape_stays_near_avl(reference):
    """Panels on the twisted surface, the default, differ from AVL's untwisted panels by less than 0.4 %."""
    hold(simple_wing_rows(reference, CAMBER, 0.004))
    assert abs(simple_wing(shape=CAMBER).CL / simple_wing().CL - 1) > 1e-4


def test_warren(reference):
    hold(warren_rows(reference))


def test_bertin(reference):
    hold(bertin_rows(reference))


def test_elliptic_wing(reference):
    hold(elliptic_rows(reference))


def test_what_is_left_of_the_elliptic_wing_is_its_lifting_surface():
    """The excess over CL^2 / pi AR is no error of the lattice: it is there on any number of strips and for
    any tip.

    It follows which line of the planform is straight, and goes with 1 / AR^2: lifting lines are its limit.
    """
    excess = elliptic(6.0, 40) - 1
    assert 0.001 < excess < 0.0015
    assert elliptic(6.0, 40, tip=1e-2) - 1 == pytest.approx(excess, abs=5e-5)
    assert elliptic(6.0, 20) - 1 == pytest.approx(excess, abs=2e-4)
    assert elliptic(6.0, 40, straight=0.0) - 1 > 3 * excess
    assert elliptic(6.0, 40, straight=0.5) - 1 < excess / 2
    assert elliptic(20.0, 40) - 1 < excess / 3


def test_an_elliptic_load_has_exactly_the_least_drag():
    """Sine-spaced strips with the condition at the middle of the law: exact on any number of strips."""
    for strips in (4, 20):
        grid = make_grid([0.0, 0.5], ["flat"] * 2, nc=1, ns=strips, span="sine", chord="uniform")
        edges = grid.weights @ np.array([0.0, 0.5])
        middle = edges[:-1] + grid.middle * np.diff(edges)
        wake = part(trail=flat_trace(edges), trail_middle=flat_trace(middle))
        lift, drag = trefftz(wake, layout([(1, strips)]), jnp.sqrt(1 - jnp.asarray(2 * middle) ** 2))
        assert float(np.pi * drag / lift**2) == pytest.approx(1.0, rel=1e-9)


def part(**fields):
    """A lattice of which only some fields are there."""
    return Lattice(**(dict.fromkeys(Lattice._fields) | fields))


def flat_trace(y):
    """Points of a wake trace at z = 0."""
    return jnp.stack([jnp.asarray(y), jnp.zeros(len(y))], axis=-1)


def test_rectangular_wings(reference):
    hold(rectangular_rows(reference))


def test_observed_order_on_a_rectangular_wing():
    """Each halving of the panels quarters the error of lift and aerodynamic centre."""
    a, b, c = (rectangular(4.0, n) for n in (2, 4, 8))
    np.testing.assert_allclose(np.log2((b - a) / (c - b)), 2.0, atol=0.2)


def test_goethert_rule():
    """Flat wing at Mach M: lift of the wing stretched along x by 1 / beta, again over beta, exactly."""
    mach = 0.6
    beta = np.sqrt(1 - mach**2)
    slender = [(0.0, 0.0, 0.0, 1.0 / beta, 0.0), (0.5 / beta, 2.0, 0.0, 0.6 / beta, 0.0)]
    wide = [(0.0, 0.0, 0.0, 1.0, 0.0), (0.5, 2.0, 0.0, 0.6, 0.0)]
    here = wing(wide, 2, 12, S=1.0, mach=mach)
    there = wing(slender, 2, 12, S=1.0 / beta, c=1.0 / beta)
    np.testing.assert_allclose(here.by[:, 0] * beta, there.by[:, 0], rtol=1e-10)


def test_compressible_slope():
    """2 pi / beta at a very high aspect ratio; at a common one the change by the rule of Helmbold and
    Polhamus.

    CL_alpha = 2 pi AR / (2 + sqrt(beta^2 AR^2 + 4)), NACA TN 3911.
    """
    mach = 0.6
    assert rectangular(1000.0, 4, mach=mach)[0] == pytest.approx(2 * np.pi / 0.8, rel=0.01)
    rule = (2 + np.sqrt(8.0**2 + 4)) / (2 + np.sqrt(0.8**2 * 8.0**2 + 4))
    assert rectangular(8.0, 4, mach=mach)[0] / rectangular(8.0, 4)[0] == pytest.approx(rule, rel=0.006)


@pytest.mark.parametrize("mach", [0.0, 0.5])
def test_the_field_is_a_potential_of_the_stretched_equation(mach):
    """Curl v = 0 and (1 - M^2) du/dx + dv/dy + dw/dz = 0 off the vortices; symmetry is a wall."""
    surface = two_strips("NACA 2412")

    @jax.jit
    def velocity(p, beta):
        return _influence(p[None], [surface], beta)[0] @ jnp.array([1.0, 0.6])

    beta, gradient_of = module.prandtl_glauert(jnp.asarray(mach)), jax.jit(jax.jacfwd(velocity))
    for p in ([1.0, 1.5, 0.7], [3.0, 5.0, -0.8], [-1.0, 8.5, 0.2]):
        gradient = np.asarray(gradient_of(jnp.array(p), beta))
        assert np.max(np.abs(gradient)) > 1e-3
        np.testing.assert_allclose(gradient, gradient.T, atol=1e-12)
        assert (1 - mach**2) * gradient[0, 0] + gradient[1, 1] + gradient[2, 2] == pytest.approx(0.0, abs=1e-12)
    assert float(velocity(jnp.array([1.0, 0.0, 0.7]), beta)[1]) == pytest.approx(0.0, abs=1e-15)


def two_strips(airfoil):
    """The simple wing as two panels."""
    columns = [jnp.asarray(v, float) for v in zip(*SIMPLE, strict=True)]
    grid = make_grid(columns[1], [airfoil] * 2, nc=1, ns=2, span="uniform", chord="uniform")
    return _panels(Sections(*columns[:4], jnp.radians(columns[4])), grid, CAMBER)


def test_the_half_model_is_the_whole_wing():
    """The port half, modelled in its own place, makes the same flow; the flow is a mirror image of itself."""
    surface, mirror = two_strips("flat"), jnp.array([1.0, -1.0, 1.0])
    port = surface._replace(rings=(surface.rings * mirror)[:, ::-1])
    p, beta = jnp.array([[1.3, 2.1, 0.4]]), jnp.asarray(1.0)
    starboard, left = (_influence(p, [s], beta) for s in (surface, port))
    np.testing.assert_allclose(left[..., ::-1], starboard, rtol=1e-12)
    np.testing.assert_allclose(_influence(p * mirror, [surface], beta), starboard * mirror[:, None], rtol=1e-12)


def cambered(scale=1.0, shift=(0.0, 0.0), alpha=3.0, middle=None):
    """A cambered, swept, twisted wing of the mesh 6 x 12, scaled, moved, and cut at a collinear section."""
    rows = [(0.0, 0.0, 0.1, 2.0, 1.0), (1.2, 6.0, 0.5, 1.0, 1.0)]
    if middle is not None:
        rows.insert(1, tuple(a + (b - a) * middle for a, b in zip(*rows, strict=True)))
    rows = [((x + shift[0]) * scale, y * scale, (z + shift[1]) * scale, c * scale, t) for x, y, z, c, t in rows]
    point = ((0.5 + shift[0]) * scale, 0.0, shift[1] * scale)
    given = dict(S=18.0 * scale**2, c=1.5 * scale, point=point, shape=CAMBER, airfoils=["NACA 2412"] * len(rows))
    return wing(rows, 6, 12, alpha=alpha, mach=0.3, **given)


@settings(max_examples=6)
@given(st.floats(0.1, 30.0), st.floats(-20.0, 20.0), st.floats(-3.0, 3.0))
def test_scale_and_place_do_not_matter(scale, x, z):
    """But for the core of the wake lines, which is a length."""
    here, there = cambered(), cambered(scale, (x, z))
    np.testing.assert_allclose(there[:4], here[:4], rtol=1e-7)
    np.testing.assert_allclose(there.by, here.by, rtol=1e-6, atol=1e-7)


def test_a_collinear_section_changes_nothing():
    whole, split = cambered(), cambered(middle=0.5)
    np.testing.assert_allclose(split[:4], whole[:4], rtol=1e-12)
    np.testing.assert_allclose(split.cl, whole.cl, rtol=1e-12)


def test_circulation_is_linear_in_small_incidence():
    """Lift between two incidences lies on the straight line but for the cosine; drag on the parabola."""
    low, mid, high = (cambered(alpha=a) for a in (0.0, 1.0, 2.0))
    assert mid.CL == pytest.approx((low.CL + high.CL) / 2, rel=1e-3)
    # CDi is a quadratic of CL: no third difference over four incidences
    drag = np.array([low.CDi, mid.CDi, high.CDi, cambered(alpha=3.0).CDi])
    assert abs(np.diff(drag, 3)[0]) < 1e-3 * drag[-1]


def test_layout_of_two_surfaces():
    """Panels (1, 2) and (2, 1): neighbours of every filament, strips, trailing nodes; 4 is nothing."""
    lay = layout([(1, 2), (2, 1)])
    assert lay.counts == (2, 2) and lay.strips == (2, 1)
    # bound 0 1, chordwise of three edges (the root's cancels with its image); bound 2 3, chordwise 2 x 2
    np.testing.assert_array_equal(lay.plus, [0, 1, 4, 0, 1, 2, 3, 4, 2, 4, 3])
    np.testing.assert_array_equal(lay.minus, [4, 4, 4, 1, 4, 4, 2, 4, 4, 4, 4])
    np.testing.assert_array_equal(lay.inner, [0, 1, 0, 0, 1, 2, 2, 2, 2, 2, 2])
    np.testing.assert_array_equal(lay.outer, [0, 1, 0, 1, 1, 2, 2, 2, 2, 2, 2])
    np.testing.assert_array_equal(lay.last, [0, 1, 3])
    np.testing.assert_array_equal(lay.trail_plus, [3, 0, 1, 3, 2])
    np.testing.assert_array_equal(lay.trail_minus, [0, 1, 3, 2, 3])
    np.testing.assert_array_equal(lay.node, [0, 1, 3])
    assert layout([]).plus.shape == (0,)


def test_solve_is_exact_in_both_modes():
    """Derivatives through the kept factorisation: right-hand side and matrix, against the closed form."""
    matrix = jnp.array([[2.0, 0.3], [-0.4, 1.5]])
    half = Half(matrix, jax.scipy.linalg.lu_factor(matrix), jnp.zeros((0, 3, 2)))
    rhs, change = np.array([1.0, -2.0]), np.array([[0.1, 0.2], [0.3, -0.1]])

    def first(t):
        return solve(half._replace(matrix=matrix + t * change), jnp.asarray(rhs))[0]

    inverse = np.linalg.inv(np.asarray(matrix))
    slope = -(inverse @ change @ inverse @ rhs)[0]
    curve = 2 * (inverse @ change @ inverse @ change @ inverse @ rhs)[0]
    assert float(jax.jacfwd(first)(0.0)) == pytest.approx(slope, rel=1e-12)
    assert float(jax.jacrev(first)(0.0)) == pytest.approx(slope, rel=1e-12)
    assert float(jax.jacfwd(jax.jacfwd(first))(0.0)) == pytest.approx(curve, rel=1e-12)
