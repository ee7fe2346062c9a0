"""Roots of many equations at once, where Newton's method works and where it does not."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

from hera_om.physics.rotor_root import ROOT_TOLERANCE, bracketed_root, guessed_root

CENTRE, REACH = 0.2, 1.5
SHIFT = np.linspace(-1.2, 1.2, 12)  # of the roots from the centre


def rising(x, shift):
    """One root, steep and curved."""
    d = x - CENTRE - shift
    return jnp.tanh(3.0 * d) + 0.1 * d**2 * jnp.sign(d)


def wedge(x, shift):
    """Newton's steps from anywhere jump to the other side of the root and back."""
    d = x - CENTRE - shift
    return jnp.sign(d) * jnp.sqrt(jnp.abs(d))


def folded(x, shift):
    """Rises through zero, falls, and rises again; the root in the middle is at the shift."""
    d = x - CENTRE - shift
    return 4.0 * d * (d - 0.1) * (d + 0.1)


def solve(f, guess):
    """All roots, compiled."""
    centre = jnp.full(SHIFT.shape, CENTRE)
    return np.asarray(jax.jit(lambda g: guessed_root(lambda x: f(x, SHIFT), centre, REACH, g))(guess))


@pytest.mark.parametrize("off", [0.0, 0.05, 1.0, -3.0])
def test_roots_to_rounding(off):
    """Against Brent's method, from the root itself, from near it, from afar and from outside the bracket."""
    found = solve(rising, CENTRE + SHIFT + off)
    brent = [brentq(rising, CENTRE - REACH, CENTRE + REACH, args=(s,), xtol=1e-15) for s in SHIFT]
    np.testing.assert_allclose(found, brent, rtol=0, atol=1e-14)


def test_search_where_newtons_method_fails():
    """One such element and those beside it."""
    found = solve(lambda x, s: jnp.where(s == SHIFT[3], wedge(x, s), rising(x, s)), CENTRE + SHIFT + 0.05)
    error = np.abs(found - CENTRE - SHIFT)
    assert error[3] < ROOT_TOLERANCE and np.max(np.delete(error, 3)) < 1e-14


def test_roots_where_the_function_falls_are_not_taken():
    """Newton's method starts on the middle root of three; what comes back is one of the others."""
    found = solve(folded, CENTRE + SHIFT)
    np.testing.assert_allclose(np.abs(found - CENTRE - SHIFT), 0.1, rtol=0, atol=1e-12)


def test_the_search_alone():
    """Within its tolerance."""
    centre = jnp.full(SHIFT.shape, CENTRE)
    found = bracketed_root(lambda x: rising(x, SHIFT), centre, REACH)
    np.testing.assert_allclose(found, CENTRE + SHIFT, rtol=0, atol=ROOT_TOLERANCE)
