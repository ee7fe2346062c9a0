"""Strips as slipstreams meet them: what a wing sheds, and its images in a jet that all of it stands in."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.finite_jet import trailing_answer
from hera_om.physics.geometry import Sections, make_grid, make_panels
from hera_om.physics.lattice import assemble, solve
from hera_om.physics.strips import met_strips, shed, strip_of_panels


def lattice_of(y_root=0.0, nc=2, ns=8):
    row = jnp.ones(2)
    wing = Sections(0.0 * row, y_root + jnp.array([0.0, 4.0]), 0.0 * row, row, 0.0 * row)
    grid = make_grid([0.0, 4.0], ["flat"] * 2, nc=nc, ns=ns, span="cosine", chord="uniform")
    panels = make_panels(wing, grid)
    return panels, assemble([panels], jnp.zeros(()))[0]


def answered(panels, lattice, radius, mirrored=1.0):
    """Downwash at a lifting wing of what it trails, and what a jet of this radius about the root adds, over k."""
    strength = solve(lattice.even, -jnp.ones(lattice.chord.shape[0]))
    gamma = strength[strip_of_panels([panels])[1]]
    (strips,) = met_strips([panels], lattice, jnp.array([mirrored]), 0.0)
    y = lattice.strip_point[:, 1, None]
    how = {"radius": jnp.array(radius), "chord": jnp.array(1.0)}
    answer = strips.there * trailing_answer(y, y + strips.nodes, jnp.array(0.0), **how)[0]
    return 1.0 - gamma / jnp.pi, -answer @ shed(gamma, gamma)


def test_panels_and_nodes_belong_to_their_strips():
    panels, _ = lattice_of()
    strip, last = strip_of_panels([panels, panels])
    np.testing.assert_array_equal(strip, [*range(8), *range(8), *range(8, 16), *range(8, 16)])
    np.testing.assert_array_equal(last, [*range(8, 16), *range(24, 32)])


def test_what_ends_at_the_nodes_is_all_that_there_is():
    """Both halves: nothing at the root of even loads, all at the tips; twice the load at the root of odd ones."""
    one = jnp.ones(8)
    even, odd = shed(one, one), shed(one, -one)
    assert float(even.sum()) == 0.0 and float(even[0] + even[9]) == 0.0 and float(even[8]) == -1.0
    assert float(odd[0] + odd[9]) == 2.0


@pytest.mark.parametrize("y_root", [0.0, 1.0])
def test_a_jet_around_the_whole_wing_answers_the_less_the_wider_it_is(y_root):
    """Images stand at R^2 / y': near the tips, or far away in a jet of ten times the span."""
    panels, lattice = lattice_of(y_root)
    (downwash, near), (_, wide) = (answered(panels, lattice, radius) for radius in (y_root + 4.1, 80.0))
    tip = int(np.argmax(lattice.strip_point[:, 1])) - 1
    assert float(near[tip] / downwash[tip]) > 0.2
    assert np.all(np.abs(wide) < 0.005 * np.max(downwash))


def test_without_an_image_the_other_half_is_not_there():
    panels, lattice = lattice_of(1.0)
    with_it, without = (answered(panels, lattice, 6.0, mirrored=m)[1] for m in (1.0, 0.0))
    assert np.max(np.abs(with_it - without)) > 0.01
