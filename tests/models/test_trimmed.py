"""The whole aircraft: totals by every variable, feedbacks closed, what is held fixed, constraints that can bind."""

import numpy as np
import pytest

from hera_om.aircraft import variable_box
from hera_om.models.cases import MDO_GOAL, mdo_limits
from hera_om.models.problems import (
    DRIVERS,
    baseline_remainder,
    build_aircraft,
    build_mdo,
    make_driver,
    set_start,
)

STEPS = {
    "y_kink": 2e-3,
    "theta_tip": 2e-3,
    "y_prop": 5e-4,
    "htail_scale": 5e-4,
    "A_cap_root": 2e-6,
    "A_stringer_root": 4e-7,
}


@pytest.fixture(scope="module")
def flown(small):
    """The baseline, solved."""
    problem = build_aircraft(small)
    problem.run_model()
    return problem


@pytest.fixture
def baseline(flown, small):
    """The baseline again, whatever another test has left."""
    set_start(flown, small, "baseline")
    flown.run_model()
    return flown


def test_totals_of_the_problem(baseline, check_totals):
    """Range and every constraint of Table 7 by all six variables, trim and mass loop included."""
    for name, value in {"y_kink": 5.6, "theta_tip": -2.2, "y_prop": 8.3, "htail_scale": 1.07}.items():
        baseline.set_val(name, value)
    baseline.run_model()
    limits = [limit.name for limit in mdo_limits(boxed=True)]
    assert {"static_margin", "omega_sp", "zeta_sp", "zeta_ph", "RFC", "RFT"} <= set(limits)
    check_totals(baseline, [MDO_GOAL.name, *limits, "m_wing", "power", "range_fixed_fuel"], STEPS)


def test_the_mass_loop_is_closed(baseline):
    baseline.set_val("A_cap_root", 2.2e-3)
    baseline.run_model()
    assert baseline.get_val("m_wing_relief").item() == pytest.approx(baseline.get_val("m_wing").item(), abs=1e-7)
    assert baseline.get_val("m_wing").item() < 3300.0 - 50.0


def test_the_baseline_wing_has_the_mass_of_the_definition(baseline, small):
    """The remainder is frozen so that sized structure / primary_fraction + remainder is the given total."""
    assert baseline.get_val("m_wing").item() == pytest.approx(3300.0, abs=1e-5)
    rest = baseline_remainder(small)
    primary = baseline.get_val("m_primary").item()
    assert rest == pytest.approx(3300.0 - primary / 0.85, abs=1e-5) and 0.0 < rest < 1500.0
    assert baseline.get_val("mass_saved").item() == pytest.approx(0.0, abs=1e-5)


def test_take_off_mass_is_fixed_and_saved_mass_is_fuel(baseline):
    before = {n: baseline.get_val(n).item() for n in ("mass", "mass_fuel", "m_wing", "range_fixed_mass")}
    baseline.set_val("A_cap_root", 2.2e-3)
    baseline.run_model()
    after = {n: baseline.get_val(n).item() for n in before}
    assert after["mass"] == pytest.approx(before["mass"], rel=1e-12)
    gained = after["mass_fuel"] - before["mass_fuel"]
    assert gained == pytest.approx(before["m_wing"] - after["m_wing"], rel=1e-9)
    assert gained > 50.0 and after["range_fixed_mass"] > before["range_fixed_mass"]


def test_the_pull_up_carries_its_load_at_take_off_mass(baseline):
    lift = {p: baseline.get_val(f"{p}strip_force")[:, 2].sum() for p in ("", "pullup.")}
    masses = [baseline.get_val(n).item() for n in ("mass_cruise", "mass")]
    assert lift["pullup."] / lift[""] == pytest.approx(2.5 * masses[1] / masses[0], rel=0.1)


def test_compression_reserve_crosses_its_limit_inside_the_box(small_aircraft):
    """RFC over A_stringer_root rises through 1.5: the constraint can be violated, and can be active."""
    aircraft = small_aircraft(lattice__box_stations=24)
    problem, box = build_aircraft(aircraft), variable_box(aircraft)
    i = box.names.index("A_stringer_root")
    reserve = []
    for area in np.linspace(box.lower[i], box.upper[i], 5):
        problem.set_val("A_stringer_root", area)
        problem.run_model()
        reserve.append(problem.get_val("RFC").item())
    assert reserve == sorted(reserve)
    assert reserve[0] < 1.5 < reserve[-1]


# --- builders


def test_every_driver_gets_the_same_problem(small):
    found = []
    for driver in DRIVERS:
        problem = build_mdo(small, driver=driver)
        problem.final_setup()
        variables = {n: (m["lower"], m["upper"]) for n, m in problem.driver._designvars.items()}
        limits = {n: (m["lower"], m["upper"]) for n, m in problem.driver._cons.items()}
        found.append((str(variables), str(limits), list(problem.driver._objs)))
        assert set(variables) == set(STEPS) and len(limits) == 6
    assert found[0] == found[1]


def test_starts(small):
    problem, box = build_mdo(small, start="high"), variable_box(small)
    for n, low, high in zip(box.names, box.lower, box.upper, strict=True):
        assert problem.get_val(n).item() == pytest.approx(low + 0.75 * (high - low), rel=1e-12)


def test_choices_that_are_none(small, small_aircraft):
    with pytest.raises(ValueError, match="driver 'IPOPT': expected one of SLSQP, COBYLA"):
        make_driver("IPOPT", None)
    with pytest.raises(ValueError, match="start 'moon': expected one of baseline, low, high"):
        build_mdo(small, start="moon")
    with pytest.raises(ValueError, match="mdo of 'wing_tail' needs variables, mass, mission"):
        build_mdo(small_aircraft("wing_tail"))
