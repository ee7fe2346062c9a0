"""Loads of panels and about axes: a flat plate in plane flow, and sums that must give back what they divide."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.geometry import CAMBER, Sections, make_grid, make_panels, surface_mesh
from hera_om.physics.lattice import assemble, shapes, solve
from hera_om.physics.lattice_forces import (
    axis_moments,
    filament_forces,
    filament_strengths,
    panel_pressure,
    pressure_cells,
    strip_loads,
)
from hera_om.physics.layout import layout

ALPHA = 0.02
STREAM = jnp.array([np.cos(ALPHA), 0.0, np.sin(ALPHA)])


@jax.jit
def solved(panels):
    """Lattice and forces on its filaments at a small incidence."""
    lattice, _ = assemble(panels, 0.0)
    lay = layout(shapes(panels))
    gamma = solve(lattice.even, -lattice.normal @ STREAM)
    velocity = STREAM + lattice.even.velocity @ gamma
    return lattice, filament_forces(lattice, filament_strengths(lay, gamma), velocity)


def parts(rows, nc, ns, *, airfoil="flat", span="uniform", chord="uniform"):
    """Panels of a surface from rows (x_le, y, z, chord, twist) and the areas of its pressures."""
    sections = Sections(*[jnp.asarray(v, float) for v in zip(*rows, strict=True)])
    grid = make_grid(np.arange(float(len(rows))), [airfoil] * len(rows), nc=nc, ns=ns, span=span, chord=chord)
    return make_panels(sections, grid), pressure_cells(surface_mesh(sections, grid, CAMBER), grid.rear), grid


def wing_and_tail():
    wing = parts([(0.0, 0.0, 0.0, 1.6, 0.05), (0.7, 3.0, 0.3, 0.9, 0.0)], 2, 4, airfoil="NACA 2412")
    tail = parts([(4.0, 0.0, 0.5, 0.8, 0.0), (4.2, 1.2, 0.5, 0.6, 0.0)], 2, 2, chord="cosine")
    return [list(v) for v in zip(*(wing, tail), strict=True)][:2]


@pytest.mark.parametrize(("law", "allowed"), [("uniform", 0.025), ("cosine", 0.006)])
def test_pressure_of_a_flat_plate(law, allowed):
    """4 alpha sqrt((c - x) / x) in the middle of a wing of aspect ratio 2000.

    Source: thin-airfoil theory, Katz & Plotkin, chapter 5. The first of equal panels stands where the root is
    steepest: there its mean over the area is the measure.
    """
    panels, cells, grid = parts([(0.0, 0.0, 0.0, 1.0, 0.0), (0.0, 1000.0, 0.0, 1.0, 0.0)], 8, 3, span="sine", chord=law)
    _, forces = solved([panels])
    lay = layout([(8, 3)])
    found = np.asarray(panel_pressure(lay, forces, [cells])).reshape(8, 3)[:, 0] / ALPHA
    x = np.asarray(grid.xi[:-1] + grid.front * np.diff(grid.xi))
    exact = 4.0 * np.sqrt((1.0 - x) / x)
    if law == "uniform":
        end = float(grid.rear[0]) / 8
        exact[0] = 4.0 * (np.sqrt(end * (1.0 - end)) + np.arcsin(np.sqrt(end))) / end
    np.testing.assert_allclose(found, exact, rtol=allowed)


def test_pressures_give_back_the_normal_force():
    """On a flat wing and tail at incidence every panel's force is its pressure times its area along the normal."""
    panels, cells = wing_and_tail()
    lattice, forces = solved(panels)
    lay = layout(shapes(panels))
    pressure = np.asarray(panel_pressure(lay, forces, cells))
    tail = np.asarray(cells[1])
    across = np.cross(tail[1:, 1:] - tail[:-1, :-1], tail[:-1, 1:] - tail[1:, :-1]).reshape(-1, 3)[:, 2] / 2
    loads = strip_loads(lattice, lay, forces)
    by_strip = (pressure[8:] * across).reshape(2, 2).sum(axis=0)
    np.testing.assert_allclose(by_strip, loads.force[4:, 2], rtol=1e-12)
    assert np.all(pressure[:8] > 0.0) and pressure.shape == (12,)


def test_moments_about_any_axis_are_those_of_the_filaments():
    """A sum over the filaments of each strip, those on an edge with half of their force to either side."""
    panels, _ = wing_and_tail()
    lattice, forces = solved(panels)
    lay = layout(shapes(panels))
    rng = np.random.default_rng(2)
    through, direction = rng.normal(size=(6, 3)), rng.normal(size=(6, 3))
    found = axis_moments(strip_loads(lattice, lay, forces), jnp.asarray(through), jnp.asarray(direction))
    unit, expected = direction / np.linalg.norm(direction, axis=1)[:, None], np.zeros(6)
    points, forces = np.asarray(lattice.points), np.asarray(forces)
    for e in range(len(forces)):
        for strip, part in ((lay.inner[e], lay.share[e]), (lay.outer[e], 1.0 - lay.share[e])):
            expected[strip] += part * unit[strip] @ np.cross(points[e] - through[strip], forces[e])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15)


def test_moment_of_a_flat_plate_about_its_middle():
    """Lift acts at the quarter chord: a quarter of lift times chord, nose up about the middle."""
    panels, _, _ = parts([(0.0, 0.0, 0.0, 1.0, 0.0), (0.0, 1000.0, 0.0, 1.0, 0.0)], 8, 3, span="sine")
    lattice, forces = solved([panels])
    loads = strip_loads(lattice, layout([(8, 3)]), forces)
    quarter, middle = (axis_moments(loads, jnp.array([x, 0.0, 0.0]), jnp.array([0.0, 2.0, 0.0])) for x in (0.25, 0.5))
    lift = float(loads.force[0, 2])
    assert float(quarter[0]) == pytest.approx(0.0, abs=1e-4 * lift)
    assert float(middle[0]) == pytest.approx(0.25 * lift, rel=1e-3)
