"""Observed order of convergence of the lattice by law and direction of refinement, and a converged textbook wing.

`bertin_converged_rows` gives (case, quantity, reference, ours, tolerance, source) as in `test_lattice`.
"""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.geometry import Sections, make_grid, make_panels
from hera_om.physics.lattice import assemble, shapes, solve
from hera_om.physics.lattice_forces import trefftz
from hera_om.physics.layout import layout

RECTANGLE = ((0.0, 0.0, 1.0), (0.0, 3.0, 1.0))  # x_le, y, chord: aspect ratio 6
BERTIN = ((0.0, 0.0, 1.0), (2.5, 2.5, 1.0))  # sweep 45 degrees, aspect ratio 5
ONE, TWO, THREE = ((order - 0.2, order + 0.2) for order in (1.0, 2.0, 3.0))
ABOVE_FOUR = (4.0, np.inf)


@jax.jit
def _slopes(panels):
    lattice, _ = assemble([panels], 0.0)
    gamma = solve(lattice.even, -lattice.normal[:, 2])
    return jnp.stack(trefftz(lattice, layout(shapes([panels])), gamma))


def slopes(rows, nc, ns, *, span, chord):
    """CL by alpha and CDi by its square of a flat wing, on the area of its mean chord."""
    x, y, c = (jnp.asarray(v) for v in zip(*rows, strict=True))
    grid = make_grid(y, ["flat"] * 2, nc=nc, ns=ns, span=span, chord=chord)
    none = jnp.zeros_like(x)
    return np.asarray(_slopes(make_panels(Sections(x, y, none, c, none), grid))) / float((c[0] + c[1]) * y[1])


def order(coarse, middle, fine):
    """Order that three meshes show, each of half the panels' size."""
    return np.log2(np.abs(middle - coarse) / np.abs(fine - middle))


@pytest.mark.parametrize(
    ("law", "strips", "quantity", "band"),
    [
        ("uniform", 12, 0, ONE),
        ("uniform", 12, 1, ONE),
        ("cosine", 12, 1, TWO),
        ("sine", 12, 1, TWO),
        ("cosine", 6, 0, ABOVE_FOUR),
        ("sine", 6, 0, ABOVE_FOUR),
    ],
)
def test_order_along_the_span(law, strips, quantity, band):
    """The load has a root at the tip: strips that follow it gain orders, equal ones cost all but the first."""
    found = [slopes(RECTANGLE, 1, strips * n, span=law, chord="uniform")[quantity] for n in (1, 2, 4)]
    assert band[0] < order(*found) < band[1]


@pytest.mark.parametrize(("law", "band"), [("uniform", TWO), ("cosine", THREE)])
def test_order_along_the_chord(law, band):
    """On 9 strips; lift and induced drag alike."""
    found = order(*(slopes(RECTANGLE, n, 9, span="cosine", chord=law) for n in (2, 4, 8)))
    assert np.all((band[0] < found) & (found < band[1])), found


def test_the_law_does_not_change_the_limit():
    """Equal strips, extrapolated at first order, meet the others, extrapolated at second order."""

    def limit(law, gain):
        coarse, fine = (slopes(RECTANGLE, 1, n, span=law, chord="uniform") for n in (24, 48))
        return fine + (fine - coarse) / gain

    equal, sine = limit("uniform", 1), limit("sine", 3)
    np.testing.assert_allclose(equal, sine, rtol=1e-3)


def bertin_converged_rows(reference):
    """The limit of lattices with equal panels and with cosine laws, both of first order: the root has a kink."""
    text = (reference / "vlm_planar_cases.csv").read_text()
    found = re.search(r"converged ([\d.]+)\.\.([\d.]+)", text)
    low, high = (float(v) for v in found.groups())
    middle, out = (low + high) / 2, []
    for law in ("uniform", "cosine"):
        coarse, fine = (slopes(BERTIN, n, 8 * n, span=law, chord=law)[0] for n in (2, 4))
        case = f"Bertin, sweep 45, {law} panels, extrapolated"
        source = "independent horseshoe lattice, converged"
        out.append((case, "CLalpha", middle, float(2 * fine - coarse), (high - low) / 2 / middle, source))
    return out


def test_bertin_converged(reference):
    rows = bertin_converged_rows(reference)
    for case, _, expected, ours, tolerance, _ in rows:
        assert ours == pytest.approx(expected, rel=tolerance), case
    assert rows[0][3] == pytest.approx(rows[1][3], rel=1e-3)
