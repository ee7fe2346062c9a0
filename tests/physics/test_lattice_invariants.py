"""What cannot matter to a lattice: the axes, which side is which, and where a surface is divided."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from hera_om.physics.aero_cases import Body, Drag, Flow, Model, StripPolar, Surface
from hera_om.physics.aerodynamics import evaluate
from hera_om.physics.coupling import Controls, Setting, make_system, panel_layout
from hera_om.physics.equilibrium import find_root, settle
from hera_om.physics.geometry import CAMBER, FLAT, Sections, cut, make_grid, segment_weights
from hera_om.physics.layout import FREE, ROOTED, SINGLE

NO_DRAG = StripPolar(0.0, 0.0, 0.0, 1e6, 10.0)
S, C, B = 9.0, 1.4, 7.0
BODY = Body(S, C, B, 0.0, Drag(*[jnp.zeros(1)] * 3, jnp.zeros((1, 1))))
POINT = np.array([0.7, 0.2, 0.1])
NAMES = ("CL", "CD", "CX", "CZ", "Cm", "CY", "Cl", "Cn")
ANGLE = st.floats(-0.15, 0.15)
RATE = st.floats(-0.05, 0.05)


@partial(jax.jit, static_argnames="model")
def _found(x, surfaces, point, *, model):
    """Everything at one state, wake along the stream where the model says so."""
    flow = Flow(*[jnp.asarray(v) for v in (1.0, 1.0, 340.0, 1e-5, 0.0)], point)
    at = Setting(make_system(surfaces, None, None, flow.mach, model, alpha=x.alpha), None, flow, C, B)
    equilibrium, _ = settle(find_root(x, at, None), x, at, None)
    polars, lay = [s.polar for s in surfaces], panel_layout(surfaces, model)
    return evaluate(equilibrium, x, polars, at=at, plan=None, body=BODY, lay=lay)


def found(surfaces, *, alpha, q=0.0, lateral=(), point=POINT, model):
    """Coefficients, their derivatives and the drag in the Trefftz plane."""
    x = Controls(*[jnp.asarray(v, float) for v in (alpha, q, np.zeros(0), np.zeros(0), lateral)])
    out = _found(x, surfaces, jnp.asarray(point), model=model)
    return dict(zip(NAMES, out.total, strict=True)), dict(zip(NAMES, out.derivatives, strict=True)), out.drag.CDi


def surface(rows, grid):
    """From rows (x_le, y, z, chord, twist)."""
    sections = Sections(*[jnp.asarray(v, float) for v in zip(*rows, strict=True)])
    return Surface(sections, grid, NO_DRAG, jnp.arange(len(rows), dtype=float))


def plain(ns, airfoil, nc=2, k=2):
    """Equal panels."""
    return make_grid(np.arange(float(k)), [airfoil] * k, nc=nc, ns=ns, span="uniform", chord="uniform")


# About the y axis: wing and tail with straight trailing edges, which stay in planes of constant height.

WING, TAIL = ((0.0, 0.0, 0.0, 1.7), (0.6, 3.0, 0.0, 1.1)), ((4.0, 0.0, 0.5, 0.9), (4.3, 1.2, 0.5, 0.6))
GRIDS = plain(4, "NACA 2412"), plain(2, "flat")
STREAM = Model((ROOTED, ROOTED), stream_wake=True)


def nose_up(point, angle):
    """A point (x, z) of a body that turns about the y axis."""
    c, s = np.cos(angle), np.sin(angle)
    return point[0] * c + point[1] * s, point[1] * c - point[0] * s


def turned(rows, angle):
    """Sections of a surface that turns with the body; they turn about their quarter chords themselves."""
    out = []
    for x_le, y, z, chord in rows:
        x, z = nose_up((x_le + chord / 4, z), angle)
        out.append((x - chord / 4, y, z, chord, angle))
    return out


@settings(max_examples=5)
@given(st.floats(-0.4, 0.4), ANGLE, RATE)
def test_pitch_of_geometry_and_stream_together(angle, alpha, q):
    """Lift, drag, moment and all derivatives know only the angle between body and stream."""
    here, there = (
        found(
            [surface(turned(rows, t), grid) for rows, grid in zip((WING, TAIL), GRIDS, strict=True)],
            alpha=alpha - t,
            q=q,
            point=np.array([*nose_up((POINT[0], POINT[2]), t), 0.0])[[0, 2, 1]],
            model=STREAM,
        )
        for t in (0.0, angle)
    )
    for name in ("CL", "CD", "Cm"):
        np.testing.assert_allclose(there[0][name], here[0][name], rtol=1e-8, atol=1e-10)
        np.testing.assert_allclose(there[1][name], here[1][name], rtol=1e-7, atol=1e-8)
    np.testing.assert_allclose(there[2], here[2], rtol=1e-8, atol=1e-10)


# About the x axis, and across the plane of symmetry: a swept, twisted wing of which only one side is there.

ODD = np.array([[0.0, -2.0, 0.3, 1.6, 0.04], [0.3, 0.5, 0.0, 1.9, 0.02], [0.9, 3.0, 0.2, 1.0, -0.03]])
ODD_GRID = plain(6, "NACA 2412", k=3)
ALONE = Model((SINGLE,), 0, FLAT, lateral=True)


def state_of(wind, omega):
    """Incidence, pitch rate, and sideslip with the other rates, of a stream and a rotation in geometry axes."""
    alpha, beta = np.arctan2(wind[2], wind[0]), -np.arcsin(wind[1])
    return dict(alpha=alpha, q=omega[1] * C / 2, lateral=(beta, -omega[0] * B / 2, -omega[2] * B / 2))


def vectors(total):
    """Force and moment in geometry axes."""
    force = np.array([total["CX"], total["CY"], total["CZ"]])
    return force, np.array([-B * total["Cl"], C * total["Cm"], -B * total["Cn"]])


@settings(max_examples=5)
@given(st.floats(-3.0, 3.0), ANGLE, ANGLE, RATE, RATE, RATE)
def test_roll_of_geometry_and_stream_together(angle, alpha, beta, p, q, r):
    """Force and moment turn with the surface, the stream and the rates, at any angle."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    wind = np.array([np.cos(alpha) * np.cos(beta), -np.sin(beta), np.sin(alpha) * np.cos(beta)])
    omega = np.array([p, q, r])
    rows = ODD.copy()
    rows[:, 1:3] = rows[:, 1:3] @ turn[1:, 1:].T
    here = found([surface(ODD, ODD_GRID)], **state_of(wind, omega), model=ALONE)
    there = found([surface(rows, ODD_GRID)], **state_of(turn @ wind, turn @ omega), point=turn @ POINT, model=ALONE)
    for a, b in zip(vectors(there[0]), vectors(here[0]), strict=True):
        np.testing.assert_allclose(a, turn @ b, rtol=0, atol=1e-9)
    np.testing.assert_allclose(there[2], here[2], rtol=1e-8, atol=1e-10)


@settings(max_examples=5)
@given(ANGLE, ANGLE, RATE, RATE, RATE)
def test_the_mirror_image_of_geometry_and_stream(alpha, beta, p, q, r):
    """Side force, rolling and yawing moment change their signs, and the derivatives with them."""
    rows = (ODD * np.array([1.0, -1.0, 1.0, 1.0, 1.0]))[::-1]
    mirror = np.array([1.0, -1.0, 1.0])
    flip = np.array([1.0, 1.0, -1.0, -1.0, -1.0])  # of alpha, q, beta, p, r
    grid = ODD_GRID._replace(weights=np.asarray(ODD_GRID.weights)[::-1, ::-1])
    here = found([surface(ODD, ODD_GRID)], alpha=alpha, q=q, lateral=(beta, p, r), model=ALONE)
    there = found([surface(rows, grid)], alpha=alpha, q=q, lateral=(-beta, -p, -r), point=mirror * POINT, model=ALONE)
    for name in NAMES:
        sign = -1.0 if name in ("CY", "Cl", "Cn") else 1.0
        np.testing.assert_allclose(there[0][name], sign * here[0][name], rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(there[1][name], sign * flip * here[1][name], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(there[2], here[2], rtol=1e-9)


# One surface or two: the same strips.

HALVES = [np.linspace(0.0, 1.0, 2 * n + 1) for n in (3, 2)]
JOINED = cut(segment_weights(HALVES), ["NACA 2412"] * 3, 2, 0.0)
PARTS = [cut(segment_weights([at]), ["NACA 2412"] * 2, 2, 0.0) for at in HALVES]


@settings(max_examples=5)
@given(st.floats(0.2, 0.8), st.floats(-0.5, 1.0), st.floats(-0.3, 0.3), ANGLE)
def test_a_surface_split_in_two(at, x, z, alpha):
    """Of one component, so that no cores stand between them; at any place, with a kink there or none."""
    rows = np.array([[0.0, 0.0, 0.0, 1.6, 0.03], [x, 3.5 * at, z, 1.3, 0.0], [0.8, 3.5, 0.3, 0.9, -0.02]])
    one = found([surface(rows, JOINED)], alpha=alpha, q=0.01, model=Model((ROOTED,), 0, CAMBER, (1,)))
    two = found(
        [surface(part, grid) for part, grid in zip((rows[:2], rows[1:]), PARTS, strict=True)],
        alpha=alpha,
        q=0.01,
        model=Model((ROOTED, FREE), 0, CAMBER, (1, 1)),
    )
    for name in ("CL", "CD", "CX", "CZ", "Cm"):
        np.testing.assert_allclose(two[0][name], one[0][name], rtol=1e-9, atol=1e-11)
        np.testing.assert_allclose(two[1][name], one[1][name], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(two[2], one[2], rtol=1e-9)
