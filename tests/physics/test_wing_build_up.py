"""Build-up of the wing beside its box: the readings of the source, values by hand, other sources, derivatives."""

import csv
from collections import defaultdict

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics import wing_build_up
from hera_om.physics.wing_build_up import (
    BoxShares,
    Flaps,
    SecondaryAreas,
    WingFacts,
    box_penalties,
    chord_integral,
    secondary_structure,
    total,
)

G = 9.80665
# The ATR 72: mass, span, speeds and areas of its definition, a box of 1500 kg.
FACTS = WingFacts(
    take_off=23000.0,
    landing=22350.0,
    power_plants=1775.0,
    engines=2.0,
    span=27.05,
    area=61.0,
    ultimate_factor=3.75,
    gear_factor=3.0,
    q_D=14500.0,
    mach_D=0.667,
    thickness=0.15,
    cos_leading=0.999,
    sin_half=-0.02,
)
BOX = BoxShares(jnp.asarray(73.0), jnp.asarray(190.0), jnp.asarray(290.0))
AREAS = SecondaryAreas(7.9, 4.9, 3.3, 12.3, 2.9)


def test_coefficients_are_those_of_the_programs(reference):
    """Each constant is one that a program reads, and where programs disagree none that fewer of them read."""
    with (reference / "wing_build_up_readings.csv").open(newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    readings = defaultdict(list)
    for row in rows:
        readings[row["constant"]].append(float(row["value"]))
    load, shear = readings.pop("FAIL_SAFETY_LOAD"), readings.pop("SHEAR_LOAD")
    assert pytest.approx(load[0] / shear[0]) == wing_build_up.FAIL_SAFETY
    assert len(readings) > 20
    for name, values in readings.items():
        constant, _, key = name.partition(".")
        ours = getattr(wing_build_up, constant)
        ours = ours[int(key) if key.isdigit() else key] if key else ours
        votes = [sum(v == w for w in values) for v in values]
        assert ours in [v for v, n in zip(values, votes, strict=True) if n == max(votes)], name


def test_specific_weights_by_hand():
    found = secondary_structure(FACTS, AREAS, Flaps())
    size = 23000.0 * G * 27.05 / 5e7
    assert float(found.leading_edge) == pytest.approx(7.9 * 176.4 * (14.5 / 30) ** 0.25 * size**0.145 / G)
    assert float(found.trailing_edge) == pytest.approx(4.9 * 145.6 * size**0.0544 / G)
    assert float(found.flaps) == pytest.approx(12.3 * 95.2 * (1 + 0.22555295**0.35) / G)
    assert float(found.ailerons) == pytest.approx(2.9 * 218.4 * 0.29**0.044 / G)
    assert float(found.tips) == pytest.approx(150 * 0.22555295**0.67 / G)
    assert float(found.miscellaneous) == pytest.approx(0.1 * sum(float(p) for p in found[:5]))
    fowler = secondary_structure(FACTS, AREAS, Flaps(2, "track"))
    assert float(fowler.flaps / found.flaps) == pytest.approx(1.6 * 1.5)
    assert float(fowler.trailing_edge - found.trailing_edge) == pytest.approx(100.0 * 3.3 / G)


def test_penalties_by_hand():
    found = box_penalties(FACTS, BOX, 2810.0)
    expected = {
        "joints": 2810.0 * 0.073,
        "fail_safety": 0.15 * 190.0,
        "manholes": 0.5 * 27.05 / 61.0 * 290.0,
        "engines": 0.015 * 1.4 * 1775.0,
        "gear": 0.0045 * 22350.0,
        "fuselage": 0.0003 * 3.75 * 23000.0,
    }
    assert {n: float(getattr(found, n)) for n in expected} == pytest.approx(expected)
    turn = (27.05 * 0.999 / 50.0) ** 3 / 0.15**2 * 1.02 / np.sqrt(1.0 - 0.667**2 * (1.0 - 0.02**2))
    assert float(found.stiffness) == pytest.approx(200.0 * 14.5 / 30.0 * turn / G)
    assert float(total(found)) == pytest.approx(sum(float(p) for p in found))


def test_torenbeeks_older_equations_ask_for_as_much():
    """Synthesis (1976), eq. C-2 and C-4 as AeroSandbox has them: shares of the box for joints, and for stiffness."""
    found, primary = box_penalties(FACTS, BOX, 2810.0), 1500.0
    joints = primary * (1.905 / 27.05) ** 0.5  # joints, skin without taper, least gauge, holes
    ours = float(found.joints + found.fail_safety + found.manholes)
    assert 0.7 * joints < ours < joints
    stiffness = primary * (1 + 0.265) * 9.06e-4 * 27.05**3 / 23000.0 * (1.54 / 0.18) ** 2
    assert float(found.stiffness) == pytest.approx(stiffness, rel=0.25)


def test_torenbeeks_report_of_1992_asks_for_as_much():
    """LR-693 as a program has it: 75 (1 + w), 60 (1 + 1.6 w), 100 (1 + w), 125 (1 + 0.5 sqrt w), w^2 = W / 1 MN."""
    w = (23000.0 * G / 1e6) ** 0.5
    newtons = 7.9 * 75 * (1 + w) + 4.9 * 60 * (1 + 1.6 * w) + 12.3 * 100 * (1 + w) + 2.9 * 125 * (1 + 0.5 * w**0.5)
    ours = secondary_structure(FACTS, AREAS, Flaps())
    assert sum(float(p) for p in ours[:4]) == pytest.approx(newtons / G, rel=0.15)


@given(st.floats(0.0, 13.0), st.floats(0.0, 13.0), st.floats(0.0, 13.0))
def test_area_between_stations(a, b, c):
    y, chord = jnp.asarray([0.0, 5.6, 14.5]), jnp.asarray([2.77, 2.77, 1.61])
    a, b, c = sorted((a, b, c))
    parts = chord_integral(y, chord, a, b) + chord_integral(y, chord, b, c)
    assert float(parts) == pytest.approx(float(chord_integral(y, chord, a, c)), abs=1e-12)
    fine = np.linspace(a, c, 2001)
    assert float(parts) == pytest.approx(np.trapezoid(np.interp(fine, y, chord), fine), abs=1e-5)


def test_a_wing_without_movables_gear_and_engines():
    bare = FACTS._replace(power_plants=0.0, engines=0.0, gear_factor=0.0)
    areas = SecondaryAreas(7.9, 20.0, 0.0, 0.0, 0.0)
    penalties, secondary = box_penalties(bare, BOX, 2810.0), secondary_structure(bare, areas, Flaps())
    assert float(penalties.engines) == float(penalties.gear) == 0.0
    assert float(secondary.flaps) == float(secondary.ailerons) == 0.0
    slope = jax.grad(lambda s: total(secondary_structure(bare, areas._replace(ailerons=s), Flaps())))
    assert np.isfinite(float(slope(0.0)))


def test_derivatives_by_everything(check_derivatives):
    scale = np.asarray([float(v) for v in (*FACTS, *BOX, *AREAS)])

    def masses(p):
        v = scale * p
        facts, box, areas = WingFacts(*v[:13]), BoxShares(*v[13:16]), SecondaryAreas(*v[16:])
        found = (*box_penalties(facts, box, 2810.0), *secondary_structure(facts, areas, Flaps(2, "link")))
        return jnp.stack(found) / 100.0

    check_derivatives(masses, np.ones(scale.size))
