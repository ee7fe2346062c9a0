"""Performance component: Breguet's range by hand, both fuel rules, an aircraft without rotors."""

import numpy as np
import pytest

from hera_om.aircraft import load_aircraft
from hera_om.components.performance import Performance

TAKEOFF, CLIMB, CRUISE, C_S = 28153.0, 500.0, 1900.0, 1.42e-4
SPEED, RATIO, POWER = 158.0, 16.3, 2.2e6
STATE = {"speed": SPEED, "L_over_D": RATIO}


@pytest.fixture(scope="module")
def hera():
    return load_aircraft("hera_like")


def outputs(ready, aircraft, rule="fixed_mass", **values):
    problem, _ = ready(Performance(aircraft=aircraft, fuel_rule=rule), **STATE, **values)
    return {name: float(problem.get_val(name)[0]) for name in problem.model.c._var_rel_names["output"]}


def breguet(start, end):
    """Range in km."""
    return SPEED / C_S * RATIO * np.log(start / end) / 1e3


def test_ranges_by_hand(ready, hera):
    saved = 300.0
    out = outputs(ready, hera, mass=TAKEOFF, mass_saved=saved, power=POWER)
    start = TAKEOFF - CLIMB
    assert out["range_fixed_mass"] == pytest.approx(breguet(start, start - CRUISE - saved), rel=1e-12)
    assert out["range_fixed_fuel"] == pytest.approx(breguet(start - saved, start - saved - CRUISE), rel=1e-12)
    assert out["range_per_energy"] == pytest.approx(SPEED / POWER, rel=1e-12)


def test_both_rules_see_the_same_ranges(ready, hera):
    heavy = outputs(ready, hera, "fixed_mass", mass=TAKEOFF, mass_saved=-120.0, power=POWER)
    light = outputs(ready, hera, "fixed_fuel", mass=TAKEOFF + 120.0, mass_saved=-120.0, power=POWER)
    assert light == pytest.approx(heavy, rel=1e-12)
    assert heavy["range_fixed_mass"] < heavy["range_fixed_fuel"]


def test_without_rotors_there_is_no_shaft_energy(ready, hera):
    glider = hera.model_copy(update={"rotor": (), "variables": ()})
    out = outputs(ready, glider, mass=TAKEOFF)
    assert sorted(out) == ["range_fixed_fuel", "range_fixed_mass"]
    assert out["range_fixed_fuel"] == pytest.approx(breguet(TAKEOFF - CLIMB, TAKEOFF - CLIMB - CRUISE))


@pytest.mark.parametrize("rule", ["fixed_mass", "fixed_fuel"])
def test_partials(ready, check_partials, hera, rule):
    component = Performance(aircraft=hera, fuel_rule=rule)
    _, inputs = ready(component, **STATE, mass=27900.0, mass_saved=250.0, power=POWER)
    check_partials(component, inputs)


def test_missing_mission_is_named():
    with pytest.raises(ValueError, match=r"'wing_rotor' has no range: there is no \[mission\]"):
        Performance(aircraft=load_aircraft("wing_rotor"))
