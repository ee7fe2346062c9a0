"""Static aeroelasticity against closed forms: divergence, twist of a straight wing, sweep, lift held."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.aeroelastic import (
    FlexibleWing,
    at_constant_lift,
    divergence_ratio,
    elastic_loads,
    flexibility,
    strip_incidence,
    unit_lifts,
)
from hera_om.physics.beam import BeamProperties
from hera_om.physics.beam_loads import Loads

LENGTH, CHORD, ARM, SLOPE, STIFF = 10.0, 1.5, 0.3, 5.7, 2.0e6
STRIPS = 60


def uniform_wing(*, sweep=0.0, EI=1e30, GJ=STIFF, arm=ARM):
    """Uniform wing of 10 m along its axis, lift acting ahead of it, along the stream."""
    axis = np.linspace(0.0, LENGTH, STRIPS + 1)[:, None] * [[np.sin(sweep), np.cos(sweep), 0.0]]
    s, one = jnp.linspace(0.0, LENGTH, STRIPS + 1), jnp.ones(STRIPS + 1)
    beam = BeamProperties(s, EI * one, GJ * one, one, 0 * one, one)
    points = 0.5 * (axis[1:] + axis[:-1]) - [arm, 0.0, 0.0]
    return FlexibleWing(beam, jnp.asarray(axis), jnp.asarray(axis[:, 1]), jnp.asarray(points))


def strip_theory(wing, pressure):
    """Lift by incidence of independent strips, N/rad."""
    return jnp.diag(pressure * CHORD * SLOPE * jnp.diff(wing.edges))


def test_divergence_of_a_straight_wing():
    """q_D = (pi / 2)^2 GJ / (e c a L^2): Bisplinghoff, Ashley & Halfman, ch. 8."""
    wing = uniform_wing()
    expected = (np.pi / 2) ** 2 * STIFF / (ARM * CHORD * SLOPE * LENGTH**2)
    ratio = divergence_ratio(np.asarray(strip_theory(wing, 1000.0) @ flexibility(wing)))
    assert 1000.0 * ratio == pytest.approx(expected, rel=1e-3)
    assert divergence_ratio(np.asarray(strip_theory(wing, 1e3) @ flexibility(uniform_wing(arm=-ARM)))) == np.inf


@pytest.mark.parametrize("share", [0.2, 0.7])
def test_twist_of_a_straight_wing(share):
    """theta = alpha (tan(k L) sin(k y) + cos(k y) - 1), k^2 = q e c a / GJ: Bisplinghoff, Ashley & Halfman, ch. 8."""
    wing, alpha = uniform_wing(), 0.05
    pressure = share * (np.pi / 2) ** 2 * STIFF / (ARM * CHORD * SLOPE * LENGTH**2)
    slope, units = strip_theory(wing, pressure), unit_lifts(wing)
    rigid = alpha * jnp.sum(slope, axis=1)
    cases = Loads(*(rigid[None] @ u for u in units))
    more = elastic_loads(wing, slope, cases, Loads(*(0.0 * u[0] for u in units)))
    whole = Loads(*((c + m)[0] for c, m in zip(cases, more, strict=True)))
    y = 0.5 * (wing.edges[1:] + wing.edges[:-1])
    k = np.sqrt(pressure * ARM * CHORD * SLOPE / STIFF)
    expected = alpha * (np.tan(k * LENGTH) * np.sin(k * y) + np.cos(k * y) - 1.0)
    np.testing.assert_allclose(strip_incidence(wing, whole), expected, atol=2e-3 * np.max(expected))


def test_bending_divergence_of_a_wing_swept_forward():
    """q c a sin cos L^3 / EI = 6.33 of a wing without twist, none swept back: Hodges & Pierce, ch. 4."""
    bending, sweep = 4.0e6, np.radians(30.0)
    forward = uniform_wing(sweep=-sweep, EI=bending, GJ=1e30, arm=0.0)
    ratio = divergence_ratio(np.asarray(strip_theory(forward, 1.0) @ flexibility(forward)))
    found = ratio * CHORD * SLOPE * np.sin(sweep) * np.cos(sweep) * LENGTH**3 / bending
    assert found == pytest.approx(6.33, rel=2e-3)
    back = uniform_wing(sweep=sweep, EI=bending, GJ=1e30)
    assert divergence_ratio(np.asarray(strip_theory(back, 1.0) @ flexibility(back))) == np.inf


def _root_bending(wing, slope):
    units = unit_lifts(wing)
    rigid = 0.05 * jnp.sum(slope, axis=1)
    cases = Loads(*(rigid[None] @ u for u in units))
    more = elastic_loads(wing, slope, cases, Loads(*(0.0 * u[0] for u in units)))
    return float(more.V[0, 0] / cases.V[0, 0]), float(more.M[0, 0] / cases.M[0, 0])


def test_sweep_back_relieves_and_sweep_forward_loads():
    """At constant lift the root shear stays, and bending moves lift inboard on a wing that is swept back."""
    for sweep, sign in ((0.4, -1.0), (-0.4, 1.0)):
        wing = uniform_wing(sweep=sweep, EI=1e6, GJ=1e30, arm=0.0)
        shear, bending = _root_bending(wing, at_constant_lift(strip_theory(wing, 500.0)))
        assert abs(shear) < 1e-3 and 0.01 < sign * bending < 0.3
    straight = uniform_wing(EI=4e6)  # lift ahead of the axis twists nose up: load moves outboard
    assert _root_bending(straight, at_constant_lift(strip_theory(straight, 1500.0)))[1] > 0.01


def test_derivatives_by_stiffness_and_pressure():
    def run(p):
        wing = uniform_wing(sweep=0.3, EI=4e6 * p[0], GJ=2e6 * p[1])
        slope = at_constant_lift(strip_theory(wing, 500.0 * p[2]))
        units = unit_lifts(wing)
        cases = Loads(*(0.05 * jnp.sum(strip_theory(wing, 500.0), axis=1)[None] @ u for u in units))
        more = elastic_loads(wing, slope, cases, Loads(*(0.1 * c[0] for c in cases)))
        return jnp.concatenate([more.M[0, ::10], more.T[0, ::10]])

    run, point, h = jax.jit(run), jnp.asarray([1.0, 0.9, 1.1]), 1e-3
    exact = np.asarray(jax.jacfwd(run)(point))
    central = [
        (8 * (run(point + e / 2) - run(point - e / 2)) - run(point + e) + run(point - e)) / (6 * h)
        for e in h * np.eye(3)
    ]
    np.testing.assert_allclose(exact, np.stack(central, -1), atol=1e-6 * np.max(np.abs(exact)))
