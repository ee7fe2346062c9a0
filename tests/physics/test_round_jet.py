"""A wing through round jets: boundary elements against closed forms, and `finite_jet` against them."""

import importlib.util
from functools import cache
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import finite_jet as fj

_spec = importlib.util.spec_from_file_location("round_jet", Path(__file__).with_name("round_jet.py"))
assert _spec is not None and _spec.loader is not None
round_jet = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(round_jet)
RoundJets = round_jet.RoundJets


def retaken(radius, d):
    """Lift that the edge of a jet takes back over k, in chords, for a load and a condition d apart (first order).

    The edge's sources are 2 k times the normal velocity of an infinite vortex, and a condition's upwash summed over
    the span is that of line sources: both are plane flows, and their product integrates to this.
    """
    return d * np.arcsinh(2 * radius / np.abs(d)) / np.sqrt(d**2 + 4 * radius**2)


def retaken_of_a_plate(radius, n=400):
    """`retaken` averaged over the pressure of a plate in either direction of flow (the latter is the adjoint)."""
    load, met = (np.arange(n) + 0.5) * np.pi / n, (np.arange(n + 1) + 0.5) * np.pi / (n + 1)
    d = (1 - np.cos(met))[:, None] / 2 - (1 - np.cos(load)) / 2
    return (1 - np.cos(met)) / (n + 1) @ retaken(radius, d) @ (1 + np.cos(load)) / n


@pytest.mark.parametrize("radius", [0.35, 1.0])
def test_boundary_elements_against_the_closed_form_of_first_order(radius):
    """One panel along the chord: d = c / 2; 2 % are spent on the finite span."""
    jet = RoundJets([radius], chordwise=1)
    answer = np.sum(jet.answer([1.001])[1] * jet.width)
    assert 2 * answer / float(fj.reflection(1.001**2)) == pytest.approx(-retaken(radius, 0.5), rel=0.025)


def test_boundary_elements_against_the_plate():
    jet = RoundJets([0.5], chordwise=6)
    lost = 1 - np.sum(jet.gain([1.001]) * jet.width) / np.sum(jet.gain([1.001], edges=0.0) * jet.width)
    assert lost == pytest.approx(retaken_of_a_plate(0.5) / 2.0, rel=0.03)


def test_boundary_elements_of_a_small_wing_in_an_open_jet():
    """Glauert's correction for an open jet of circular section: downwash over V = S CL / 8 C (R&M 1566, 1933)."""
    radius = 30.0
    jet = RoundJets([radius], chordwise=1)
    lift = np.zeros(jet.strips)
    lift[0] = 1.0
    wash = (jet.answer([1e4])[0] @ lift)[0]
    span = 2 * jet.width[0]
    assert wash == pytest.approx(-2 * span / (8 * np.pi * radius**2), rel=0.05)


def test_without_edges_lift_follows_the_pressure_of_the_jet():
    jet = RoundJets([0.5])
    assert np.sum(jet.gain([1.3], edges=0.0) * jet.width) == pytest.approx(0.5 * (1.3**2 - 1), rel=0.03)


FULL, HOLLOW = ([1.0],), ([0.4, 1.0], [0.0, 1.0])
BLOWN = ([0.35, 0.5, 0.65, 0.95, 1.0], [0.0, 0.4, 0.8, 1.0, 0.6])  # much as a propeller's


def profile(shape, radius, mu):
    """Radii of the steps and the speeds inside them."""
    radii, excess = (shape[0], [1.0]) if len(shape) == 1 else shape
    return radius * np.array(radii), 1.0 + (mu - 1.0) * np.array(excess)


def ours(jet, radii, speeds, **how):
    """What the jets add to the lift, or the lift by swirl, with `finite_jet`, by strip; chord 1."""
    y, n = jet.middle, jet.strips
    places = np.concatenate([jet.edges, -jet.edges])
    nodes = jnp.asarray(places - y[:, None])
    radius, excess = (jnp.broadcast_to(jnp.asarray(v), (n, len(radii))) for v in (radii, speeds**2 - 1.0))
    found = fj.jet_edges(jnp.asarray(y), jnp.zeros(n), nodes, jnp.ones(n), radius=radius, excess=excess)
    return jet.modelled(speeds, fj.JetEdges(*[np.asarray(v) for v in found]), **how)


@pytest.mark.parametrize(
    "shape,radius,mu,anywhere",
    [
        (FULL, 0.35, 1.1, 0.04),
        (FULL, 0.5, 1.1, 0.04),
        (FULL, 0.5, 1.2, 0.04),
        (FULL, 0.5, 1.5, 0.05),
        (FULL, 1.0, 1.2, 0.04),
        (FULL, 2.0, 1.2, 0.04),
        (HOLLOW, 0.5, 1.2, 0.05),
        (HOLLOW, 1.0, 1.2, 0.05),
        (BLOWN, 0.5, 1.1, 0.05),
        (BLOWN, 0.5, 1.35, 0.05),
        (BLOWN, 1.0, 1.2, 0.05),
    ],
)
def test_lift_of_a_wing_through_round_jets(shape, radius, mu, anywhere):
    """Total of the added lift, and along the span over the largest: without the edges 12 to 90 % too much."""
    radii, speeds = profile(shape, radius, mu)
    jet = RoundJets(radii)
    found, exact, without = ours(jet, radii, speeds), jet.gain(speeds), jet.gain(speeds, edges=0.0)
    assert np.sum(found * jet.width) == pytest.approx(np.sum(exact * jet.width), rel=0.03)
    np.testing.assert_allclose(found, exact, atol=anywhere * np.max(exact))
    assert np.sum(without * jet.width) > 1.12 * np.sum(exact * jet.width)


@pytest.mark.parametrize("half_span", [3.0, 6.0])
@pytest.mark.parametrize(
    "shape,radius,mu",
    [
        (FULL, 0.35, 1.2),
        (FULL, 0.5, 1.1),
        (FULL, 0.5, 1.4),
        (FULL, 1.0, 1.2),
        (FULL, 2.0, 1.2),
        (BLOWN, 0.5, 1.1),
        (BLOWN, 0.5, 1.35),
        (BLOWN, 1.0, 1.2),
        (FULL, 0.5, 0.9),
        (BLOWN, 0.5, 0.9),
    ],
)
def test_lift_of_a_finite_wing_through_round_jets(shape, radius, mu, half_span):
    """Aspect ratios 6 and 12; also behind a rotor that brakes."""
    radii, speeds = profile(shape, radius, mu)
    jet = RoundJets(radii, half_span=half_span)
    exact, found = jet.gain(speeds), ours(jet, radii, speeds)
    assert np.sum(found * jet.width) == pytest.approx(np.sum(exact * jet.width), rel=0.025)
    np.testing.assert_allclose(found, exact, atol=0.045 * np.max(np.abs(exact)))


@pytest.mark.parametrize("shape,radius", [(FULL, 0.5), (FULL, 1.0), (HOLLOW, 0.5), (BLOWN, 0.5), (BLOWN, 1.0)])
def test_lift_of_a_wing_through_jets_of_twice_the_speed(shape, radius):
    """The largest ratio that is worth having: at four layered jets are up to a third off."""
    radii, speeds = profile(shape, radius, 2.0)
    jet = RoundJets(radii, half_span=6.0)
    exact, found = jet.gain(speeds), ours(jet, radii, speeds)
    assert np.sum(found * jet.width) == pytest.approx(np.sum(exact * jet.width), rel=0.08)
    np.testing.assert_allclose(found, exact, atol=0.1 * np.max(exact))


@pytest.mark.parametrize("half_span", [None, 3.0])
@pytest.mark.parametrize("shape,radius,mu", [(FULL, 0.5, 1.1), (FULL, 0.5, 1.25), (FULL, 1.0, 1.2), (BLOWN, 0.5, 1.35)])
def test_lift_of_a_cambered_wing_through_round_jets(shape, radius, mu, half_span):
    """A parabola, whose lift stands about the middle of the chord."""
    radii, speeds = profile(shape, radius, mu)
    jet = RoundJets(radii, chordwise=8, half_span=half_span, normal=lambda x: 4.0 * x - 2.0)
    exact, found = jet.gain(speeds), ours(jet, radii, speeds)
    assert np.sum(found * jet.width) == pytest.approx(np.sum(exact * jet.width), rel=0.035)
    np.testing.assert_allclose(found, exact, atol=0.08 * np.max(exact))


@cache
def short_wing(radii):
    """Aspect ratio 6, finer than the others."""
    return RoundJets(radii, inside=16, half_span=3.0)


PROPELLER = np.array([0.25, 0.35, 0.5, 0.65, 0.95, 1.0]), np.array([0.96, 1.08, 1.22, 1.30, 1.34, 1.2])


@pytest.mark.parametrize("middle", [0.25, 0.5])
@pytest.mark.parametrize("where", ["inside", "from there to the edge", "outside"])
@pytest.mark.parametrize("shape", [(np.array([1.0]), np.array([1.2])), PROPELLER])
def test_lift_of_a_load_that_changes_within_a_jet(shape, where, middle, radius=0.494):
    """Incidence in the middle alone (a nacelle, a flap that ends there), in the rest of the jet, outside of it.

    What each gains is a part of what the whole wing gains; with the answer to each strip's own circulation alone they
    were wrong by up to two thirds of that.
    """
    radii, speeds = radius * shape[0], shape[1]
    jet = short_wing(tuple(radii))
    y = jet.middle / radius
    share = {"inside": y < middle, "from there to the edge": (y > middle) & (y < 1.0), "outside": y > 1.0}[where]
    exact, found = (
        np.sum(v * jet.width)
        for v in (jet.gain(speeds, where=share * 1.0), ours(jet, radii, speeds, where=share * 1.0))
    )
    assert found == pytest.approx(exact, abs=0.06 * np.sum(jet.gain(speeds) * jet.width))


@pytest.mark.parametrize("shape,anywhere", [(FULL, 0.03), (HOLLOW, 0.025), (BLOWN, 0.025)])
@pytest.mark.parametrize("radius", [0.5, 1.0])
def test_lift_by_swirl(shape, anywhere, radius, mu=1.2):
    """The edges answer to an odd load alike: a fifth is not there outside, a twentieth inside."""
    radii, speeds = profile(shape, radius, mu)
    jet = RoundJets(radii, odd=True)
    y = jet.points[:, 1]
    swirl = np.where((y < radius) & (y > 0.3 * radius), 1.0, 0.0)
    exact, without = (jet.swirled(speeds, swirl, edges) for edges in (1.0, 0.0))
    np.testing.assert_allclose(ours(jet, radii, speeds, swirl=swirl), exact, atol=anywhere * np.max(np.abs(exact)))
    assert np.max(np.abs(without - exact)) > 0.08 * np.max(np.abs(exact))


def test_lift_of_a_round_jet_goes_on_outside(full=0.5, mu=1.2):
    """The lift, not the circulation, is continuous at a jet's edge: a quarter of what the middle gains is gained
    half a chord outside.
    """
    jet = RoundJets([full])
    gain = jet.gain([mu])
    at = [float(np.interp(y, jet.middle, gain)) for y in (0.0, full - 0.005, full + 0.005, full + 0.5)]
    assert at[1] == pytest.approx(at[2], rel=0.1) and 0.5 < at[1] / at[0] < 0.65 and 0.2 < at[3] / at[0] < 0.35
