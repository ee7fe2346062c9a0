"""Controls: shares of panels, turned normals by hand, signs on the port half, derivatives."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.controls import Control, controlled_panels, hinge_share
from hera_om.physics.geometry import CAMBER, FLAT, Sections, make_grid


def sections(*, z=(0.0, 0.0), chord=(2.0, 1.0), twist=0.0, y=(0.0, 4.0)):
    return Sections(*[jnp.asarray(v, float) for v in ((0.0, 1.0), y, z, chord, (twist, twist))])


def grid(nc=3, ns=4):
    return make_grid([0.0, 4.0], ["flat"] * 2, nc=nc, ns=ns, span="uniform", chord="uniform")


def control(*, command=(1.0,), ends=(0.0, 4.0), hinge=(0.5, 0.5), gain=(1.0, 1.0), mirror=1.0, axis=None):
    return Control(np.asarray(command), *[jnp.asarray(v) for v in (ends, hinge, gain)], mirror, axis)


def turned(found, shape=CAMBER, where=None):
    where = sections() if where is None else where
    return controlled_panels(
        where, grid(), shape, station=jnp.array([0.0, 4.0]), controls=found, commands=len(found[0].command)
    )


def test_hinge_cuts_panels_in_part():
    share = hinge_share(grid(), jnp.array([0.0, 4.0]), control(ends=(1.5, 4.0), gain=(2.0, 2.0)))
    np.testing.assert_allclose(share, 2.0 * np.outer([0.0, 0.5, 1.0], [0.0, 0.5, 1.0, 1.0]), atol=1e-15)


def test_hinge_and_gain_go_linearly_along_the_span():
    share = hinge_share(grid(nc=1), jnp.array([0.0, 4.0]), control(hinge=(0.2, 0.6), gain=(1.0, 3.0)))
    part = np.array([0.125, 0.375, 0.625, 0.875])
    np.testing.assert_allclose(share[0], (1.0 + 2.0 * part) * (0.8 - 0.4 * part), rtol=1e-12)


@pytest.mark.parametrize("shape", [CAMBER, FLAT])
def test_an_elevator_down_turns_the_normal_aft(shape):
    """About the hinge line, here at three quarters of the chord of a tapered wing, where the line is straight."""
    straight = sections(chord=(2.0, 1.0), twist=0.1)._replace(x_le=jnp.array([0.0, 0.75]))
    panels = turned((control(hinge=(0.75, 0.75)),), shape, straight)
    last = panels.normal_hinge[0, 0, -1]
    np.testing.assert_allclose(last, 0.75 * np.cross([0.0, 1.0, 0.0], panels.normal[-1]), atol=1e-12)
    assert np.all(np.asarray(last)[:, 0] > 0.7) and not np.any(panels.normal_hinge[0, 0, 0])


def test_a_swept_hinge_line_loses_with_the_cosine():
    """As AVL: the turn is about the line itself, whose sweep is 1 / 4 here."""
    swept = sections(chord=(2.0, 2.0))
    panels = turned((control(hinge=(0.0, 0.0)),), FLAT, swept)
    np.testing.assert_allclose(panels.normal_hinge[0, 0, 0, 0, 0], np.cos(np.arctan(0.25)), rtol=1e-12)
    given = turned((control(hinge=(0.0, 0.0), axis=jnp.array([0.0, 2.0, 0.0])),), FLAT, swept)
    np.testing.assert_allclose(given.normal_hinge[0, 0, 0, 0], [1.0, 0.0, 0.0], atol=1e-12)


def test_commands_and_the_port_half():
    """Two controls of one surface answer to two commands; one of them is reversed on the port half."""
    both = (control(command=(1.0, 0.0)), control(command=(0.0, 1.0), ends=(2.0, 4.0), mirror=-1.0))
    starboard, port = turned(both).normal_hinge
    np.testing.assert_allclose(port[0], starboard[0])
    np.testing.assert_allclose(port[1], -starboard[1])
    assert not np.any(starboard[1][:, :2]) and np.any(starboard[1][:, 2:])


def test_a_control_on_a_fin_turns_its_trailing_edge_to_starboard():
    """The right-hand rule about a line that runs up: the side force points to port."""
    fin = sections(y=(0.0, 0.0), z=(0.0, 4.0))
    panels = turned((control(hinge=(0.0, 0.0), axis=jnp.array([0.0, 0.0, 1.0])),), FLAT, fin)
    np.testing.assert_allclose(panels.normal[0, 0], [0.0, -1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(panels.normal_hinge[0, 0, 0, 0], [1.0, 0.0, 0.0], atol=1e-12)


def test_derivatives(check_derivatives):
    def run(v):
        wing = sections(z=(0.0, v[0]), chord=(2.0, v[1]))
        moved = control(hinge=(v[2], v[2]), gain=(v[3], 1.0))
        return turned((moved,), FLAT, wing).normal_hinge.ravel()

    check_derivatives(run, [0.4, 1.2, 0.45, 1.3])
