"""A wing through round jets: boundary elements against closed forms, and the plane jet's factor against them."""

import importlib.util
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
    assert 2 * answer / float(fj.reflection(1.001)) == pytest.approx(-retaken(radius, 0.5), rel=0.025)


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


FULL, HOLLOW = [1.0], [0.0, 1.0]


@pytest.mark.parametrize(
    "radii,profile,mu,error",
    [
        ([0.35], FULL, 1.1, 0.13),
        ([0.5], FULL, 1.1, 0.12),
        ([0.5], FULL, 1.2, 0.19),
        ([1.0], FULL, 1.2, 0.16),
        ([2.5], FULL, 1.2, 0.10),
        ([0.2, 0.5], HOLLOW, 1.1, -0.08),
        ([0.2, 0.5], HOLLOW, 1.2, -0.02),
        ([0.4, 1.0], HOLLOW, 1.2, 0.04),
    ],
)
def test_gain_of_lift_in_round_jets(radii, profile, mu, error):
    """What the plane jet's factor makes of round ones: a fifth too much lift by a full jet at most, right by the
    hollow ones that propellers blow, within a tenth. Without the factor it would be up to three fifths too much.
    """
    jet, speeds = RoundJets(radii), 1 + (mu - 1) * np.array(profile)

    def factor(y):
        return np.asarray(fj.jet_factor(fj.ROUND_JET * radii[-1], jnp.asarray(jet.speed(y, speeds))))

    exact, ours = (np.sum(v * jet.width) for v in (jet.gain(speeds), jet.modelled(speeds, factor)))
    assert ours / exact - 1 == pytest.approx(error, abs=0.015)
    plain = np.sum(jet.modelled(speeds, np.ones_like) * jet.width)
    assert abs(ours - exact) < 0.85 * (plain - exact)


def test_lift_of_a_round_jet_goes_on_outside(full=0.5, mu=1.2):
    """The lift, not the circulation, is continuous at a jet's edge: a quarter of what the middle gains is gained
    half a chord outside, which a factor by strip does not give.
    """
    jet = RoundJets([full])
    gain = jet.gain([mu])
    at = [float(np.interp(y, jet.middle, gain)) for y in (0.0, full - 0.005, full + 0.005, full + 0.5)]
    assert at[1] == pytest.approx(at[2], rel=0.1) and 0.5 < at[1] / at[0] < 0.65 and 0.2 < at[3] / at[0] < 0.35
