"""Mass component: totals printed with the reference aircraft, fuel rules, what the items track."""

import numpy as np
import pytest

from hera_om.aircraft import load_aircraft, loads
from hera_om.components.mass import MassProperties

# [[mass]] of the reference aircraft
TAKEOFF, FUEL, WING, HTAIL, PODS = 28153.0, 3300.0, 3300.0, 170.0, 1200.0
X_FUEL, CLIMB_FUEL = 12.3, 500.0


@pytest.fixture(scope="module")
def hera():
    return load_aircraft("hera_like")


def outputs(ready, aircraft, rule="fixed_mass", **values):
    problem, _ = ready(MassProperties(aircraft=aircraft, fuel_rule=rule), **values)
    names = problem.model.c._var_rel_names["output"]
    return {name: float(problem.get_val(name)[0]) for name in names}


def test_totals_printed_with_the_reference_aircraft(ready, hera):
    out = outputs(ready, load_aircraft("hera_like", {"mission.climb_fuel_kg": 0.0}))
    # half a unit of the last digit that the file prints; its ky of the pods is rounded too
    assert out["mass"] == pytest.approx(TAKEOFF, abs=1e-9)
    assert out["x_cg"] == pytest.approx(12.0485, abs=5e-5)
    assert out["z_cg"] == pytest.approx(0.343, abs=5e-4)
    for name, printed in (("Ixx", 4.02e5), ("Iyy", 5.88e5), ("Izz", 9.46e5)):
        assert out[name] == pytest.approx(printed, abs=600.0)
    assert out["Ixz"] == pytest.approx(2.24e4, abs=50.0)


def test_balance_is_that_of_the_start_of_cruise(ready, hera):
    out = outputs(ready, hera)
    assert out["mass"] == pytest.approx(TAKEOFF)
    assert out["mass_cruise"] == pytest.approx(TAKEOFF - CLIMB_FUEL)
    moment = TAKEOFF * 12.0485 - CLIMB_FUEL * X_FUEL
    assert out["x_cg"] == pytest.approx(moment / (TAKEOFF - CLIMB_FUEL), abs=6e-5)
    assert (out["mass_fuel"], out["mass_saved"]) == pytest.approx((FUEL, 0.0))


def test_mass_saved_becomes_fuel_or_lightens_the_aircraft(ready, hera):
    design = {"m_wing": WING - 300.0, "htail_scale": 1.1}
    saved = 300.0 - 0.21 * HTAIL  # area goes with the square of the scale
    fixed_mass = outputs(ready, hera, **design)
    fixed_fuel = outputs(ready, hera, "fixed_fuel", **design)
    assert fixed_mass["mass_saved"] == pytest.approx(saved)
    assert fixed_fuel["mass_saved"] == pytest.approx(saved)
    assert (fixed_mass["mass"], fixed_mass["mass_fuel"]) == pytest.approx((TAKEOFF, FUEL + saved))
    assert (fixed_fuel["mass"], fixed_fuel["mass_fuel"]) == pytest.approx((TAKEOFF - saved, FUEL))
    assert fixed_fuel["mass_cruise"] == pytest.approx(TAKEOFF - saved - CLIMB_FUEL)


def test_pods_follow_their_hubs(ready, hera):
    # pods stay at their x and z, so that Ixx and Izz gain m (ky'^2 - ky^2), Iyy nothing
    inner, outer = outputs(ready, hera), outputs(ready, hera, y_prop=10.0)
    gain = PODS * ((10.0**2 + 12.75**2) - (8.0**2 + 10.75**2)) / 2.0
    for name, expected in (("Ixx", gain), ("Iyy", 0.0), ("Izz", gain), ("Ixz", 0.0)):
        assert outer[name] - inner[name] == pytest.approx(expected, abs=1e-6)
    assert outer["x_cg"] == pytest.approx(inner["x_cg"])


def definition(items):
    """An aircraft of these items, the mass of the first of which is a design variable."""
    rows = "\n".join(f"[[mass]]\n{row}" for row in items)
    first = items[0].split('"')[1]
    variable = f'[[variables]]\nname = "first"\npath = "mass.{first}.m_kg"\nlower = 0.0\nupper = 9.0'
    return loads(f'name = "items"\n[flight]\nmach = 0.3\n{rows}\n{variable}')


def test_uniform_ball_and_an_item_without_fuel(ready):
    # solid ball of radius 1: mean square along each axis 1/5, moment 2/5 m about each
    k = np.sqrt(0.2)
    ball = f'name = "ball"\nm_kg = 5.0\nx_m = 2.0\ny_m = 0.0\nz_m = 1.0\nkx_m = {k}\nky_m = {k}\nkz_m = {k}'
    out = outputs(ready, definition([ball]), "fixed_fuel")
    assert (out["mass"], out["mass_fuel"], out["x_cg"], out["z_cg"]) == pytest.approx((5.0, 0.0, 2.0, 1.0))
    assert (out["Ixx"], out["Iyy"], out["Izz"]) == pytest.approx((2.0, 2.0, 2.0))
    assert out["Ixz"] == pytest.approx(0.0, abs=1e-12)


def test_reads_what_the_items_follow_and_nothing_else(ready, hera):
    _, inputs = ready(MassProperties(aircraft=hera))
    assert sorted(inputs) == ["htail_scale", "m_wing", "y_prop"]


@pytest.mark.parametrize("rule", ["fixed_mass", "fixed_fuel"])
def test_partials(ready, check_partials, hera, rule):
    component = MassProperties(aircraft=hera, fuel_rule=rule)
    _, inputs = ready(component, m_wing=2900.0, htail_scale=1.07, y_prop=9.1)
    check_partials(component, inputs)


def test_missing_parts_are_named(ready):
    with pytest.raises(ValueError, match=r"'wing_alone' has no mass properties: there is no \[\[mass\]\]"):
        MassProperties(aircraft=load_aircraft("wing_alone"))
    dry = definition(['name = "ballast"\nm_kg = 5.0\nx_m = 2.0'])
    with pytest.raises(ValueError, match=r"needs a \[\[mass\]\] item that tracks fuel"):
        ready(MassProperties(aircraft=dry))
