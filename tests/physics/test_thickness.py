"""Flow of thickness against closed forms, and its drag in a slipstream against the thrust that it gives."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import thickness as th
from hera_om.physics.airfoil import STATIONS, thickness_growth
from hera_om.physics.geometry import Sections, make_grid, make_panels
from hera_om.physics.slipstream import slipstream_velocity

RATIO = 0.12


def ellipse(n=81):
    t = np.linspace(0.0, 2.0 * np.pi, n)
    return (1.0 + np.cos(t)) / 2.0, 0.06 * np.sin(t)


def wing(airfoil, half_span, chord=1.0, ns=40, nc=8):
    row = jnp.ones(2)
    sections = Sections(0.0 * row, jnp.array([0.0, half_span]), 0.0 * row, chord * row, 0.0 * row)
    return sections, make_grid(sections.y, [airfoil] * 2, nc=nc, ns=ns, span="cosine", chord="uniform")


def flow(points, airfoil, half_span=400.0, mach=0.0, ns=40):
    """Velocity by both halves of a wing of chord 1."""
    sections, grid = wing(airfoil, half_span, ns=ns)
    growth = th.strip_growth(grid, sections.chord, RATIO * jnp.ones(2))
    lines = th.source_lines(sections, grid, growth, make_panels(sections, grid).strip_width)
    mirror = jnp.array([1.0, -1.0, 1.0])
    beta = jnp.sqrt(1.0 - mach**2)
    return th.source_velocity(points, lines, beta) + mirror * th.source_velocity(points * mirror, lines, beta)


@pytest.mark.parametrize("mach", [0.0, 0.6])
@pytest.mark.parametrize("x,z", [(-0.1, 0.0), (-0.4, 0.0), (-0.4, 0.3), (-1.5, -0.8), (1.6, 0.1), (0.5, 0.7)])
def test_thin_ellipse_in_plane_flow(x, z, mach):
    """u - i w = V t / c (1 - Z / sqrt(Z^2 - 1)), Z = 2 (x - c / 2 + i z) / c: linear theory of a thin ellipse."""
    beta = np.sqrt(1.0 - mach**2)
    place = 2.0 * (x - 0.5 + 1j * beta * z)
    exact = RATIO * (1.0 - 1.0 / (np.sqrt(1.0 - 1.0 / place**2)))
    found = flow(jnp.array([[x, 0.3, z]]), ellipse(), mach=mach)[0]
    np.testing.assert_allclose(found, [exact.real / beta, 0.0, -exact.imag], rtol=0.01, atol=2e-4)


@pytest.mark.parametrize("airfoil", ["NACA 0012", "flat", "NACA 2412", ellipse()])
def test_a_section_is_closed_and_has_its_area(airfoil):
    """Of chord times thickness: ellipse pi / 4; NACA four digits 0.685 (Abbott, eq. 6.2 integrated), of which a closed
    trailing edge leaves out 0.010.
    """
    growth = thickness_growth(airfoil)
    assert growth.sum() == pytest.approx(0.0, abs=1e-12)
    area = np.pi / 4 if isinstance(airfoil, tuple) else 0.675
    assert -growth @ STATIONS == pytest.approx(area, rel=0.005)


def test_near_the_nose_of_a_four_digit_section():
    """A tenth of the chord ahead, against the sheet in 4000 steps."""
    edges = (1.0 - np.cos(np.linspace(0.0, np.pi, 4001))) / 2.0
    half = 5.0 * np.array([0.2969, -0.126, -0.3516, 0.2843, -0.1015]) @ (edges ** np.array([[0.5], [1], [2], [3], [4]]))
    steps = 2.0 * RATIO * np.diff(half)
    exact = np.sum(steps / (2.0 * np.pi * (-0.1 - (edges[1:] + edges[:-1]) / 2.0)))
    assert float(flow(jnp.array([[-0.1, 0.3, 0.0]]), "NACA 0012")[0, 0]) == pytest.approx(exact, rel=0.015)


def test_a_line_of_sources_gives_out_its_flux():
    lines = th.SourceLines(jnp.array([[0.0, -0.3, 0.1]]), jnp.array([[0.2, 0.4, 0.0]]), jnp.array([0.7]))
    z, weight = np.polynomial.legendre.leggauss(40)
    angle = 2 * np.pi * (np.arange(80) + 0.5) / 80
    flat = np.sqrt(1 - z**2)[:, None]
    unit = np.stack(np.broadcast_arrays(flat * np.cos(angle), flat * np.sin(angle), z[:, None]), axis=-1).reshape(-1, 3)
    through = np.sum(np.asarray(th.source_velocity(jnp.asarray(unit), lines, jnp.ones(()))) * unit, axis=1)
    assert np.repeat(weight, 80) @ through * 2 * np.pi / 80 == pytest.approx(0.7, rel=1e-6)


def test_finite_wing_far_ahead_is_a_doublet():
    """Of strength V times the volume."""
    far = flow(jnp.array([[-59.5, 0.0, 0.0]]), "flat", half_span=2.0)[0, 0]
    volume = 0.675 * RATIO * 4.0
    assert float(far) == pytest.approx(-volume / (2.0 * np.pi * 60.0**3), rel=0.01)


@pytest.mark.parametrize(("mach", "nc", "within"), [(0.0, 8, 0.005), (0.0, 2, 0.02), (0.5, 8, 0.12)])
def test_drag_in_a_slipstream_pays_for_the_thrust(mach, nc, within):
    """To first order the force on a body in the pressure of a disk is -sum(f . u_body) / V over the disk's forces f.

    Sources Q feel Q p / V, with p = f . r / (4 pi r^3) of each force; they induce Q r / (4 pi r^3) there.
    """
    v, radius, hub = 1e-4, 0.5, np.array([-0.5, 1.0, 0.0])
    sections, grid = wing("flat", 2.0, ns=60, nc=nc)
    panels = make_panels(sections, grid)
    growth = th.strip_growth(grid, sections.chord, RATIO * jnp.ones(2))
    xi = jnp.asarray(grid.xi)
    x = xi[:-1] + grid.front * jnp.diff(xi)
    y = panels.strip_edges[:, 1]
    y = (y[1:] + y[:-1]) / 2.0
    points = jnp.stack([jnp.repeat(x, 60), jnp.tile(y, nc), jnp.zeros(60 * nc)], axis=-1)
    r = radius * (jnp.arange(40) + 0.5) / 40
    place = {"hub": jnp.asarray(hub), "axis": jnp.array([1.0, 0.0, 0.0]), "radius": jnp.asarray(radius), "r": r}
    load = {"v_axial": v * jnp.ones(40), "v_swirl": jnp.zeros(40), "sense": jnp.ones(())}
    how = {"speed": jnp.ones(()), "edge_width": 0.005 * jnp.ones(60 * nc)}
    along = slipstream_velocity(points, **place, **load, **how)[:, 0]
    drag = jnp.sum(th.buoyancy(th.on_panels(grid, growth), jnp.tile(panels.strip_width, nc), along, mach=mach))
    angle = 2 * np.pi * (np.arange(48) + 0.5) / 48
    disk = hub + np.stack(np.broadcast_arrays(0.0, r[:, None] * np.cos(angle), r[:, None] * np.sin(angle)), axis=-1)
    lines = th.source_lines(sections, grid, growth, panels.strip_width)
    ahead = th.source_velocity(jnp.asarray(disk).reshape(-1, 3), lines, jnp.sqrt(1.0 - mach**2))[:, 0].reshape(40, 48)
    gained = -4.0 * v * jnp.sum(ahead.mean(axis=1) * 2 * np.pi * r * radius / 40)
    assert float(drag) == pytest.approx(float(gained), rel=within) and drag > 0.0


def test_derivatives_are_exact():
    def ahead(p):
        sections, grid = wing("NACA 0012", 3.0)
        sections = sections._replace(chord=sections.chord * p[0], x_le=sections.x_le + p[2])
        growth = th.strip_growth(grid, sections.chord, p[1] * jnp.ones(2))
        lines = th.source_lines(sections, grid, growth, make_panels(sections, grid).strip_width)
        return th.source_velocity(jnp.array([[-0.3, 1.0, 0.2]]), lines, jnp.sqrt(1.0 - p[3] ** 2))[0, 0]

    at, step = jnp.array([1.0, 0.12, 0.0, 0.4]), 1e-6
    found = np.asarray(jax.grad(ahead)(at))
    for i in range(4):
        d = step * jnp.eye(4)[i]
        assert found[i] == pytest.approx(float(ahead(at + d) - ahead(at - d)) / (2 * step), rel=1e-6)
